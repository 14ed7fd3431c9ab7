#include <cdem/stress/tessellation/hexahedra.hpp>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using geometry::Box;
using geometry::Segment;
using sample::contains;
using sample::infinity;
using sample::not_a_number;
using sample::refusal;
using stress::tessellation::Hexahedra;

struct Shares {
  std::vector<double> cell; ///< [cells] fraction of the segment
  double outside = 0;
  double total() const { return std::accumulate(cell.begin(), cell.end(), outside); }
};

Shares shares_of(const Hexahedra& grid, const Segment& segment) {
  Shares shares{std::vector<double>(grid.cell_count(), 0), 0};
  shares.outside = grid.for_each_piece(segment, [&](std::size_t cell, double begin, double end) {
    REQUIRE(cell < grid.cell_count());
    CHECK(end > begin);
    shares.cell[cell] += end - begin;
  });
  return shares;
}

/// Fraction of a segment inside [lower, upper], by cutting it with the six planes.
double clipped(const Segment& segment, const Vec3& lower, const Vec3& upper) {
  double begin = 0, end = 1;
  for (int k = 0; k < 3; ++k) {
    const double x = segment.start[k], d = segment.extent[k];
    if (d == 0) {
      if (x < lower[k] || x >= upper[k])
        return 0;
      continue;
    }
    const double a = (lower[k] - x) / d, b = (upper[k] - x) / d;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return std::max(0.0, end - begin);
}

/// The same shares by clipping against every cell and its images, one after the other.
Shares shares_by_clipping(const Hexahedra& grid, const Segment& segment, int images) {
  Shares shares{std::vector<double>(grid.cell_count(), 0), 1};
  const Box& box = grid.box();
  const auto reach = [&](std::size_t k) { return box.periodic[k] ? images : 0; };
  for (std::size_t cell = 0; cell < grid.cell_count(); ++cell)
    for (int x = -reach(0); x <= reach(0); ++x)
      for (int y = -reach(1); y <= reach(1); ++y)
        for (int z = -reach(2); z <= reach(2); ++z) {
          const Vec3 centre = grid.centre(cell) + box.size().cwiseProduct(Vec3(x, y, z));
          const double fraction =
              clipped(segment, centre - grid.cell_size() / 2, centre + grid.cell_size() / 2);
          shares.cell[cell] += fraction;
          shares.outside -= fraction;
        }
  return shares;
}

double largest_difference(const Shares& a, const Shares& b) {
  double most = std::abs(a.outside - b.outside);
  for (std::size_t cell = 0; cell < a.cell.size(); ++cell)
    most = std::max(most, std::abs(a.cell[cell] - b.cell[cell]));
  return most;
}

const Box oblong{Vec3(-1, 0.5, 2), Vec3(1, 3.5, 2.75), {false, false, false}};

TEST_CASE("the cells fill the box, and each point is in the cell whose corners are around it") {
  const Hexahedra grid(oblong, {4, 3, 5});
  CHECK(grid.cell_count() == 60);
  const auto points = grid.corner_points();
  const auto cells = grid.cell_corners();
  REQUIRE(points.size() == 5 * 4 * 6);
  REQUIRE(cells.size() == 60);
  double volume = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto at = [&](std::size_t corner) -> const Vec3& { return points.at(cells[c][corner]); };
    // Volume by the triple product of the edges that leave corner 0; VTK's order makes it positive.
    const double triple = (at(1) - at(0)).cross(at(3) - at(0)).dot(at(4) - at(0));
    CHECK(triple == doctest::Approx(grid.volume(c)).epsilon(1e-12));
    // VTK_HEXAHEDRON: 2 is opposite to 0 in the low face, 6 in the whole cell; 5, 6, 7 lie above 1, 2, 3.
    CHECK((at(2) - (at(1) + at(3) - at(0))).norm() < 1e-14);
    for (std::size_t corner = 0; corner < 4; ++corner)
      CHECK((at(corner + 4) - at(corner) - Vec3(0, 0, grid.cell_size().z())).norm() < 1e-14);
    Vec3 mean = Vec3::Zero();
    for (std::size_t corner = 0; corner < 8; ++corner)
      mean += at(corner) / 8;
    CHECK((mean - grid.centre(c)).norm() < 1e-14);
    CHECK(grid.locate(mean) == c);
    for (std::size_t corner = 0; corner < 8; ++corner) // just inside each corner
      CHECK(grid.locate(at(corner) + 1e-6 * (mean - at(corner))) == c);
    volume += triple;
  }
  CHECK(volume == doctest::Approx(oblong.volume()).epsilon(1e-13));
  CHECK(points.front() == oblong.lower);
  CHECK(points.back() == oblong.upper);
}

