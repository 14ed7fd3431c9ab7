#include <cdem/network/bonds.hpp>
#include <cdem/network/coordination.hpp>

#include <doctest/doctest.h>

#include <numeric>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using geometry::Box;
using network::BondNetwork;

/// A network with these ends; the branches are all one unit along x.
BondNetwork network_of(std::size_t particles,
                       const std::vector<std::pair<ParticleIndex, ParticleIndex>>& bonds) {
  BondNetwork network;
  network.particle_count = particles;
  for (const auto& [first, second] : bonds) {
    network.first.push_back(first);
    network.second.push_back(second);
    network.branch.push_back(Vec3::UnitX());
  }
  return network;
}

} // namespace

TEST_CASE("degrees of a small graph counted by hand") {
  // 0 - 1 - 2, 3 - 4, 5 alone
  const BondNetwork network = network_of(6, {{0, 1}, {1, 2}, {3, 4}});
  CHECK(network::degrees(network) == std::vector<std::uint32_t>{1, 2, 1, 1, 1, 0});
  const auto histogram = network::degree_histogram(network);
  CHECK(histogram.particles == std::vector<std::uint64_t>{1, 4, 1});
  CHECK(histogram.mean() == 1);
  CHECK(histogram.fewer_than(0) == 0);
  CHECK(histogram.fewer_than(1) == 1);
  CHECK(histogram.fewer_than(2) == 5);
  CHECK(histogram.fewer_than(100) == 6);
}

TEST_CASE("a lattice's degrees are six inside, five, four and three on faces, edges and corners") {
  const std::uint64_t edge = 5;
  const auto network = network::bonds_within(sample::simple_cubic(static_cast<int>(edge)),
                                             Box::cube(static_cast<double>(edge), false), 1e-9);
  const auto histogram = network::degree_histogram(network);
  const std::uint64_t inner = edge - 2;
  CHECK(histogram.particles ==
        std::vector<std::uint64_t>{0, 0, 0, 8, 12 * inner, 6 * inner * inner, inner * inner * inner});
  const auto clusters = network::clusters(network);
  CHECK(clusters.particles == std::vector<std::uint64_t>{125});
  CHECK(clusters.outside_largest() == 0);
}

TEST_CASE("the histogram adds up to the particles and to twice the bonds") {
  const Box box = Box::cube(1, true);
  const auto network =
      network::bonds_at_coordination(sample::random_spheres(2000, box, 0.01, 0.05, 3), box, 4.3).network;
  const auto histogram = network::degree_histogram(network);
  CHECK(std::accumulate(histogram.particles.begin(), histogram.particles.end(), std::uint64_t{0}) == 2000);
  CHECK(histogram.fewer_than(histogram.particles.size()) == 2000);
  CHECK(histogram.mean() == doctest::Approx(network.coordination()).epsilon(1e-14));
  CHECK(histogram.particles.back() > 0);
}

TEST_CASE("clusters of a small graph, whatever the order in which bonds join them") {
  // 1 - 4 - 6 - 2 closed late, 0 - 5, 3 alone
  const auto clusters = network::clusters(network_of(7, {{0, 5}, {1, 4}, {2, 6}, {4, 6}}));
  CHECK(clusters.of == std::vector<ParticleIndex>{0, 1, 1, 2, 1, 0, 1});
  CHECK(clusters.particles == std::vector<std::uint64_t>{2, 4, 1});
  CHECK(clusters.largest == 1);
  CHECK(clusters.outside_largest() == 3);
}

TEST_CASE("clusters agree with a flood through the bonds") {
  const Box box = Box::cube(1, false);
  const auto network =
      network::bonds_at_coordination(sample::random_spheres(1500, box, 0.01, 0.03, 9), box, 1.1).network;
  const auto clusters = network::clusters(network);
  std::vector<std::vector<ParticleIndex>> neighbours(network.particle_count);
  for (std::size_t b = 0; b < network.size(); ++b) {
    neighbours[network.first[b]].push_back(network.second[b]);
    neighbours[network.second[b]].push_back(network.first[b]);
  }
  const ParticleIndex none = 0xffffffff;
  std::vector<ParticleIndex> flooded(network.particle_count, none);
  ParticleIndex count = 0;
  for (ParticleIndex start = 0; start < network.particle_count; ++start) {
    if (flooded[start] != none)
      continue;
    std::vector<ParticleIndex> stack{start};
    while (!stack.empty()) {
      const ParticleIndex i = stack.back();
      stack.pop_back();
      if (flooded[i] != none)
        continue;
      flooded[i] = count;
      stack.insert(stack.end(), neighbours[i].begin(), neighbours[i].end());
    }
    ++count;
  }
  CHECK(count > 100); // the sample is not one piece
  CHECK(clusters.particles.size() == count);
  CHECK(clusters.of == flooded);
}

TEST_CASE("bad networks are named") {
  CHECK_THROWS_WITH_AS(network::degrees({}),
                       "number of particles = 0 is not accepted: at least 1 is expected", core::InvalidInput);
  CHECK_THROWS_WITH_AS(network::clusters({}),
                       "number of particles = 0 is not accepted: at least 1 is expected", core::InvalidInput);
  CHECK_THROWS_WITH_AS(
      network::clusters(network_of(3, {{0, 3}})),
      "second particle of bond 0 = 3 is not accepted: a number below 3 other than the first's is "
      "expected",
      core::InvalidInput);
  CHECK(network::degree_histogram(network_of(3, {})).particles == std::vector<std::uint64_t>{3});
  CHECK(network::clusters(network_of(3, {})).outside_largest() == 2);
}
