#include <cdem/bond/bond_law.hpp>

#include <doctest/doctest.h>

#include "body.hpp"

namespace {

using namespace cdem;
using bond::BondLoad;
using bond::ChannelStiffness;

/// Four stiffnesses of any proportion: what follows holds for every law, not for the beam alone.
ChannelStiffness random_stiffness(core::Random& random) {
  return {random.uniform(), random.uniform(), random.uniform(), random.uniform()};
}

BondLoad load_between(const ChannelStiffness& stiffness, const Vec3& direction, double length,
                      const body::Vector12& ends) {
  return bond::load_of(stiffness, direction, length,
                       bond::deformation_of(direction, length, body::end_of(ends, 0), body::end_of(ends, 1)));
}

} // namespace

TEST_CASE("a bond's loads balance: the moments about any point cancel") {
  core::Random random(2);
  double worst = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 direction = body::random_vector(random, 1).normalized();
    const double length = random.uniform(0.5, 2);
    const BondLoad load =
        load_between(random_stiffness(random), direction, length, body::random_ends(random, 1));
    // the first end at `place`, its neighbour a branch away; the forces are opposite by definition
    const Vec3 place = body::random_vector(random, 1);
    const Vec3 moment = place.cross(load.force) + load.moment_first -
                        (place + length * direction).cross(load.force) + load.moment_second;
    worst = std::max(worst, moment.norm());
  }
  CHECK(worst < 1e-14);
}

TEST_CASE("a rigid motion does not deform a bond") {
  core::Random random(3);
  double worst = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 direction = body::random_vector(random, 1).normalized();
    const double length = random.uniform(0.5, 2);
    const Vec3 place = body::random_vector(random, 1), translation = body::random_vector(random, 1);
    const Vec3 rotation = body::random_vector(random, 1);
    body::Vector12 ends;
    ends << translation + rotation.cross(place), rotation,
        translation + rotation.cross(place + length * direction), rotation;
    const bond::BondDeformation deformation =
        bond::deformation_of(direction, length, body::end_of(ends, 0), body::end_of(ends, 1));
    worst = std::max({worst, deformation.slip.norm(), deformation.turn.norm()});
  }
  CHECK(worst < 1e-14);
}

TEST_CASE("each of the four deformations meets its own stiffness") {
  const Vec3 n = Vec3(2, -1, 2) / 3, across = Vec3(1, 2, 0).normalized();
  const ChannelStiffness stiffness{2, 3, 5, 7};
  const double length = 1.5;
  const auto load = [&](const Vec3& slip, const Vec3& turn) {
    return bond::load_of(stiffness, n, length, {slip, turn});
  };
  const double tolerance = 1e-14;
  CHECK((load(n, Vec3::Zero()).force - 2 * n).norm() < tolerance);
  CHECK(load(n, Vec3::Zero()).moment_first.norm() < tolerance);
  CHECK((load(across, Vec3::Zero()).force - 3 * across).norm() < tolerance);
  CHECK((load(across, Vec3::Zero()).moment_first - 0.75 * n.cross(3 * across)).norm() < tolerance);
  CHECK((load(across, Vec3::Zero()).moment_second - 0.75 * n.cross(3 * across)).norm() < tolerance);
  CHECK((load(Vec3::Zero(), n).moment_first - 5 * n).norm() < tolerance);
  CHECK((load(Vec3::Zero(), n).moment_second + 5 * n).norm() < tolerance);
  CHECK((load(Vec3::Zero(), across).moment_first - 7 * across).norm() < tolerance);
  CHECK((load(Vec3::Zero(), across).moment_second + 7 * across).norm() < tolerance);
  CHECK(load(Vec3::Zero(), across).force.norm() == 0);
}

TEST_CASE("the loads are minus the gradient of the energy") {
  core::Random random(4);
  double worst = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 direction = body::random_vector(random, 1).normalized();
    const double length = random.uniform(0.5, 2);
    const ChannelStiffness stiffness = random_stiffness(random);
    const body::Vector12 ends = body::random_ends(random, 1);
    const body::Vector12 loads = body::on_both_ends(load_between(stiffness, direction, length, ends));
    const auto energy = [&](const body::Vector12& moved) {
      return energy_of(
          stiffness, direction,
          bond::deformation_of(direction, length, body::end_of(moved, 0), body::end_of(moved, 1)));
    };
    for (int k = 0; k < 12; ++k) { // a quadratic energy: central differences are exact but for rounding
      const body::Vector12 step = 0.5 * body::Vector12::Unit(k);
      worst = std::max(worst, std::abs(energy(ends - step) - energy(ends + step) - loads[k]));
    }
  }
  CHECK(worst < 1e-13);
}

TEST_CASE("the geometry of a bond is that of its branch") {
  auto [particles, network] = body::row(2, Vec3::UnitY(), 0.5, 0.25);
  particles.radius[1] = 0.3;
  particles.phase[1] = 4;
  network.branch[0] = Vec3(0, -3, 4); // through a periodic face: not the difference of the positions
  const bond::BondGeometry geometry = bond::geometry_of(0, particles, network);
  CHECK((geometry.direction - Vec3(0, -0.6, 0.8)).norm() < 1e-15);
  CHECK(geometry.length == 5);
  CHECK(geometry.radius_first == 0.25);
  CHECK(geometry.radius_second == 0.3);
  CHECK(geometry.phase_first == 0);
  CHECK(geometry.phase_second == 4);
}
