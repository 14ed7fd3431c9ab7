#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/bond/spring.hpp>
#include <cdem/homogenize/periodic_stiffness.hpp>
#include <cdem/packing/lattice.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/simulation/specimen.hpp>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include "common/static_solver.hpp"

using namespace cdem;
using homogenize::Matrix6;
using homogenize::periodic_stiffness;

namespace {

constexpr examples::StaticSolver solver{.relative_residual =
                                            1e-10}; // integrate::StaticMultigrid, compiled elsewhere

const bond::Beam<>& beam() {
  static const bond::Beam<> made({.materials = {{1e9, 0.5}}});
  return made;
}

/// Points on a rectangular grid of 8 x 5 x 5 with these spacings, a < b < c < sqrt(a^2 + b^2), each bonded to its six
/// neighbours; two layers of phase 0 follow two of phase 1 along x if `layered`.
simulation::Specimen grid(const Vec3& spacing, bool layered) {
  particles::ParticleSet particles;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 5; ++z) {
        particles.position.push_back(spacing.cwiseProduct(Vec3(x, y, z)));
        particles.radius.push_back(0.5e-3);
        particles.phase.push_back(layered && x % 4 > 1 ? 1 : 0);
      }
  core::ThreadPool pool;
  const geometry::Box box{Vec3::Zero(), spacing.cwiseProduct(Vec3(8, 5, 5)), {true, true, true}};
  return simulation::make_periodic_specimen(particles, box, 6, pool);
}

template <class Law>
auto measure(const Law& law, const simulation::Specimen& body) {
  core::ThreadPool pool;
  const bond::LinearForces forces(law, body.particles, body.network);
  return periodic_stiffness(forces, body.box, solver, pool);
}

packing::LubachevskyStillinger::Parameters small_packing() {
  return {.particles = 1000, .density = 0.6, .cov = 0.1, .growth_rate = 0.1};
}

const simulation::Specimen& random_body() {
  static const simulation::Specimen made = [] {
    const auto packing = packing::LubachevskyStillinger(small_packing()).pack();
    core::ThreadPool pool;
    return simulation::make_periodic_specimen(packing.particles, packing.box, 6.2, pool);
  }();
  return made;
}

} // namespace

TEST_CASE("rectangular grid of beams: three moduli, none across, shear with joints that turn") {
  const Vec3 d(1e-3, 1.1e-3, 1.2e-3);
  const auto measured = measure(beam(), grid(d, false));
  const Matrix6& c = measured.stiffness.voigt();
  const double area = std::numbers::pi * 0.0625e-6, inertia = 0.25 * area * 0.0625e-6;
  Matrix6 exact = Matrix6::Zero();
  for (int k = 0; k < 3; ++k) {
    exact(k, k) = 1e9 * area * d[k] / d.prod(); // E A over the cross section
    // Both beams of a plane are bent between joints that do not move but turn by the same angle: two springs
    // K_t L^2 = 12 E I / L in series.
    const double one = 12e9 * inertia / d[(k + 1) % 3], other = 12e9 * inertia / d[(k + 2) % 3];
    exact(k + 3, k + 3) = one * other / (one + other) / d.prod();
  }
  CHECK((c - exact).norm() < 1e-9 * exact.norm());
  for (int k = 3; k < 6; ++k) {
    CHECK(c(k, k) == doctest::Approx(exact(k, k)).epsilon(1e-9));
    CHECK(measured.affine.voigt()(k, k) > 1.0001 * c(k, k)); // joints that may not turn are stiffer
  }
  CHECK((measured.energy - exact.diagonal()).norm() < 1e-9 * exact.norm());
}

TEST_CASE("layers in series along x, side by side along y") {
  const Vec3 d(1e-3, 1.1e-3, 1.2e-3);
  const bond::Beam<> law({.materials = {{1e9, 0.5}, {4e9, 0.5}}}); // 2e9 between them
  const auto measured = measure(law, grid(d, true));
  const double area = std::numbers::pi * 0.0625e-6;
  const double series = 4 / (1 / 1e9 + 1 / 2e9 + 1 / 4e9 + 1 / 2e9);
  CHECK(measured.stiffness.voigt()(0, 0) == doctest::Approx(series * area / (d.y() * d.z())).epsilon(1e-8));
  CHECK(measured.stiffness.voigt()(1, 1) == doctest::Approx(2.5e9 * area / (d.x() * d.z())).epsilon(1e-8));
  CHECK(measured.affine.voigt()(0, 0) == doctest::Approx(2.25e9 * area / (d.y() * d.z())).epsilon(1e-8));
}