TEST_CASE("every point of the closed box is in a cell, none outside is") {
  for (const int n : {1, 3, 7, 49}) { // 1/49 * 49 is not 1 in floating point
    const Box box{Vec3(0.1, -0.3, 0.7), Vec3(0.4, 0.6, 1.9), {false, false, false}};
    const Hexahedra grid(box, {n, n, n});
    const auto last = grid.cell_count() - 1;
    CHECK(grid.locate(box.lower) == 0);
    CHECK(grid.locate(box.upper) == last);
    for (const Vec3& corner : grid.corner_points())
      CHECK(grid.locate(corner).has_value());
    for (int k = 0; k < 3; ++k) {
      const Vec3 out = 1e-6 * Vec3::Unit(k);
      CHECK_FALSE(grid.locate(box.lower - out));
      CHECK_FALSE(grid.locate(box.upper + out));
    }
    CHECK_FALSE(grid.locate(Vec3(not_a_number, 0, 1)));
    CHECK_FALSE(grid.locate(Vec3(0.2, infinity, 1)));
  }
}

TEST_CASE("a point outside a periodic box is in the cell of its image") {
  Box box = oblong;
  box.periodic = {true, false, true};
  const Hexahedra grid(box, {4, 3, 5});
  core::Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 point = sample::random_point(random, box);
    const auto cell = grid.locate(point);
    REQUIRE(cell);
    CHECK(grid.locate(point + Vec3(2, 0, 0)) == cell);
    CHECK(grid.locate(point - Vec3(6, 0, 1.5)) == cell);
    CHECK_FALSE(grid.locate(point + Vec3(0, 3, 0)));
  }
  CHECK(grid.locate(Vec3(1, 0.6, 2.75)) == grid.locate(Vec3(-1, 0.6, 2)));
}

TEST_CASE("a segment's shares are those of clipping it against every cell") {
  core::Random random(11);
  for (const bool periodic : {false, true}) {
    Box box = oblong;
    box.periodic = {periodic, false, periodic};
    for (const auto& counts : std::vector<Hexahedra::Counts>{{1, 1, 1}, {4, 3, 5}, {1, 7, 2}}) {
      const Hexahedra grid(box, counts);
      for (int trial = 0; trial < 400; ++trial) {
        const Vec3 a = sample::random_point(random, box);
        const Vec3 b = sample::random_point(random, box);
        // Half of them stay inside, the others run out of the box, some from the outside.
        const double stretch = trial % 2 == 0 ? 1 : 2;
        const Segment segment{trial % 4 == 3 ? Vec3(2 * a - box.lower) : a, stretch * (b - a)};
        const Shares shares = shares_of(grid, segment);
        // Rounding of a plane's coordinate (20 at most, images included) moves its crossing by that over the
        // segment's extent across the plane; eight such roundings at most make a piece.
        const double rounding = 8 * 2.2e-16 * 20 / segment.extent.cwiseAbs().minCoeff();
        CHECK(largest_difference(shares, shares_by_clipping(grid, segment, 4)) < rounding);
        CHECK(std::abs(shares.total() - 1) < 1e-14);
        if (stretch == 1 && trial % 4 != 3)
          CHECK(shares.outside == 0);
      }
    }
  }
}

TEST_CASE("a segment's shares are what fine sampling counts") {
  core::Random random(12);
  Box box = oblong;
  box.periodic = {true, true, false};
  const Hexahedra grid(box, {5, 4, 3});
  constexpr int samples = 20000;
  for (int trial = 0; trial < 20; ++trial) {
    const Segment segment{sample::random_point(random, box), sample::random_vector(random, -1.5, 1.5)};
    const Shares shares = shares_of(grid, segment);
    std::map<std::optional<std::size_t>, int> count;
    for (int s = 0; s < samples; ++s) {
      const Vec3 point = box.wrap(segment.at((s + 0.5) / samples));
      const Vec3 part = (point - box.lower).cwiseQuotient(box.size());
      if (part.z() < 0 || part.z() >= 1)
        ++count[std::nullopt];
      else
        ++count[static_cast<std::size_t>(std::floor(5 * part.x())) +
                5 * (static_cast<std::size_t>(std::floor(4 * part.y())) +
                     4 * static_cast<std::size_t>(std::floor(3 * part.z())))];
    }
    // Each end of each piece is off by at most one sample; a cell is met twice at most.
    for (std::size_t cell = 0; cell < grid.cell_count(); ++cell)
      CHECK(std::abs(shares.cell[cell] - double(count[cell]) / samples) <= 4.0 / samples);
    CHECK(std::abs(shares.outside - double(count[std::nullopt]) / samples) <= 4.0 / samples);
  }
}

