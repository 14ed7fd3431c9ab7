#include <cdem/bond/bond_forces.hpp>
#include <cdem/bond/finite_rotation.hpp>
#include <cdem/bond/thermal.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <numbers>

#include "body.hpp"

namespace {

using namespace cdem;
using body::Body;
using body::contains;
using body::evaluated;
using body::SpatialField;
using bond::BondForces;
using bond::Thermal;

const bond::Beam<> beam({.materials = {{1, 0.6}, {30, 0.4}}});

double largest(const SpatialField& force) {
  return body::flat(force).lpNorm<Eigen::Infinity>();
}

/// Displacements of linear forces, K u = f0: f0 what they are at rest, `held` the degrees of freedom that do not move.
template <class Law>
Eigen::VectorXd at_rest(const Law& law, const Body& body, const std::vector<Eigen::Index>& held) {
  const SpatialField zero(body.particles.size());
  const BondForces<Law> forces(law, body.particles, body.network);
  core::ThreadPool pool;
  Eigen::VectorXd load = body::flat(evaluated(forces, zero));
  Eigen::MatrixXd stiffness = body::dense_stiffness(forces.tangent(zero, pool));
  for (const Eigen::Index dof : held) {
    stiffness.row(dof).setZero();
    stiffness.col(dof).setZero();
    stiffness(dof, dof) = stiffness.diagonal().maxCoeff();
    load[dof] = 0;
  }
  return stiffness.llt().solve(load);
}

} // namespace

TEST_CASE("a heated body that is free grows by alpha dT, without stress, small and finite") {
  Body random = body::random_body(500, 3);
  const double growth = 1.7e-5 * 400;
  SpatialField motion(500);
  for (std::size_t i = 0; i < 500; ++i)
    motion[i].linear() = growth * random.particles.position[i];
  const auto check = [&](const auto& law) {
    const BondForces forces(law, random.particles, random.network);
    const double clamped = largest(evaluated(forces, SpatialField(500)));
    CHECK(clamped > 1e-3);
    CHECK(largest(evaluated(forces, motion)) < 1e-13 * clamped);
    core::ThreadPool pool;
    CHECK(forces.elastic_energy(motion, pool) < 1e-20 * forces.elastic_energy(SpatialField(500), pool));
  };
  check(Thermal(beam, {1.7e-5, 1.7e-5}, {400}));
  check(Thermal(beam, {1.7e-5, 1.7e-5}, std::vector<double>(500, 400)));
  check(bond::FiniteRotation(Thermal(beam, {1.7e-5, 1.7e-5}, {400})));
}

TEST_CASE("a bond's dilatation shares its length by radii and its temperature by halves") {
  const Thermal law(beam, {1e-5, 4e-5}, {100, 300, 0});
  bond::BondGeometry geometry{.direction = Vec3::UnitX(), .length = 5, .radius_first = 3, .radius_second = 1};
  geometry.second = 1;
  CHECK(law.prepare(geometry).dilatation == doctest::Approx(5 * 1e-5 * 200).epsilon(1e-14));
  geometry.phase_second = 1; // 3/4 of 1e-5 and 1/4 of 4e-5
  CHECK(law.prepare(geometry).dilatation == doctest::Approx(5 * 1.75e-5 * 200).epsilon(1e-14));
}

TEST_CASE("a bar of two materials between walls bears the force of the sum of its dilatations") {
  Body bar = body::row(8, Vec3(1, 2, -2) / 3, 2, 1);
  for (std::size_t i = 5; i < 8; ++i)
    bar.particles.phase[i] = 1;
  const Thermal law(beam, {1e-5, 3e-5}, {250});
  std::vector<Eigen::Index> held;
  for (Eigen::Index dof = 0; dof < 6; ++dof)
    held.insert(held.end(), {dof, 42 + dof});
  const Eigen::VectorXd solution = at_rest(law, bar, held);
  SpatialField motion(8);
  for (std::size_t i = 0; i < 8; ++i)
    for (int dof = 0; dof < 6; ++dof)
      motion[i][dof] = solution[6 * static_cast<Eigen::Index>(i) + dof];
  double dilatation = 0, compliance = 0;
  for (BondIndex b = 0; b < 7; ++b) {
    const double expansion = b < 4 ? 1e-5 : b == 4 ? 2e-5 : 3e-5;
    dilatation += expansion * 250 * 2;
    compliance += 1 / beam.stiffness(bond::geometry_of(b, bar.particles, bar.network)).normal;
  }
  std::vector<Vec3> found;
  core::ThreadPool pool;
  BondForces(law, bar.particles, bar.network).bond_forces(motion, found, pool);
  for (const Vec3& force : found) // compression: pushes the first particle back
    CHECK((force + dilatation / compliance * Vec3(1, 2, -2) / 3).norm() < 1e-10 * dilatation / compliance);
}

