#include <cdem/core/random.hpp>
#include <cdem/particles/space_filling_order.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace {

using namespace cdem;
using geometry::Box;
using particles::ParticleSet;
using particles::reorder;
using particles::space_filling_order;

/// One particle at the centre of each unit cell of [0, x] x [0, y] x [0, z].
ParticleSet grid(int x, int y, int z) {
  ParticleSet particles;
  for (int i = 0; i < x; ++i)
    for (int j = 0; j < y; ++j)
      for (int k = 0; k < z; ++k)
        particles.position.push_back(Vec3(i, j, k) + Vec3::Constant(0.5));
  particles.radius.assign(particles.position.size(), 0.5);
  particles.phase.assign(particles.position.size(), 0);
  return particles;
}

ParticleSet random_points(std::size_t count, const Box& box, std::uint64_t seed) {
  core::Random random(seed);
  ParticleSet particles;
  particles.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    particles.position[i] =
        box.lower + box.size().cwiseProduct(Vec3(random.uniform(), random.uniform(), random.uniform()));
    particles.radius[i] = random.uniform(0.1, 0.2);
    particles.phase[i] = static_cast<PhaseIndex>(i % 5);
  }
  return particles;
}

bool names_each_once(std::vector<ParticleIndex> permutation, std::size_t count) {
  std::sort(permutation.begin(), permutation.end());
  std::vector<ParticleIndex> numbers(count);
  std::iota(numbers.begin(), numbers.end(), ParticleIndex{0});
  return permutation == numbers;
}

template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const core::InvalidInput& error) {
    return error.what();
  }
  return "no InvalidInput thrown";
}

} // namespace

TEST_CASE(
    "the curve visits every cell of a grid once, each next to the one before: Hilbert's defining property") {
  for (const int edge : {2, 4, 16, 32}) {
    const ParticleSet particles = grid(edge, edge, edge);
    const auto order = space_filling_order(particles, Box::cube(edge, false));
    CHECK(names_each_once(order, particles.size()));
    double longest = 0;
    for (std::size_t i = 1; i < order.size(); ++i)
      longest = std::max(longest, (particles.position[order[i]] - particles.position[order[i - 1]]).norm());
    CHECK(longest == 1);
  }
}

TEST_CASE("a long box is cut into cubic cells too") {
  const ParticleSet particles = grid(32, 8, 8);
  const auto order = space_filling_order(particles, {Vec3::Zero(), Vec3(32, 8, 8), {}});
  REQUIRE(names_each_once(order, particles.size()));
  double sum = 0;
  for (std::size_t i = 1; i < order.size(); ++i)
    sum += (particles.position[order[i]] - particles.position[order[i - 1]]).norm();
  CHECK(sum / static_cast<double>(order.size() - 1) <
        1.1); // 1 but where the curve leaves the box and returns
}

TEST_CASE("the order depends on the places alone, not on how the particles were numbered") {
  const Box box{Vec3(-1, 2, 0.5), Vec3(1, 3, 2.5), {true, false, true}};
  const ParticleSet particles = random_points(3000, box, 4);
  const ParticleSet sorted = reorder(particles, space_filling_order(particles, box));
  std::vector<ParticleIndex> backwards(particles.size());
  std::iota(backwards.rbegin(), backwards.rend(), ParticleIndex{0});
  const ParticleSet reversed = reorder(particles, backwards);
  const ParticleSet sorted_again = reorder(reversed, space_filling_order(reversed, box));
  CHECK(sorted.position == sorted_again.position);
  CHECK(sorted.radius == sorted_again.radius);
  CHECK(sorted.phase == sorted_again.phase);
}

TEST_CASE("a sorted set keeps its order, and so do particles in one place") {
  const Box box = Box::cube(1, false);
  const ParticleSet particles = random_points(1000, box, 5);
  const ParticleSet sorted = reorder(particles, space_filling_order(particles, box));
  const auto again = space_filling_order(sorted, box);
  CHECK(std::is_sorted(again.begin(), again.end()));
  ParticleSet heap = particles;
  std::fill(heap.position.begin(), heap.position.end(), Vec3::Constant(0.25));
  const auto unchanged = space_filling_order(heap, box);
  CHECK(std::is_sorted(unchanged.begin(), unchanged.end()));
}

TEST_CASE("particles outside count as wrapped in a periodic direction and as on the face of an open one") {
  const Box box{Vec3::Zero(), Vec3::Ones(), {true, false, false}};
  const ParticleSet inside = random_points(500, box, 6);
  ParticleSet outside = inside;
  for (Vec3& point : outside.position)
    point[0] += 2;
  CHECK(space_filling_order(inside, box) == space_filling_order(outside, box));
  ParticleSet far = inside;
  far.position[0] = Vec3(0.5, 1e300, -1e300);
  far.position[1] = Vec3(0.5, 1 - 1e-12, 0);
  const auto order = space_filling_order(far, box);
  const auto at = std::find(order.begin(), order.end(), ParticleIndex{0});
  REQUIRE(at + 1 != order.end());
  CHECK(*(at + 1) == 1); // the same cell
}

TEST_CASE("reorder moves the three arrays together") {
  const Box box = Box::cube(1, true);
  const ParticleSet particles = random_points(5, box, 7);
  const std::vector<ParticleIndex> permutation{3, 0, 4, 1, 2};
  const ParticleSet moved = reorder(particles, permutation);
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(moved.position[i] == particles.position[permutation[i]]);
    CHECK(moved.radius[i] == particles.radius[permutation[i]]);
    CHECK(moved.phase[i] == particles.phase[permutation[i]]);
  }
}

TEST_CASE("bad input gets one message that names the value and what is accepted") {
  const Box box = Box::cube(1, true);
  const ParticleSet particles = random_points(3, box, 8);
  CHECK(message_of([] { space_filling_order({}, Box::cube(1, true)); }) ==
        "number of particles = 0 is not accepted: at least 1 is expected");
  ParticleSet bad = particles;
  bad.position[1][2] = std::numeric_limits<double>::quiet_NaN();
  CHECK(message_of([&] { space_filling_order(bad, box); }) ==
        "position z of particle 1 = nan is not accepted: a finite number is expected");
  CHECK(message_of([&] {
          space_filling_order(particles, {Vec3::Zero(), Vec3::Zero(), {}});
        }).substr(0, 31) == "edge of the box along x = 0 is ");
  CHECK(message_of([&] {
          reorder(particles, {0, 1});
        }) == "length of the permutation = 2 is not accepted: one number per particle (3) is expected");
  CHECK(message_of([&] {
          reorder(particles, {0, 1, 1});
        }) == "permutation[2] = 1 is not accepted: each number below 3 is expected exactly once");
  CHECK(message_of([&] {
          reorder(particles, {0, 3, 1});
        }) == "permutation[1] = 3 is not accepted: each number below 3 is expected exactly once");
}