TEST_CASE("segments through edges and corners, along faces, and points") {
  const Hexahedra grid(Box::cube(1, false), {4, 4, 4});
  const auto cell = [&](std::size_t i, std::size_t j, std::size_t k) { return grid.index(i, j, k); };

  SUBCASE("the diagonal of the box meets the four cells of the diagonal, both ways") {
    for (const Segment& segment :
         {Segment{Vec3::Zero(), Vec3::Ones()}, Segment{Vec3::Ones(), -Vec3::Ones()}}) {
      const Shares shares = shares_of(grid, segment);
      for (std::size_t i = 0; i < 4; ++i)
        CHECK(shares.cell[cell(i, i, i)] == 0.25);
      CHECK(shares.outside == 0);
      CHECK(shares.total() == 1);
    }
  }
  SUBCASE("a diagonal through edges") {
    const Shares shares = shares_of(grid, {Vec3(1, 0, 0.1), Vec3(-1, 1, 0)});
    for (std::size_t i = 0; i < 4; ++i)
      CHECK(shares.cell[cell(3 - i, i, 0)] == 0.25);
    CHECK(shares.total() == 1);
  }
  SUBCASE("along an inner face: the cells above it") {
    const Shares shares = shares_of(grid, {Vec3(0.125, 0.1, 0.5), Vec3(0.25, 0, 0)});
    CHECK(shares.cell[cell(0, 0, 2)] == 0.5);
    CHECK(shares.cell[cell(1, 0, 2)] == 0.5);
  }
  SUBCASE("along the faces and the edges of the box: inside") {
    for (const double y : {0.0, 1.0})
      for (const double z : {0.0, 1.0})
        for (const double way : {1.0, -1.0}) {
          const Shares shares = shares_of(grid, {Vec3(way > 0 ? 0 : 1, y, z), Vec3(way, 0, 0)});
          CHECK(shares.outside == 0);
          for (std::size_t i = 0; i < 4; ++i)
            CHECK(shares.cell[cell(i, y > 0 ? 3 : 0, z > 0 ? 3 : 0)] == 0.25);
        }
  }
  SUBCASE("ends on planes: no piece of no length") {
    int pieces = 0;
    const double outside = grid.for_each_piece({Vec3(0.25, 0.3, 0.3), Vec3(0.25, 0, 0)},
                                               [&](std::size_t number, double begin, double end) {
                                                 ++pieces;
                                                 CHECK(number == cell(1, 1, 1));
                                                 CHECK(begin == 0);
                                                 CHECK(end == 1);
                                               });
    CHECK(outside == 0);
    CHECK(pieces == 1);
  }
  SUBCASE("a point has the whole share, on a face too") {
    CHECK(shares_of(grid, {Vec3(0.5, 0.1, 0.1), Vec3::Zero()}).cell[cell(2, 0, 0)] == 1);
    CHECK(shares_of(grid, {Vec3(1, 1, 1), Vec3::Zero()}).cell[cell(3, 3, 3)] == 1);
    CHECK(shares_of(grid, {Vec3(1.5, 1, 1), Vec3::Zero()}).outside == 1);
  }
  SUBCASE("beside the box: all outside") {
    CHECK(shares_of(grid, {Vec3(1.5, -2, 0), Vec3(0.1, 5, 0.3)}).outside == 1);
    CHECK(shares_of(grid, {Vec3(-1, -1, -1), Vec3(0.5, 0.5, 0.5)}).outside == 1);
  }
  SUBCASE("straight through the box, from far outside") {
    const Shares shares = shares_of(grid, {Vec3(-1, 0.3, 0.3), Vec3(4, 0, 0)});
    CHECK(shares.outside == 0.75);
    for (std::size_t i = 0; i < 4; ++i)
      CHECK(shares.cell[cell(i, 1, 1)] == 0.0625);
  }
}

TEST_CASE("rounding of positions and branches pushes nothing out of the walls") {
  core::Random random(5);
  const Box box{Vec3(0.1, -0.3, 0.7), Vec3(0.4, 0.6, 1.9), {false, false, false}};
  const Hexahedra grid(box, {7, 3, 49});
  for (int trial = 0; trial < 3000; ++trial) {
    Vec3 a = sample::random_point(random, box), b = sample::random_point(random, box);
    for (int k = 0; k < 3; ++k) { // ends on walls, one unit of rounding beside them, or inside
      const auto pick = random.bits() % 6;
      if (pick < 2)
        a[k] = pick == 0 ? box.upper[k] : std::nextafter(box.upper[k], 10);
      else if (pick < 4)
        b[k] = pick == 2 ? box.upper[k] : std::nextafter(box.lower[k], -10);
      else if (pick == 4)
        a[k] = b[k] = box.upper[k];
    }
    const Shares shares = shares_of(grid, {a, b - a});
    CHECK(shares.outside == 0);
    CHECK(std::abs(shares.total() - 1) < 1e-14);
  }
}