TEST_CASE("a bimetal strip curves as Timoshenko (1925) says of its two layers") {
  // A ladder: two rows of unlike beams a distance h apart, rungs between; far from the ends it is a composite beam with
  //   curvature = (alpha_2 - alpha_1) dT / (h + (E_1 I_1 + E_2 I_2)(1/(E_1 A_1) + 1/(E_2 A_2))/h)
  const std::size_t cells = 60;
  const double spacing = 1, height = 1.3, rise = 100;
  Body strip;
  strip.particles.resize(2 * cells);
  strip.network.particle_count = 2 * cells;
  const auto join = [&](std::size_t i, std::size_t j) {
    strip.network.first.push_back(static_cast<ParticleIndex>(i));
    strip.network.second.push_back(static_cast<ParticleIndex>(j));
    strip.network.branch.push_back(strip.particles.position[j] - strip.particles.position[i]);
  };
  for (std::size_t i = 0; i < 2 * cells; ++i) {
    strip.particles.position[i] = {spacing * static_cast<double>(i / 2), height * static_cast<double>(i % 2),
                                   0};
    strip.particles.radius[i] = 0.5;
    strip.particles.phase[i] = static_cast<PhaseIndex>(i % 2);
  }
  for (std::size_t i = 0; i < 2 * cells; ++i) {
    if (i % 2 == 0)
      join(i, i + 1);
    if (i + 2 < 2 * cells)
      join(i, i + 2);
  }
  const Eigen::VectorXd solution = at_rest(Thermal(beam, {1e-5, 3e-5}, {rise}), strip, {0, 1, 2, 3, 4, 5});

  double rigidity = 0, compliance = 0; // E I of both, 1/(E A) of both
  for (const auto& [modulus, ratio] : {std::pair{1.0, 0.6}, {30.0, 0.4}}) {
    const double a = ratio * 0.5, area = std::numbers::pi * a * a;
    rigidity += modulus * 0.25 * area * a * a;
    compliance += 1 / (modulus * area);
  }
  const double curvature = 2e-5 * rise / (height + rigidity * compliance / height);
  const auto angle = [&](std::size_t cell) { return solution[6 * 2 * static_cast<Eigen::Index>(cell) + 5]; };
  // the upper row grows more: the strip turns down
  CHECK((angle(40) - angle(20)) / (20 * spacing) == doctest::Approx(-curvature).epsilon(1e-6));
  CHECK(angle(31) - angle(30) == doctest::Approx(-curvature * spacing).epsilon(1e-6));
}

TEST_CASE("temperatures and expansions that do not fit are refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Body row = body::row(3, Vec3::UnitX(), 2, 1);
  const auto message = [&](std::vector<double> expansion, std::vector<double> rise, PhaseIndex phase = 0) {
    return body::message_of([&] {
      Body three = row;
      three.particles.phase[2] = phase;
      BondForces forces(Thermal(beam, expansion, rise), three.particles, three.network);
    });
  };
  CHECK(contains(message({}, {1}), "number of values of the thermal expansion = 0 is not accepted"));
  CHECK(contains(message({1}, {}), "number of values of the temperature rise = 0 is not accepted"));
  CHECK(contains(message({1, nan}, {1}), "thermal expansion of phase 1 = nan"));
  CHECK(contains(message({1}, {1, 2, nan}), "temperature rise of particle 2 = nan"));
  CHECK(
      contains(message({1}, {1, 2}), "number of temperature rises = 2 is not accepted: 1 or the number of"));
  CHECK(contains(message({1}, {1}, 1), "phase of particle 2 = 1 is not accepted: a phase with a thermal"));
  CHECK(contains(message({1}, {1}, 2), "phase of particle 2 = 2 is not accepted")); // no material either
  CHECK(message({1, 2}, {1}, 1) == "no InvalidInput thrown");
}