TEST_CASE("fcc with central forces: Cauchy's relation, Zener's ratio 2") {
  const auto packing = packing::Lattice({.cells = {4, 4, 4}}).pack();
  core::ThreadPool pool;
  const auto body = simulation::make_periodic_specimen(packing.particles, packing.box, 12, pool);
  const auto measured = measure(bond::Spring<>({.materials = {{1e9, 0.5}}}), body);
  const double diameter = 1e-3, k = 1e9 * std::numbers::pi * 0.0625e-6 / diameter;
  const Matrix6& c = measured.stiffness.voigt();
  Matrix6 exact = Matrix6::Zero(); // Born & Huang 1954: C11 = 2 C12 = 2 C44 = sqrt 2 k/d
  exact.topLeftCorner<3, 3>().setConstant(0.5);
  exact.diagonal() << 1, 1, 1, 0.5, 0.5, 0.5;
  exact *= std::numbers::sqrt2 * k / diameter;
  CHECK((c - exact).norm() < 1e-12 * exact.norm());
  const auto extremes = measured.stiffness.youngs_modulus_extremes();
  CHECK(extremes.largest / extremes.smallest ==
        doctest::Approx(1.8).epsilon(1e-9)); // S11, S12, S44 = 1.5, -0.5, 2
}

TEST_CASE("random packing: symmetric, stress as energy, below the affine bound, as isotropic as it is") {
  const auto measured = measure(beam(), random_body());
  CHECK(measured.stiffness.asymmetry() < 1e-8);
  CHECK(measured.energy_mismatch() < 1e-8);
  CHECK(measured.stress_asymmetry < 1e-8);
  const Eigen::SelfAdjointEigenSolver<Matrix6> gap(measured.affine.kelvin() - measured.stiffness.kelvin());
  CHECK(gap.eigenvalues()[0] > 0.01 * measured.stiffness.kelvin().norm());
  CHECK(measured.stiffness.distance_from_isotropy() < 0.05);
  CHECK(measured.stiffness.universal_anisotropy() > 0);
  CHECK(measured.reports[5].relative_residual <= 1e-10);

  // Any strain costs what the six say: their superposition, off-diagonal terms included.
  const bond::LinearForces forces(beam(), random_body().particles, random_body().network);
  core::ThreadPool pool;
  homogenize::Vector6 e;
  e << 1, -0.5, 0.3, 0.8, -0.2, 0.4;
  const boundary::PeriodicStrain strain(homogenize::strain_of_voigt(e));
  const auto load = strain.load(forces, pool);
  const auto inertia = particles::solid_spheres(random_body().particles, std::vector<double>{1000.0});
  const particles::Constraints none;
  auto motion = particles::Motion::at_rest(forces.particle_count());
  solver.solve(integrate::Problem<bond::LinearForces>{forces, inertia, none, &load}, motion, pool, {});
  CHECK(2 * strain.energy(forces, load, motion.displacement, pool) / random_body().box.volume() ==
        doctest::Approx(e.dot(measured.stiffness.voigt() * e)).epsilon(1e-8));
}

TEST_CASE("a packing repeated is as stiff as one copy, and so is a packing shifted through its faces") {
  const auto& body = random_body();
  const Matrix6 one = measure(beam(), body).stiffness.voigt();
  core::ThreadPool pool;
  auto packing = packing::LubachevskyStillinger(small_packing()).pack();

  particles::ParticleSet two; // 2 x 1 x 1 copies
  for (int copy = 0; copy < 2; ++copy)
    for (std::size_t i = 0; i < packing.particles.size(); ++i) {
      two.position.push_back(packing.particles.position[i] + copy * packing.box.size().x() * Vec3::UnitX());
      two.radius.push_back(packing.particles.radius[i]);
      two.phase.push_back(0);
    }
  geometry::Box longer = packing.box;
  longer.upper.x() += packing.box.size().x();
  const Matrix6 repeated =
      measure(beam(), simulation::make_periodic_specimen(two, longer, 6.2, pool)).stiffness.voigt();
  CHECK((repeated - one).norm() < 1e-8 * one.norm());

  for (Vec3& x : packing.particles.position)
    x = packing.box.wrap(x + packing.box.size().cwiseProduct(Vec3(0.3, 0.45, 0.6)));
  const auto shifted = simulation::make_periodic_specimen(packing.particles, packing.box, 6.2, pool);
  CHECK((measure(beam(), shifted).stiffness.voigt() - one).norm() < 1e-8 * one.norm());
}

TEST_CASE("a walled box is refused") {
  const bond::LinearForces forces(beam(), random_body().particles, random_body().network);
  core::ThreadPool pool;
  CHECK_THROWS_AS(periodic_stiffness(forces, random_body().box.without_periodicity(), solver, pool),
                  core::InvalidInput);
}