TEST_CASE("the specimen length is the diagonal in units of the side") {
  // [L17] section 2.5: lengths up to 0.17 L are sought; sqrt(3)/11 is the first under it.
  const Box box = Box::cube(0.01, false);
  CHECK(Hexahedra(box, {7, 7, 7}).mean_specimen_length() ==
        doctest::Approx(std::sqrt(3.0) / 7).epsilon(1e-14));
  CHECK(Hexahedra(box, {11, 11, 11}).mean_specimen_length() < 0.17);
  CHECK(Hexahedra(box, {10, 10, 10}).mean_specimen_length() > 0.17);
  // By the corners themselves, in a box that is not a cube.
  const Hexahedra grid(oblong, {4, 3, 5});
  const auto points = grid.corner_points();
  double length = 0;
  for (const auto& cell : grid.cell_corners()) {
    double most = 0;
    for (const auto a : cell)
      for (const auto b : cell)
        most = std::max(most, (points[a] - points[b]).norm());
    length += most / 60;
  }
  CHECK(grid.mean_specimen_length() == doctest::Approx(length / std::cbrt(4.5)).epsilon(1e-13));
}

TEST_CASE("grids from a wanted number of specimens or of particles in them") {
  const Box cube = Box::cube(2, false);
  for (const int n : {1, 2, 7, 28}) // [L17] section 2.5 goes from 343 to 21,952
    CHECK(Hexahedra::near_cubes(cube, static_cast<std::size_t>(n * n * n)).counts() ==
          Hexahedra::Counts{n, n, n});
  CHECK(Hexahedra::near_cubes({Vec3::Zero(), Vec3(4, 2, 1), {}}, 64).counts() == Hexahedra::Counts{8, 4, 2});
  CHECK(Hexahedra::near_cubes({Vec3::Zero(), Vec3(1, 1, 1e-6), {}}, 100).counts()[2] == 1);

  CHECK(Hexahedra::holding(cube, 80'000, 80).counts() == Hexahedra::Counts{10, 10, 10});
  for (const std::size_t particles : {1u, 79u, 100u, 12'345u, 700'000u})
    for (const double least : {0.5, 1.0, 80.0, 1200.0}) {
      if (least > static_cast<double>(particles))
        continue;
      const Hexahedra grid = Hexahedra::holding(cube, particles, least);
      CAPTURE(particles);
      CAPTURE(least);
      CHECK(static_cast<double>(particles) / static_cast<double>(grid.cell_count()) >= least);
      // One more cell along any axis of a cube would break the promise or leave the cubes behind.
      const auto [low, high] = std::minmax_element(grid.counts().begin(), grid.counts().end());
      CHECK(*high - *low <= 1);
      CHECK(std::pow(*high + 1.0, 3) > static_cast<double>(particles) / least);
    }
}

TEST_CASE("bad grids are refused by name") {
  const Box cube = Box::cube(1, false);
  CHECK(contains(refusal([&] { Hexahedra(cube, {3, 0, 3}); }), "number of specimens along y = 0"));
  CHECK(contains(refusal([&] { Hexahedra(cube, {3, 3, -2}); }), "number of specimens along z = -2"));
  CHECK(contains(refusal([&] { Hexahedra(cube, {2000, 2000, 2000}); }), "number of corners"));
  CHECK(contains(refusal([&] { Hexahedra({Vec3::Zero(), Vec3(1, 0, 1), {}}, {1, 1, 1}); }), "along y = 0"));
  CHECK(contains(refusal([&] {
                   Hexahedra({Vec3::Zero(), Vec3(1, 1, not_a_number), {}}, {1, 1, 1});
                 }),
                 "along z = nan"));
  CHECK(contains(refusal([&] {
                   Hexahedra({Vec3::Zero(), Vec3::Constant(1e-108), {}}, {9, 9, 9});
                 }),
                 "volume of a specimen"));
  CHECK(contains(refusal([&] { Hexahedra::near_cubes(cube, 0); }), "number of specimens = 0"));
  CHECK(contains(refusal([&] { Hexahedra::near_cubes(cube, 1'000'000'000'000); }), "number of specimens"));
  CHECK(contains(refusal([&] { Hexahedra::holding(cube, 0, 80); }), "number of particles = 0"));
  CHECK(contains(refusal([&] { Hexahedra::holding(cube, 79, 80); }), "at most the number of particles, 79"));
  CHECK(contains(refusal([&] { Hexahedra::holding(cube, 79, 0); }), "particles per specimen = 0"));
  CHECK(
      contains(refusal([&] { Hexahedra::holding(cube, 79, not_a_number); }), "particles per specimen = nan"));
  CHECK(contains(refusal([&] { Hexahedra::holding(cube, 79, 1e-12); }), "particles per specimen"));
}

} // namespace
