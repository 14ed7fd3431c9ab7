#include <cdem/io/bonds_vtu.hpp>
#include <cdem/io/particles_vtu.hpp>
#include <cdem/io/specimens_vtu.hpp>

#include <doctest/doctest.h>

#include <limits>

#include "temporary_folder.hpp"

using namespace cdem;

// An array that would be gone before the file is written is refused by the compiler.
static_assert(std::constructible_from<io::DataArray, std::string, const std::vector<double>&>);
static_assert(std::constructible_from<io::DataArray, std::string, std::span<const double>>);
static_assert(!std::constructible_from<io::DataArray, std::string, std::vector<double>>);
static_assert(!std::constructible_from<io::Vtu, std::vector<Vec3>>);

// What the files hold is read back with VTK itself: vtu_read_back.cpp and vtu_read_back.py.

namespace {

const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

particles::ParticleSet three_particles() {
  particles::ParticleSet set;
  set.resize(3);
  set.position = points;
  set.radius = {0.5, 0.5, 0.5};
  return set;
}

network::BondNetwork one_bond() {
  return {3, {0}, {1}, {Vec3(1, 0, 0)}};
}

template <class Action>
std::string refusal(Action&& action) {
  return message_of<core::InvalidInput>(std::forward<Action>(action));
}

} // namespace

TEST_CASE("Arrays of another length than the grid are refused by name") {
  io::Vtu grid(points);
  grid.vertices();
  const std::vector<double> two{1, 2};
  CHECK(refusal([&] {
          grid.point_data({"radius [m]", two});
        }) == "number of values of 'radius [m]' = 2 is not accepted: one a point (3) is expected");
  CHECK(refusal([&] {
          grid.cell_data({"a", two});
        }) == "number of values of 'a' = 2 is not accepted: one a cell (3) is expected");
}

TEST_CASE("A name that is empty, holds control characters or comes twice is refused") {
  const std::vector<double> three{1, 2, 3};
  io::Vtu grid(points);
  grid.point_data({"a", three});
  grid.vertices();
  CHECK(contains(refusal([&] { grid.point_data({"a", three}); }), "a name that is not there already"));
  CHECK_NOTHROW(grid.cell_data({"a", three})); // of points and cells are told apart
  CHECK_THROWS_AS(grid.point_data({"", three}), core::InvalidInput);
  CHECK_THROWS_AS(grid.point_data({"a\nb", three}), core::InvalidInput);
  CHECK_THROWS_AS(grid.field_data("", 1.0), core::InvalidInput);
  CHECK_THROWS_AS(grid.field_data("", "text"), core::InvalidInput);
}

TEST_CASE("Corners that are no points, parts of cells and points that are not finite are refused; no file is "
          "left") {
  const TemporaryFolder folder;
  const auto write = [&](const io::Vtu& grid) { return refusal([&] { grid.write(folder / "a.vtu"); }); };
  {
    io::Vtu grid(points);
    const std::vector<int> corners{0, 1, 1, 3};
    grid.cells(io::CellType::line, corners);
    CHECK(write(grid) == "corner of a cell = 3 is not accepted: the number of a point, below 3, is expected");
  }
  {
    io::Vtu grid(points);
    const std::vector<int> corners{0, -1};
    grid.cells(io::CellType::line, corners);
    CHECK(contains(write(grid), "corner of a cell = -1"));
  }
  {
    io::Vtu grid(points);
    const std::vector<int> corners{0, 1, 2};
    CHECK(refusal([&] { grid.cells(io::CellType::line, corners); }) ==
          "number of corners = 3 is not accepted: a multiple of 2 is expected");
  }
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    auto moved = points;
    moved[2].y() = bad;
    CHECK(contains(write(io::Vtu(moved)), "coordinate y of point 2 = "));
  }
  {
    io::Vtu grid(points);
    grid.vertices();
    const std::vector<double> three{1, 2, 3};
    grid.cell_data({"a", three});
    grid.vertices(); // six cells now
    CHECK(contains(write(grid), "one a cell (6) is expected"));
  }
  CHECK(folder.entries() == 0);
}

TEST_CASE("A file that cannot be written is a FileError") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(io::Vtu(points).write(folder / "missing/a.vtu"), core::FileError);
}

TEST_CASE("Particles, bonds and specimens refuse fields that do not fit them; no file is left") {
  const TemporaryFolder folder;
  const auto path = folder / "a.vtu";
  const std::vector<Vec3> two(2, Vec3::Zero());
  auto particles = three_particles();
  CHECK(contains(refusal([&] { io::write_particles_vtu(path, particles, {.displacement = two}); }),
                 "'displacement [m]' = 2"));
  CHECK(contains(refusal([&] { io::write_bonds_vtu(path, particles, one_bond(), {.force = two}); }),
                 "number of bond forces = 2 is not accepted: one a bond (1)"));
  CHECK(contains(refusal([&] { io::write_bonds_vtu(path, particles, one_bond(), {.displacement = two}); }),
                 "number of displacements = 2 is not accepted: one a particle (3)"));
  network::BondNetwork other = one_bond();
  other.particle_count = 4;
  CHECK(contains(refusal([&] { io::write_bonds_vtu(path, particles, other); }),
                 "particle_count of the network = 4"));
  particles.radius[1] = 0;
  CHECK_THROWS_AS(io::write_particles_vtu(path, particles), core::InvalidInput);
  CHECK_THROWS_AS(io::write_particles_vtu(path, {}), core::InvalidInput);

  const std::vector<std::array<std::uint32_t, 4>> tetrahedra{{0, 1, 2, 3}};
  CHECK(contains(refusal([&] { io::write_specimens_vtu(path, points, tetrahedra, io::SpecimenFields{}); }),
                 "corner of a cell = 3"));
  const std::vector<double> volumes{1, 2};
  CHECK(contains(refusal([&] { io::write_specimens_vtu(path, points, tetrahedra, {.volume = volumes}); }),
                 "'volume [m^3]' = 2"));
  CHECK(folder.entries() == 0);
}

TEST_CASE("Only a bond through a periodic face gets an end of its own") {
  particles::ParticleSet particles;
  particles.resize(3);
  particles.position = {{0.1, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.9, 0.5, 0.5}};
  particles.radius.assign(3, 0.2);
  const network::BondNetwork network{
      3, {0, 0, 1}, {1, 2, 2}, {Vec3(0.4, 0, 0), Vec3(-0.2, 0, 0), Vec3(0.4, 1e-12, 0)}};
  CHECK(io::detail::bonds_to_images(particles, network) == std::vector<BondIndex>{1});
}

TEST_CASE("A grid without cells, without points, and with names that XML must escape is well-formed") {
  const TemporaryFolder folder;
  io::Vtu grid(std::span<const Vec3>{});
  const std::vector<double> none;
  grid.point_data({"a < b & \"c\" > d", none});
  grid.write(folder / "a.vtu");
  CHECK(contains(content_of(folder / "a.vtu"), "Name=\"a &lt; b &amp; &quot;c&quot; &gt; d\""));
  CHECK(contains(content_of(folder / "a.vtu"), "NumberOfPoints=\"0\" NumberOfCells=\"0\""));
}
