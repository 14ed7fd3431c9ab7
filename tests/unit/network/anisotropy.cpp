#include <cdem/network/anisotropy.hpp>
#include <cdem/network/bonds.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using geometry::Box;
using network::BondNetwork;

/// Bonds of a chain of particles with these branches; where the particles are does not matter to their angles.
BondNetwork chain(const std::vector<Vec3>& branches) {
  BondNetwork network;
  network.particle_count = branches.size() + 1;
  for (ParticleIndex i = 0; i < branches.size(); ++i) {
    network.first.push_back(i);
    network.second.push_back(i + 1);
    network.branch.push_back(branches[i]);
  }
  return network;
}

BondNetwork isotropic_chain(std::size_t bonds, std::uint64_t seed) {
  core::Random random(seed);
  std::vector<Vec3> branches(bonds);
  for (Vec3& branch : branches)
    branch = Vec3(random.normal(), random.normal(), random.normal());
  return chain(branches);
}

} // namespace

TEST_CASE("isotropic bonds deviate as a multinomial distribution does") {
  // E_k^2 has the mean (1/N_c)(1 - 1/N_c)/n, and n N_c^2 E_k^2 is close to chi-squared with 31 degrees of freedom. So
  // the mean of 200 values has a relative standard error of sqrt(2/31/200) = 1.8 %; the three planes, hardly
  // correlated, are held to that of one.
  const std::size_t bonds = 5000;
  const int samples = 200;
  double mean_square = 0;
  for (int sample = 0; sample < samples; ++sample)
    for (const double deviation :
         network::anisotropy(isotropic_chain(bonds, 100 + static_cast<std::uint64_t>(sample))).deviation)
      mean_square += deviation * deviation / (3 * samples);
  const double expected = std::pow(network::isotropic_deviation(bonds), 2);
  CHECK(expected == doctest::Approx(1.0 / 32 * 31 / 32 / 5000));
  CHECK(std::abs(mean_square / expected - 1) < 3 * 0.018);
}

TEST_CASE("the deviation of isotropic bonds falls as one over the root of their number") {
  const auto few = network::anisotropy(isotropic_chain(2000, 1));
  const auto many = network::anisotropy(isotropic_chain(200000, 2));
  for (std::size_t k = 0; k < 3; ++k) { // chi with 31 degrees of freedom: 12.7 % standard deviation of each
    CHECK(few.deviation[k] == doctest::Approx(network::isotropic_deviation(2000)).epsilon(0.5));
    CHECK(many.deviation[k] == doctest::Approx(network::isotropic_deviation(200000)).epsilon(0.5));
  }
}

TEST_CASE("a simple cubic lattice has two peaks of one half in each plane") {
  const auto network = network::bonds_within(sample::simple_cubic(4), Box::cube(4, true), 1e-9);
  const auto result = network::anisotropy(network);
  // E^2 = (1/32) (2 (1/2 - 1/32)^2 + 30/32^2)
  const double exact = std::sqrt((2 * std::pow(0.5 - 1.0 / 32, 2) + 30.0 / 1024) / 32);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(result.bonds[k] == 128); // two thirds of 192: the last third is orthogonal to the plane
    CHECK(result.fraction[k][0] == 0.5);
    CHECK(result.fraction[k][16] == 0.5); // a right angle
    CHECK(result.deviation[k] == doctest::Approx(exact).epsilon(1e-14));
  }
}

TEST_CASE("each plane has its angle, and a bond and its opposite are one") {
  const double angle = 5 * std::numbers::pi / 32; // the middle of class 5
  for (const double sense : {1.0, -1.0}) {
    const Vec3 branch = sense * Vec3(std::cos(angle), std::sin(angle), 0.3);
    const auto result = network::anisotropy(chain({branch}));
    CHECK(result.fraction[2][5] == 1); // (x, y)
    // One bond in one class is the largest deviation there is.
    CHECK(result.deviation[2] == doctest::Approx(std::sqrt(31.0) / 32).epsilon(1e-14));
    const auto turned = network::anisotropy(chain({Vec3(branch[2], branch[0], branch[1])}));
    CHECK(turned.fraction[0][5] == 1); // (y, z)
    const auto turned_twice = network::anisotropy(chain({Vec3(branch[1], branch[2], branch[0])}));
    CHECK(turned_twice.fraction[1][5] == 1); // (z, x)
  }
}

TEST_CASE("rounding does not move a bond along an axis or a diagonal to another class") {
  for (const double error : {-1e-15, 0.0, 1e-15}) {
    const auto result =
        network::anisotropy(chain({Vec3(1, error, 1), Vec3(-1, error, -1), Vec3(1, 1 + error, 0)}));
    CHECK(result.fraction[2][0] == doctest::Approx(2.0 / 3)); // along x, either sense
    CHECK(result.fraction[2][8] == doctest::Approx(1.0 / 3)); // 45 degrees
  }
}

TEST_CASE("fractions add up to one, with any number of classes, and classes are evenly spaced") {
  const BondNetwork network = isotropic_chain(1234, 6);
  const auto result = network::anisotropy<7>(network);
  for (const auto& plane : result.fraction)
    CHECK(std::accumulate(plane.begin(), plane.end(), 0.0) == doctest::Approx(1).epsilon(1e-14));
  CHECK(result.angle(0) == 0);
  CHECK(network::Anisotropy<32>::angle(16) == doctest::Approx(std::numbers::pi / 2));
}

TEST_CASE(
    "chance alone gives 9.9e-4 at 31,000 bonds and 9.9e-5 at 3,100,000: the paper prints 1.3e-3 and 3.8e-4") {
  CHECK(network::isotropic_deviation(31000) == doctest::Approx(9.88e-4).epsilon(1e-3));
  CHECK(network::isotropic_deviation(3100000) == doctest::Approx(9.88e-5).epsilon(1e-3));
}

TEST_CASE("bad input gets one message that names the value and what is accepted") {
  using core::InvalidInput;
  CHECK_THROWS_WITH_AS(
      network::anisotropy({}),
      "number of bonds with a direction across the x axis = 0 is not accepted: at least 1 is expected",
      InvalidInput);
  CHECK_THROWS_WITH_AS(
      network::anisotropy(chain({Vec3::UnitY()})),
      "number of bonds with a direction across the y axis = 0 is not accepted: at least 1 is expected",
      InvalidInput);
  CHECK_THROWS_WITH_AS(
      network::anisotropy(chain({Vec3(1, std::numeric_limits<double>::quiet_NaN(), 0)})),
      "length of bond 0 = nan is not accepted: a finite length above 0 m is expected: do two particles "
      "share one centre?",
      InvalidInput);
  CHECK_THROWS_WITH_AS(network::isotropic_deviation(0),
                       "number of bonds = 0 is not accepted: at least 1 is expected", InvalidInput);
  CHECK_THROWS_WITH_AS(network::isotropic_deviation(5, 0),
                       "number of angle classes = 0 is not accepted: at least 1 is expected", InvalidInput);
}
