#include <cdem/bond/linear_forces.hpp>
#include <cdem/bond/spring.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <numbers>

#include "body.hpp"

namespace {
using namespace cdem;
using bond::Spring;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
} // namespace

TEST_CASE("a spring resists stretch and slip, neither twist nor bend") {
  const Spring<> law({.materials = {{100e9, 0.5}}, .tangential_ratio = 0.25});
  const bond::ChannelStiffness k = law.stiffness(
      {.direction = Vec3::UnitX(), .length = 4e-3, .radius_first = 1e-3, .radius_second = 3e-3});
  CHECK(k.normal == doctest::Approx(100e9 * std::numbers::pi * 1e-6 / 4e-3).epsilon(1e-14));
  CHECK(k.tangential == doctest::Approx(k.normal / 4).epsilon(1e-14));
  CHECK(k.torsion == 0);
  CHECK(k.bending == 0);
}

TEST_CASE("central springs feel no rotation, and push along the bond alone") {
  const auto [particles, network] = body::random_body(60, 5);
  const bond::LinearForces forces(Spring<>({.materials = {{1, 1}, {2, 0.5}}}), particles, network);
  core::ThreadPool pool;
  auto motion = body::random_motion(60, 0.1, 6);
  for (auto& spatial : motion)
    spatial.linear().setZero();
  body::SpatialField force(60);
  forces.evaluate(motion, force, pool);
  CHECK(body::flat(force).norm() < 1e-14);

  motion = body::random_motion(60, 0.1, 7);
  double worst = 0;
  for (BondIndex b = 0; b < forces.bond_count(); ++b) {
    const bond::BondLoad load = forces.load(b, motion);
    worst = std::max({worst, load.force.cross(forces.direction(b)).norm(), load.moment_first.norm()});
  }
  CHECK(worst < 1e-15);
}

TEST_CASE("simple cubic springs have the modulus E = K_n / d") {
  // two layers d apart hold together by one spring per d^2: sigma = K_n u / d^2, strain u / d
  const double d = 2e-3;
  const auto [particles, network] = body::row(5, Vec3::UnitX(), d, d / 2);
  const bond::LinearForces forces(Spring<>({.materials = {{70e9, 0.8}}}), particles, network);
  body::SpatialField motion(5);
  const double strain = 1e-4;
  for (std::size_t i = 0; i < 5; ++i)
    motion[i][0] = strain * particles.position[i].x();
  const double stress = forces.load(2, motion).force.x() / (d * d);
  CHECK(stress / strain ==
        doctest::Approx(70e9 * std::numbers::pi * 0.8 * 0.8 / 4).epsilon(1e-12)); // E_mu A/d^2
}

TEST_CASE("bad springs are refused by name") {
  const auto message = [](Spring<>::Parameters parameters) {
    return body::message_of([&] { Spring<> law(parameters); });
  };
  CHECK(body::contains(message({.materials = {{1, 1}}, .tangential_ratio = -0.1}),
                       "tangential_ratio of the spring = -0.1 is not accepted"));
  CHECK(body::contains(message({.materials = {{1, 1}}, .tangential_ratio = not_a_number}),
                       "tangential_ratio of the spring = nan is not accepted"));
  CHECK(body::contains(message({.materials = {}}), "number of materials = 0 is not accepted"));
  CHECK(body::contains(message({.materials = {{0, 1}}}), "E_mu of phase 0 = 0 is not accepted"));
}
