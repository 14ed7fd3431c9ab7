// Writes grids of known values into the folder given; vtu_read_back.py reads them with VTK and compares.

#include <cdem/io/bonds_vtu.hpp>
#include <cdem/io/particles_vtu.hpp>
#include <cdem/io/specimens_vtu.hpp>
#include <cdem/stress/tessellation/hexahedra.hpp>
#include <cdem/stress/tessellation/tetrahedra.hpp>
#include <cdem/stress/tessellation/wedges.hpp>

#include <iostream>
#include <limits>

using namespace cdem;

namespace {

/// Every cell type, every scalar type and every shape of value, over more points than one buffer holds.
void write_everything(const std::filesystem::path& path) {
  constexpr std::size_t count = 20'000;
  const auto real = [](std::size_t i) { return static_cast<double>(i); };
  io::Vtu grid(count, [&](std::size_t i) { return Vec3(0.5 * real(i), -real(i), 3); });

  const std::vector<int> tetrahedron{0, 1, 2, 3};
  const std::vector<std::uint64_t> hexahedra{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const std::array<std::uint32_t, 6> wedge{5, 4, 3, 2, 1, 0};
  const std::vector<std::uint32_t> nothing;
  grid.cells(io::CellType::tetrahedron, tetrahedron);
  grid.cells(io::CellType::line, nothing);
  grid.cells(io::CellType::hexahedron, hexahedra);
  grid.cells(io::CellType::wedge, wedge);
  grid.cells(io::CellType::line, 2, [](std::size_t k) { return 100 + k; });
  grid.vertices();

  const auto array = [&]<class T>(T, const std::string& name) {
    grid.point_data({name, count, [](std::size_t i) { return static_cast<T>(i); }});
  };
  array(float{}, "float");
  array(double{}, "double");
  array(std::int8_t{}, "int8");
  array(std::uint8_t{}, "uint8");
  array(std::int16_t{}, "int16");
  array(std::uint16_t{}, "uint16");
  array(std::int32_t{}, "int32");
  array(std::uint32_t{}, "uint32");
  array(std::int64_t{}, "int64");
  array(std::uint64_t{}, "uint64");
  grid.point_data({"vector", count, [&](std::size_t i) { return Vec3(real(i), 2 * real(i), -real(i)); }});
  grid.point_data({"float vector", count, [](std::size_t i) {
                     return core::Vector3<float>::Constant(static_cast<float>(i)).eval();
                   }});
  grid.point_data({"tensor", count, [&](std::size_t i) -> Mat3 {
                     Mat3 tensor;
                     tensor << 11, 12, 13, 21, 22, 23, 31, 32, 33;
                     return tensor + Mat3::Constant(100 * real(i));
                   }});
  grid.point_data({"pair", count, [](std::size_t i) { return std::array{i, i + 1}; }});
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  grid.point_data({"not finite", count, [&](std::size_t i) {
                     return i % 3 == 0 ? nan : i % 3 == 1 ? infinity : -infinity;
                   }});
  grid.point_data({"a < b & \"c\" µ [m²]", count, real});
  grid.cell_data({"cell", grid.cell_count(), real});
  grid.field_data("TimeValue", 0.1);
  grid.field_data("count", std::int32_t{-7});
  grid.field_data("title", "α & <b> \"c\"\nsecond line");
  grid.field_data("empty", "");
  grid.write(path);
}

/// Four particles in a periodic box; the last bond runs through the face x = 1.
void write_body(const std::filesystem::path& folder) {
  particles::ParticleSet particles;
  particles.resize(4);
  particles.position = {{0.1, 0.5, 0.5}, {0.4, 0.5, 0.5}, {0.7, 0.5, 0.5}, {0.9, 0.5, 0.5}};
  particles.radius = {0.1, 0.11, 0.12, 0.13};
  particles.phase = {0, 1, 0, 2};
  particles::Motion motion = particles::Motion::at_rest(4);
  motion.time = 2.5;
  std::vector<Vec3> displacement, rotation;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = static_cast<double>(i);
    displacement.emplace_back(x, 0.1 * x, -x);
    rotation.emplace_back(0, 0, 10 * x);
    motion.displacement[i].linear() = displacement.back();
    motion.displacement[i].angular() = rotation.back();
    motion.velocity[i].linear() = Vec3(7, 8, 9);
  }
  const std::vector<float> temperature{1, 2, 3, 4};
  io::ParticleFields fields{
      .displacement = displacement, .rotation = rotation, .time = 1.5, .title = "four particles"};
  fields.extra.push_back({"temperature [K]", temperature});
  io::write_particles_vtu(folder / "particles.vtu", particles, fields);
  io::write_particles_vtu(folder / "motion.vtu", particles, io::fields_of(motion));

  const network::BondNetwork network{
      4, {0, 1, 0}, {1, 2, 3}, {Vec3(0.3, 0, 0), Vec3(0.3, 0, 0), Vec3(-0.2, 0, 0)}};
  const std::vector<Vec3> force{{5, 1, 0}, {-5, 0, 2}, {-3, 0, 0}};
  io::write_bonds_vtu(folder / "bonds.vtu", particles, network,
                      {.force = force, .displacement = displacement, .title = "three bonds"});
}

/// The specimens of a box with a stress that is told by their number, and one wedge.
void write_specimens(const std::filesystem::path& folder) {
  const stress::tessellation::Hexahedra tessellation({Vec3::Zero(), Vec3(3, 2, 4), {false, false, false}},
                                                     {3, 2, 4});
  stress::StressField field;
  for (std::size_t s = 0; s < tessellation.cell_count(); ++s) {
    const double x = static_cast<double>(s);
    field.stress.push_back((Mat3() << x, 2, 3, 0, x, 0, 0, 5, x).finished());
    field.volume.push_back(tessellation.volume(s));
    field.particles.push_back(static_cast<std::uint32_t>(80 + s));
    field.couple_stress.push_back(2 * field.stress.back());
  }
  io::write_specimens_vtu(folder / "specimens.vtu", tessellation, io::fields_of(field));

  const std::vector<Vec3> corners{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}};
  const std::vector<std::array<std::uint32_t, 6>> wedges{{0, 1, 2, 3, 4, 5}};
  io::write_specimens_vtu(folder / "wedge.vtu", corners, wedges, io::SpecimenFields{});

  namespace cells = stress::tessellation;
  const auto numbered = [](std::size_t count) {
    io::SpecimenFields fields;
    fields.extra.push_back({"number", count, [](std::size_t s) { return s; }});
    return fields;
  };
  const cells::Wedges cut(tessellation, Axis::y);
  io::write_specimens_vtu(folder / "wedges.vtu", cut, numbered(cut.cell_count()));
  const cells::Tetrahedra tetrahedra(tessellation);
  io::write_specimens_vtu(folder / "tetrahedra.vtu", tetrahedra, numbered(tetrahedra.cell_count()));

  geometry::Mesh mesh; // a hexahedron and a wedge beside it
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1},
                {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {2, 0, 0}, {2, 0, 1}};
  mesh.hexahedra = {{0, 1, 2, 3, 4, 5, 6, 7}};
  mesh.wedges = {{1, 2, 8, 5, 6, 9}};
  io::write_specimens_vtu(folder / "mesh.vtu", mesh, numbered(2));
  io::write_specimens_vtu(folder / "points.vtu", mesh.nodes, numbered(10));
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: vtu_read_back FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  write_everything(folder / "everything.vtu");
  write_body(folder);
  write_specimens(folder);
}
