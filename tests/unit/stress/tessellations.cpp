// Wedges, tetrahedra and any mesh: two independent ways to cut segments, sampling, and what must add up.

#include <cdem/stress/closure.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/tessellation/polyhedra.hpp>
#include <cdem/stress/tessellation/tetrahedra.hpp>
#include <cdem/stress/tessellation/wedges.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using namespace cdem::stress::tessellation;
using geometry::Box;
using geometry::Mesh;
using geometry::Segment;
using sample::contains;
using sample::refusal;

const Box oblong{Vec3(-1, 0.5, 2), Vec3(1, 3.5, 2.75), {false, false, false}};

/// [cells + 1] part of the segment in each cell and, last, outside. Pieces must come in order and fill the segment.
template <class Cells>
std::vector<double> shares_of(const Cells& cells, const Segment& segment) {
  std::vector<double> shares(cells.cell_count() + 1, 0);
  double last = 0, gaps = 0;
  shares.back() = cells.for_each_piece(segment, [&](std::size_t cell, double begin, double end) {
    REQUIRE(cell < cells.cell_count());
    CHECK(begin >= last);
    CHECK(end > begin);
    gaps += begin - last;
    last = end;
    shares[cell] += end - begin;
  });
  CHECK(std::abs(gaps + 1 - last - shares.back()) < 1e-14);
  CHECK(std::abs(std::accumulate(shares.begin(), shares.end(), 0.0) - 1) < 1e-14);
  return shares;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

/// Shares by finding the cell of many points along the segment.
template <class Cells>
std::vector<double> sampled_shares(const Cells& cells, const Segment& segment, int samples) {
  std::vector<double> shares(cells.cell_count() + 1, 0);
  for (int s = 0; s < samples; ++s)
    shares[cells.locate(segment.at((s + 0.5) / samples)).value_or(cells.cell_count())] += 1.0 / samples;
  return shares;
}

Segment random_segment(core::Random& random, const Box& box, double reach) {
  const Vec3 start = sample::random_point(random, box);
  return {start, reach * (sample::random_point(random, box) - start)};
}

/// Nodes inside the box moved at random: the faces of hexahedra and wedges are no longer plane.
Mesh warped(Mesh mesh, const Box& box, double most, std::uint64_t seed) {
  core::Random random(seed);
  for (Vec3& node : mesh.nodes)
    if (((node - box.lower).array() > 1e-9).all() && ((box.upper - node).array() > 1e-9).all())
      node += sample::random_vector(random, -most, most);
  return mesh;
}

/// The checks that any tessellation which fills `box` must pass.
template <class Cells>
void check_filling(const Cells& cells, const Box& box) {
  double volume = 0;
  for (std::size_t cell = 0; cell < cells.cell_count(); ++cell)
    volume += cells.volume(cell);
  CHECK(volume == doctest::Approx(box.volume()).epsilon(1e-12));
  core::Random random(8);
  for (int n = 0; n < 60; ++n) {
    const Segment segment = random_segment(random, box, 0.7);
    const auto shares = shares_of(cells, segment);
    CHECK(shares.back() == 0);
    CHECK(largest_difference(shares, sampled_shares(cells, segment, 1000)) < 2.0 / 1000);
  }
}

template <class Cells>
void check_structured(const Cells& cells, std::size_t count) {
  CHECK(cells.cell_count() == count);
  check_filling(cells, cells.grid().box());
  const Polyhedra polyhedra(mesh_of(cells)); // by barycentric coordinates, where the other goes by planes
  core::Random random(9);
  for (int n = 0; n < 200; ++n) {
    const Segment segment = random_segment(random, cells.grid().box(), 0.4);
    CHECK(largest_difference(shares_of(cells, segment), shares_of(polyhedra, segment)) < 1e-12);
    CHECK(cells.locate(segment.start) == polyhedra.locate(segment.start));
  }
  for (std::size_t cell = 0; cell < count; ++cell)
    CHECK(polyhedra.volume(cell) == doctest::Approx(cells.volume(cell)).epsilon(1e-10));
  CHECK(polyhedra.mean_specimen_length() == doctest::Approx(cells.mean_specimen_length()).epsilon(1e-12));
}

TEST_CASE("wedges fill the box, along each axis") {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    const Wedges wedges(Hexahedra(oblong, {4, 3, 2}), axis);
    check_structured(wedges, 48);
    const auto points = wedges.corner_points();
    for (const auto& c : wedges.cell_corners()) {
      const Vec3 u = points[c[1]] - points[c[0]], v = points[c[2]] - points[c[0]];
      const Vec3 up = points[c[3]] - points[c[0]];
      CHECK(u.cross(v).dot(up) < 0); // VTK_WEDGE: the first triangle is turned outwards
      CHECK(up.cwiseAbs()[index_of(axis)] == doctest::Approx(up.norm()));
      for (std::size_t k = 1; k < 3; ++k)
        CHECK((points[c[k + 3]] - points[c[k]] - up).norm() < 1e-14);
    }
  }
}

