#include <cdem/core/random.hpp>
#include <cdem/geometry/box.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

using namespace cdem;
using geometry::Box;

const Box slab{Vec3(-1, 2, 10), Vec3(1, 5, 10.5), {true, false, true}};

} // namespace

TEST_CASE("size and volume") {
  CHECK(slab.size() == Vec3(2, 3, 0.5));
  CHECK(slab.volume() == 3);
  const Box cube = Box::cube(0.5, true);
  CHECK(cube.lower == Vec3::Zero());
  CHECK(cube.volume() == 0.125);
  CHECK(cube.periodic == std::array{true, true, true});
  CHECK(cube.without_periodicity().periodic == std::array{false, false, false});
  CHECK(cube.without_periodicity().upper == cube.upper);
}

TEST_CASE("the nearest image is the shortest of the images, and a whole number of edges away") {
  core::Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 d(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    const Vec3 nearest = slab.minimum_image(d);
    for (const int k : {0, 2}) {
      const double edge = slab.size()[k];
      double shortest = std::abs(d[k]);
      for (int image = -30; image <= 30; ++image)
        shortest = std::min(shortest, std::abs(d[k] + image * edge));
      CHECK(std::abs(nearest[k]) == doctest::Approx(shortest).epsilon(1e-12));
      const double edges = (d[k] - nearest[k]) / edge;
      CHECK(edges == doctest::Approx(std::round(edges)).epsilon(1e-12));
    }
    CHECK(nearest[1] == d[1]); // walls: no image
    CHECK(slab.minimum_image(-d) == -nearest);
  }
}

TEST_CASE("wrap brings a point into [lower, upper) by whole edges, in the periodic directions only") {
  core::Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 point(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    const Vec3 wrapped = slab.wrap(point);
    for (const int k : {0, 2}) {
      CHECK(wrapped[k] >= slab.lower[k]);
      CHECK(wrapped[k] < slab.upper[k]);
      const double edges = (point[k] - wrapped[k]) / slab.size()[k];
      CHECK(edges == doctest::Approx(std::round(edges)).epsilon(1e-12));
    }
    CHECK(wrapped[1] == point[1]);
    CHECK(slab.wrap(wrapped) == wrapped);
  }
}

TEST_CASE("wrap keeps its half-open interval at the faces and just below them") {
  const Box box = Box::cube(1, true);
  CHECK(box.wrap(Vec3(1, 0, 1)) == Vec3::Zero());
  CHECK(box.wrap(Vec3::Constant(-1e-18)) == Vec3::Zero()); // 1 - 1e-18 rounds to 1, the upper face
  CHECK(box.wrap(Vec3::Constant(-0.25)) == Vec3::Constant(0.75));
}

TEST_CASE("bad boxes are named") {
  using core::InvalidInput;
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(Box::cube(0, true),
                       "side of the box = 0 is not accepted: a finite number above 0 m is expected",
                       InvalidInput);
  CHECK_THROWS_WITH_AS(Box::cube(-2, false),
                       "side of the box = -2 is not accepted: a finite number above 0 m is expected",
                       InvalidInput);
  CHECK_THROWS_AS(Box::cube(not_a_number, true), InvalidInput);
  CHECK_THROWS_AS(Box::cube(std::numeric_limits<double>::infinity(), true), InvalidInput);
  Box box = Box::cube(1, true);
  box.validate();
  box.upper[1] = box.lower[1];
  CHECK_THROWS_WITH_AS(box.validate(),
                       "edge of the box along y = 0 is not accepted: a finite number above 0 m is expected",
                       InvalidInput);
  box.upper[1] = not_a_number;
  CHECK_THROWS_WITH_AS(box.validate(),
                       "edge of the box along y = nan is not accepted: a finite number above 0 m is expected",
                       InvalidInput);
}
