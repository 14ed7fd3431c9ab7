#include <cdem/network/kd_tree.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using geometry::Box;
using network::KdTree;
using network::NeighbourSearch;

// Truth table of the concept.
static_assert(NeighbourSearch<KdTree>);
static_assert(NeighbourSearch<sample::BruteForceSearch>);
struct NotMadeFromPoints {
  template <class Visitor>
  void for_each_within(const Vec3&, double, Visitor&&) const {}
};
static_assert(!NeighbourSearch<NotMadeFromPoints>);
struct SearchChangesIt {
  SearchChangesIt(const std::vector<Vec3>&, const Box&) {}
  template <class Visitor>
  void for_each_within(const Vec3&, double, Visitor&&) {} // not const: threads could not share it
};
static_assert(!NeighbourSearch<SearchChangesIt>);
static_assert(!std::is_copy_constructible_v<KdTree>);

template <class Search>
std::vector<ParticleIndex> found(const Search& search, const Vec3& point, double radius) {
  std::vector<ParticleIndex> particles;
  search.for_each_within(point, radius, [&](ParticleIndex j) { particles.push_back(j); });
  std::sort(particles.begin(), particles.end());
  return particles;
}

} // namespace

TEST_CASE("the tree visits what a loop over all points and images visits, each image once") {
  for (int periodic = 0; periodic < 8; ++periodic) {
    const Box box{
        Vec3(-1, 0, 3), Vec3(1, 1.5, 4), {(periodic & 1) != 0, (periodic & 2) != 0, (periodic & 4) != 0}};
    const auto points = sample::random_spheres(300, box, 0.1, 0.2, 31).position;
    const KdTree tree(points, box);
    const sample::BruteForceSearch all(points, box);
    for (const double radius : {0.05, 0.3, 0.49, 0.8}) // the last meets some points through two images
      for (std::size_t i = 0; i < points.size(); i += 10)
        CHECK(found(tree, points[i], radius) == found(all, points[i], radius));
  }
}

TEST_CASE("a point outside a periodic box is queried at its image, outside an open one where it is") {
  const Box box = Box::cube(1, true);
  const std::vector<Vec3> points{Vec3(0.95, 0.5, 0.5), Vec3(0.5, 0.5, 0.5)};
  CHECK(found(KdTree(points, box), Vec3(3.02, -0.5, 0.5), 0.1) == std::vector<ParticleIndex>{0});
  const KdTree open(points, box.without_periodicity());
  CHECK(found(open, Vec3(3.02, -0.5, 0.5), 0.1).empty());
  CHECK(found(open, Vec3(1.04, 0.5, 0.5), 0.1) == std::vector<ParticleIndex>{0});
}

TEST_CASE("a neighbour at exactly the radius is visited, far from the origin too") {
  for (const double offset : {0.0, 1e3, 1e6}) {
    const Box box{Vec3::Constant(offset), Vec3::Constant(offset + 1), {true, true, true}};
    // Distances of 0.1 + 0.2 through the inside and through the face, up to rounding.
    const std::vector<Vec3> points{Vec3::Constant(offset) + Vec3(0.1, 0.5, 0.5),
                                   Vec3::Constant(offset) + Vec3(0.4, 0.5, 0.5),
                                   Vec3::Constant(offset) + Vec3(0.8, 0.5, 0.5)};
    const KdTree tree(points, box);
    CHECK(found(tree, points[0], 0.3) == std::vector<ParticleIndex>{0, 1, 2});
    CHECK(found(tree, points[0], 0.29).size() == 1);
  }
}

TEST_CASE("no radius finds nothing, and points in one place are all found") {
  const Box box = Box::cube(1, true);
  const std::vector<Vec3> heap(100, Vec3::Constant(0.25));
  const KdTree tree(heap, box);
  CHECK(found(tree, heap[0], 0).empty());
  CHECK(found(tree, heap[0], -1).empty());
  CHECK(found(tree, heap[0], std::numeric_limits<double>::quiet_NaN()).empty());
  CHECK(found(tree, heap[0], 1e-9).size() == 100);
}

TEST_CASE("bad input gets one message that names the value and what is accepted") {
  CHECK_THROWS_WITH_AS(KdTree({}, Box::cube(1, true)),
                       "number of points = 0 is not accepted: at least 1 is expected", core::InvalidInput);
  const Box flat{Vec3::Zero(), Vec3(1, 1, 0), {}};
  CHECK_THROWS_WITH_AS(KdTree({Vec3::Zero()}, flat),
                       "edge of the box along z = 0 is not accepted: a finite number above 0 m is expected",
                       core::InvalidInput);
}