TEST_CASE("tetrahedra fill the box") {
  const Tetrahedra tetrahedra(Hexahedra(oblong, {2, 3, 2}));
  check_structured(tetrahedra, 72);
  const auto points = tetrahedra.corner_points();
  for (const auto& c : tetrahedra.cell_corners()) {
    const Vec3 u = points[c[1]] - points[c[0]], v = points[c[2]] - points[c[0]],
               w = points[c[3]] - points[c[0]];
    CHECK(u.cross(v).dot(w) / 6 == doctest::Approx(tetrahedra.volume(0))); // VTK_TETRA: positive
  }
}

TEST_CASE("the tetrahedra of a mesh are conforming: every inner triangle has two of them") {
  const Hexahedra grid(oblong, {3, 3, 3});
  const auto free_triangles = [](const Mesh& mesh) {
    std::multiset<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t cell = 0; cell < mesh.cell_count(); ++cell)
      geometry::cut_to_tetrahedra(mesh.corners(cell), [&](auto a, auto b, auto c, auto d) {
        for (std::array<std::uint32_t, 3> t : {std::array{a, b, c}, {a, b, d}, {a, c, d}, {b, c, d}}) {
          std::sort(t.begin(), t.end());
          triangles.insert(t);
        }
      });
    std::size_t once = 0;
    for (const auto& triangle : triangles) {
      CHECK(triangles.count(triangle) <= 2);
      once += triangles.count(triangle) == 1 ? 1U : 0U;
    }
    return once;
  };
  const std::size_t on_the_surface = 2UL * 6 * 9;
  Mesh renumbered = mesh_of(grid); // the cut goes by node numbers: any must do
  core::Random random(4);
  std::vector<std::uint32_t> number(renumbered.nodes.size());
  std::iota(number.begin(), number.end(), 0u);
  for (std::size_t k = number.size(); --k > 0;)
    std::swap(number[k], number[static_cast<std::size_t>(random.uniform(0, double(k)))]);
  const Mesh before = renumbered;
  for (std::size_t k = 0; k < number.size(); ++k)
    renumbered.nodes[number[k]] = before.nodes[k];
  for (auto& cell : renumbered.hexahedra)
    for (auto& node : cell)
      node = number[node];
  CHECK(free_triangles(before) == on_the_surface);
  CHECK(free_triangles(renumbered) == on_the_surface);
  CHECK(free_triangles(mesh_of(Wedges(grid, Axis::y))) == on_the_surface);
  CHECK(free_triangles(mesh_of(Tetrahedra(grid))) == on_the_surface);
  check_filling(Polyhedra(warped(renumbered, oblong, 0.02, 1)), oblong);
}

TEST_CASE("meshes with warped faces, of each kind and mixed") {
  const Hexahedra grid(oblong, {4, 4, 3});
  check_filling(Polyhedra(warped(mesh_of(grid), oblong, 0.03, 1)), oblong);
  check_filling(Polyhedra(warped(mesh_of(Wedges(grid)), oblong, 0.03, 2)), oblong);
  check_filling(Polyhedra(warped(mesh_of(Tetrahedra(grid)), oblong, 0.03, 3)), oblong);

  // Hexahedra below, wedges along z on them: the faces in between are whole quadrangles cut alike by both.
  const Mesh wedges = mesh_of(Wedges(grid, Axis::x)), hexahedra = mesh_of(grid);
  Mesh mixed = hexahedra;
  mixed.hexahedra.resize(16); // the lowest layer
  for (std::size_t cell = 32; cell < wedges.wedges.size(); ++cell)
    mixed.wedges.push_back(wedges.wedges[cell]);
  CHECK(mixed.cell_count() == 16 + 64);
  const Polyhedra polyhedra(warped(mixed, oblong, 0.03, 4));
  check_filling(polyhedra, oblong);
  CHECK(polyhedra.mesh().corners(0).size() == 6); // wedges are numbered before hexahedra
  CHECK(polyhedra.mesh().corners(64).size() == 8);
}

