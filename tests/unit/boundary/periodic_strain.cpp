#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/boundary/periodic_strain.hpp>
#include <cdem/core/random.hpp>
#include <cdem/simulation/specimen.hpp>

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "integration/bodies.hpp"

using namespace cdem;
using boundary::PeriodicStrain;

namespace {

/// The shaken cube of the other tests, bonded through its faces.
simulation::Specimen periodic_cube(int edge) {
  const auto walled = bodies::shaken_cube(edge, 1e-3, 5, 3);
  core::ThreadPool pool;
  return simulation::make_periodic_specimen(walled.particles, geometry::Box::cube(edge * 1e-3, true), 6.2,
                                            pool);
}

Mat3 any_strain() {
  Mat3 strain;
  strain << 1e-3, 3e-4, -2e-4, 3e-4, -5e-4, 1e-4, -2e-4, 1e-4, 7e-4;
  return strain;
}

std::string complaint(const Mat3& strain) {
  try {
    PeriodicStrain{strain};
  } catch (const core::InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

} // namespace

TEST_CASE("away from the faces the load is the internal force of the affine motion") {
  const auto body = periodic_cube(6);
  const bond::LinearForces forces(bond::Beam<>({.materials = {{1e9, 0.5}}}), body.particles, body.network);
  core::ThreadPool pool;
  const PeriodicStrain strain(any_strain());
  const auto load = strain.load(forces, pool);

  particles::SpatialField<> affine(body.particles.size()), force;
  for (std::size_t i = 0; i < affine.size(); ++i)
    affine[i].linear() = strain.strain() * body.particles.position[i];
  forces.evaluate(affine, force, pool);
  std::vector<bool> at_face(affine.size(), false);
  for (BondIndex b = 0; b < body.network.size(); ++b) {
    const auto i = body.network.first[b], j = body.network.second[b];
    if ((body.particles.position[j] - body.particles.position[i] - body.network.branch[b]).norm() > 1e-9)
      at_face[i] = at_face[j] = true;
  }
  std::size_t compared = 0;
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < affine.size(); ++i) {
    sum += load[i].linear();
    if (at_face[i])
      continue;
    ++compared;
    CHECK((load[i].linear() - force[i].linear()).norm() < 1e-11 * force[i].linear().norm());
    CHECK((load[i].angular() - force[i].angular()).norm() < 1e-11 * force[i].linear().norm() * 1e-3);
  }
  CHECK(compared > 20);
  CHECK(sum.norm() < 1e-10);
}

TEST_CASE("energy is that of the bonds, stress its derivative with the strain, at any fluctuation") {
  const auto body = periodic_cube(5);
  const bond::LinearForces forces(bond::Beam<>({.materials = {{1e9, 0.5}}}), body.particles, body.network);
  core::ThreadPool pool;
  core::Random random(8);
  particles::SpatialField<> u(body.particles.size());
  for (auto& one : u)
    for (int dof = 0; dof < 6; ++dof)
      one[dof] = random.uniform(-1, 1) * (dof < 3 ? 3e-7 : 3e-4);
  const auto energy = [&](const Mat3& strain) {
    const PeriodicStrain periodic(strain);
    return periodic.energy(forces, periodic.load(forces, pool), u, pool);
  };
  const PeriodicStrain strain(any_strain());

  double bonds = 0; // each bond by itself, its second end moved by E.b more than it moves
  for (BondIndex b = 0; b < forces.bond_count(); ++b) {
    const auto [i, j] = forces.ends(b);
    auto second = u[j];
    second.linear() += strain.strain() * body.network.branch[b];
    const Vec3 n = forces.direction(b), turn = second.angular() - u[i].angular();
    const Vec3 g = second.linear() - u[i].linear() -
                   forces.length(b) * (0.5 * (second.angular() + u[i].angular())).cross(n);
    const auto k = forces.stiffness(b);
    const double stretch = g.dot(n), twist = turn.dot(n);
    bonds += 0.5 * (k.normal * stretch * stretch + k.tangential * (g.squaredNorm() - stretch * stretch) +
                    k.torsion * twist * twist + k.bending * (turn.squaredNorm() - twist * twist));
  }
  CHECK(energy(strain.strain()) == doctest::Approx(bonds).epsilon(1e-12));

  const double volume = body.box.volume();
  const Mat3 stress = strain.mean_stress(forces, u, volume, pool);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Mat3 step = Mat3::Zero();
      step(i, j) += 0.5e-3;
      step(j, i) += 0.5e-3;
      const double slope = (energy(any_strain() + step) - energy(any_strain() - step)) / (2e-3 * volume);
      CHECK(0.5 * (stress(i, j) + stress(j, i)) == doctest::Approx(slope).epsilon(1e-9));
    }

  std::vector<Vec3> bond_forces;
  strain.bond_forces(forces, u, bond_forces, pool);
  Mat3 sum = Mat3::Zero();
  for (BondIndex b = 0; b < forces.bond_count(); ++b)
    sum += bond_forces[b] * body.network.branch[b].transpose();
  CHECK((sum / volume - stress).norm() < 1e-12 * stress.norm());
}

TEST_CASE("any number of threads gives the same load, bit by bit") {
  const auto body = periodic_cube(14); // more than one block
  const bond::LinearForces forces(bond::Beam<>({.materials = {{1e9, 0.5}}}), body.particles, body.network);
  core::ThreadPool one, three(3);
  const PeriodicStrain strain(any_strain());
  const auto a = strain.load(forces, one), b = strain.load(forces, three);
  CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
  CHECK(strain.affine_stress(forces, 1, one) == strain.affine_stress(forces, 1, three));
}

TEST_CASE("a strain that is not finite or not symmetric, and a walled box, are refused by name") {
  CHECK(complaint(any_strain()) == "accepted");
  Mat3 strain = any_strain();
  strain(1, 2) = std::numeric_limits<double>::quiet_NaN();
  CHECK(complaint(strain) == "mean strain yz = nan is not accepted: a finite number is expected");
  strain = Mat3::Zero();
  strain(1, 0) = 0.5;
  strain(0, 1) = -0.5;
  CHECK(complaint(strain) ==
        "difference of the mean strains yx and xy = 1 is not accepted: a symmetric tensor is "
        "expected: a rotation of the cell strains nothing");
  auto box = geometry::Box::cube(1, true);
  CHECK_NOTHROW(PeriodicStrain::validate(box));
  box.periodic[1] = false;
  CHECK_THROWS_WITH_AS(
      PeriodicStrain::validate(box),
      "box along y = walled is not accepted: a body that is periodic in all directions is expected "
      "under a mean strain",
      core::InvalidInput);
}
