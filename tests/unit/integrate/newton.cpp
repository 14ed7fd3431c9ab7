// Newton's method with the static multigrid, on laws that are not linear.

#include <cdem/bond/bond_forces.hpp>
#include <cdem/integrate/static_multigrid.hpp>
#include <cdem/particles/inertia.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "../bond/body.hpp"

namespace {

using namespace cdem;

/// N = k s + c s^3 along the bond, c below 0 softens; k L^2/100 against all else.
struct Cubic {
  double k = 1, c = 0;
  template <class Real>
  Real energy(const bond::BondGeometry&, const bond::Deformation<Real>& d) const {
    const Real s2 = d.stretch * d.stretch;
    return 0.5 * k * s2 + 0.25 * c * s2 * s2 +
           0.01 * k * (d.shear.squared() + d.twist * d.twist + d.bend.squared());
  }
  void validate(const particles::ParticleSet&) const {}
};
static_assert(bond::EnergyLaw<Cubic>);

/// A row of bonds of length 1 along a slanted direction, held at its first particle and pulled at its last.
struct Row {
  static constexpr ParticleIndex last = 12;
  body::Body row = body::row(last + 1, Vec3(1, 2, 2).normalized(), 1, 0.5);
  particles::Inertia inertia = particles::solid_spheres(row.particles, std::vector<double>{1});
  particles::Constraints constraints;
  particles::SpatialField<> load{last + 1};
  particles::Motion motion = particles::Motion::at_rest(last + 1);
  core::ThreadPool pool;

  Row() {
    for (std::uint8_t dof = 0; dof < 6; ++dof)
      constraints.add({0, dof, 0});
  }
  integrate::StaticMultigrid::Report pull(const Cubic& law, double force) {
    const bond::BondForces<Cubic> forces(law, row.particles, row.network);
    load[last].linear() = force * forces.direction(0);
    return integrate::StaticMultigrid({.relative_residual = 1e-10})
        .solve(integrate::Problem{forces, inertia, constraints, &load}, motion, pool);
  }
};

} // namespace

TEST_CASE("a row of stiffening bonds stretches by the root of the cubic, each bond alike") {
  Row row;
  const Cubic law{.k = 1, .c = 300};
  const double force = 0.5, stretch = [&] { // N = k s + c s^3
    double s = 0.1;
    for (int step = 0; step < 60; ++step)
      s -= (law.k * s + law.c * s * s * s - force) / (law.k + 3 * law.c * s * s);
    return s;
  }();
  const auto report = row.pull(law, force);
  CHECK(report.newton_iterations > 2);
  CHECK(report.relative_residual <= 1e-10);
  const Vec3 direction = Vec3(1, 2, 2).normalized();
  for (ParticleIndex i = 0; i <= Row::last; ++i)
    CHECK((row.motion.displacement[i].linear() - i * stretch * direction).norm() < 1e-8);
}

TEST_CASE("linear forces take one Newton step") {
  Row row;
  CHECK(row.pull({.k = 2, .c = 0}, 0.5).newton_iterations == 1);
  CHECK(row.motion.displacement[Row::last].linear().norm() ==
        doctest::Approx(Row::last * 0.25).epsilon(1e-9));
}

TEST_CASE("a load beyond what the bonds bear is not reached, and says so") {
  // N = k s (1 - s^2) is largest at s = 1/sqrt(3): 0.385
  Row row;
  const Cubic law{.k = 1, .c = -1};
  CHECK_NOTHROW(row.pull(law, 0.3));
  std::string message;
  row.motion = particles::Motion::at_rest(Row::last + 1);
  try {
    row.pull(law, 0.5);
  } catch (const core::NotReached& error) {
    message = error.what();
  }
  CHECK(body::contains(message, "Newton's method: relative residual"));
  CHECK(body::contains(message, "1e-10 was asked for"));
}