TEST_CASE("along faces, edges and diagonals nothing is lost or counted twice") {
  const Hexahedra grid(Box::cube(1, false), {4, 4, 4});
  const std::vector<Segment> segments{
      {Vec3(0, 0, 0), Vec3(1, 1, 1)},     {Vec3(1, 1, 1), Vec3(-1, -1, -1)},
      {Vec3(0, 0, 0.3), Vec3(1, 1, 0)},   {Vec3(0.25, 0, 0.25), Vec3(0, 1, 0)},
      {Vec3(0.5, 0.5, 0), Vec3(0, 0, 1)}, {Vec3(0, 0, 0), Vec3(0, 0, 1)},
      {Vec3(1, 0, 1), Vec3(-1, 1, 0)},    {Vec3(1, 1, 0.5), Vec3(-1, 0, 0)},
      {Vec3(0, 1, 0), Vec3(1, 0, 0)},     {Vec3(0.3, 0.3, 0.3), Vec3(0, 0, 0)},
      {Vec3(1, 1, 1), Vec3(0, 0, 0)},     {Vec3(0.25, 0.5, 0.75), Vec3(0, 0, 0)}};
  const auto check = [&](const auto& cells) {
    for (const Segment& segment : segments) {
      CHECK(shares_of(cells, segment).back() == 0);
      CHECK(cells.locate(segment.start));
      CHECK(cells.locate(segment.at(1)));
    }
  };
  check(Wedges(grid, Axis::x));
  check(Wedges(grid, Axis::z));
  check(Tetrahedra(grid));
  check(Polyhedra(mesh_of(grid)));
  check(Polyhedra(mesh_of(Wedges(grid))));
  check(Polyhedra(mesh_of(Tetrahedra(grid))));
  // The diagonal is an edge of all six tetrahedra of a hexahedron, and each piece goes to one of the four on its way.
  int pieces = 0;
  (void)Tetrahedra(grid).for_each_piece(segments[0], [&](std::size_t, double begin, double end) {
    ++pieces;
    CHECK(end - begin == doctest::Approx(0.25));
  });
  CHECK(pieces == 4);
}

TEST_CASE("through periodic faces the wedges and tetrahedra of the other side go on") {
  const Box box{Vec3(-1, 2, 0), Vec3(1, 5, 1), {true, true, false}};
  const auto check = [&](const auto& cells) {
    core::Random random(3);
    for (int n = 0; n < 100; ++n) {
      Segment segment = random_segment(random, box, 0.9);
      segment.extent.head<2>() *= 3;
      CHECK(shares_of(cells, segment).back() == 0);
      CHECK(largest_difference(shares_of(cells, segment), sampled_shares(cells, segment, 1000)) < 6.0 / 1000);
      Segment image = segment;
      image.start += Vec3(4, -3, 0);
      CHECK(largest_difference(shares_of(cells, segment), shares_of(cells, image)) < 1e-12);
    }
  };
  check(Wedges(Hexahedra(box, {3, 2, 4}), Axis::y));
  check(Tetrahedra(Hexahedra(box, {3, 2, 4})));
}

TEST_CASE("a mesh with a hole: what runs through it is outside") {
  const Box box = Box::cube(3, false);
  Mesh mesh = mesh_of(Hexahedra(box, {3, 3, 3}));
  mesh.hexahedra.erase(mesh.hexahedra.begin() + 13); // the middle one
  const Polyhedra polyhedra(mesh);
  CHECK(shares_of(polyhedra, {Vec3(0.5, 1.5, 1.5), Vec3(2, 0, 0)}).back() ==
        doctest::Approx(0.5).epsilon(5e-10)); // surfaces are 1e-10 thick
  CHECK(shares_of(polyhedra, {Vec3(-1, 1.5, 1.5), Vec3(5, 0, 0)}).back() ==
        doctest::Approx(0.6).epsilon(5e-10));
  CHECK(shares_of(polyhedra, {Vec3(4, 4, 4), Vec3(1, 0, 0)}).back() == 1);
  CHECK_FALSE(polyhedra.locate(Vec3(1.5, 1.5, 1.5)));
  CHECK_FALSE(polyhedra.locate(Vec3(1.5, 1.5, 3.1)));
  CHECK_FALSE(polyhedra.locate(Vec3(1.5, sample::not_a_number, 3)));
  CHECK(polyhedra.locate(Vec3(0.5, 1.5, 1.5)) == 12);
}

TEST_CASE("the specimens' V sigma add up to the bonds' f (x) d on wedges, tetrahedra and meshes") {
  const sample::Body body = sample::random_body(Box::cube(1, false), 400, 0.25, 17);
  const auto check = [&](const auto& cells) {
    const stress::LoveWeber<std::decay_t<decltype(cells)>> estimator(cells);
    const stress::StressField field = estimator.estimate(body.particles, body.network, body.forces);
    CHECK((stress::moment_of_stress(field) - body.moment()).norm() < 1e-12 * body.moment_scale());
    CHECK(field.outside == Mat3::Zero());
    CHECK(std::accumulate(field.particles.begin(), field.particles.end(), 0u) == 400);
    for (const int threads : {2, 3}) {
      core::ThreadPool pool(threads);
      CHECK(sample::same_bytes(field, estimator.estimate(body.particles, body.network, body.forces, pool)));
    }
  };
  const Hexahedra grid(body.box, {4, 3, 5});
  check(Wedges(grid));
  check(Tetrahedra(grid));
  check(Polyhedra(warped(mesh_of(grid), body.box, 0.04, 6)));
  check(Polyhedra(warped(mesh_of(Wedges(grid)), body.box, 0.04, 6)));
}

TEST_CASE("coordinates within a cell") {
  const Hexahedra grid(Box{Vec3(0, 0, 0), Vec3(2, 2, 2), {true, false, false}}, {4, 2, 1});
  const std::size_t cell = grid.index(3, 1, 0);
  CHECK((grid.local(cell, Vec3(1.75, 1.25, 1)) - Vec3(0.5, 0.25, 0.5)).norm() < 1e-14);
  CHECK((grid.local(cell, Vec3(-0.25, 1.25, 1)) - Vec3(0.5, 0.25, 0.5)).norm() < 1e-14); // the nearest image
  CHECK((grid.local(cell, Vec3(1.75, 0.5, 3)) - Vec3(0.5, -0.5, 1.5)).norm() < 1e-14);
}

TEST_CASE("bad meshes are refused by name") {
  const Mesh good = mesh_of(Hexahedra(Box::cube(1, false), {2, 1, 1}));
  const auto message = [&](auto&& spoil) {
    Mesh mesh = good;
    spoil(mesh);
    return refusal([&] { Polyhedra polyhedra(mesh); });
  };
  CHECK(message([](Mesh&) {}).empty());
  CHECK(contains(message([](Mesh& m) { m.hexahedra.clear(); }), "number of cells of the mesh = 0"));
  CHECK(contains(message([](Mesh& m) { m.nodes[3].y() = sample::not_a_number; }),
                 "coordinate y of node 3 = nan"));
  CHECK(contains(message([](Mesh& m) { m.hexahedra[1][2] = 12; }), "corner of cell 1 = 12"));
  CHECK(contains(message([](Mesh& m) { m.hexahedra[1][2] = m.hexahedra[1][1]; }),
                 "volume of a part of cell 1"));
  CHECK(contains(message([](Mesh& m) { std::swap(m.hexahedra[0][0], m.hexahedra[0][1]); }),
                 "volume of a part of cell 0"));
  CHECK(contains(message([](Mesh& m) {
                   for (Vec3& node : m.nodes)
                     node.z() = 0;
                 }),
                 "edge of the box along z = 0"));
  Mesh inverted = good; // mirrored corners are as good: only the cell's own parts must agree
  for (auto& cell : inverted.hexahedra)
    for (std::size_t k = 0; k < 4; ++k)
      std::swap(cell[k], cell[k + 4]);
  CHECK(Polyhedra(inverted).volume(1) == doctest::Approx(0.5));
}

} // namespace
