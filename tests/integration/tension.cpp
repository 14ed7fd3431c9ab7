// The whole chain from a bonded cube to its moduli and stresses, against what is known exactly.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/homogenize/static_tension.hpp>
#include <cdem/homogenize/tension_recorder.hpp>
#include <cdem/integrate/density_scaling.hpp>
#include <cdem/integrate/rayleigh_quotient.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/stress/closure.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/statistics.hpp>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <doctest/doctest.h>

#include <numbers>

#include "integration/bodies.hpp"

using namespace cdem;

namespace {

constexpr double modulus = 2536e9, ratio = 0.545;

bond::Beam<> alumina() {
  return bond::Beam<>({.materials = {{.youngs_modulus = modulus, .radius_ratio = ratio}}});
}

/// The equilibrium at unit time of the same body by a second method: K assembled column by column from evaluate(),
/// the free part solved by a sparse direct factorisation.
particles::Motion solve_directly(const integrate::Problem<bond::LinearForces>& problem,
                                 core::ThreadPool& pool) {
  const std::size_t count = problem.forces.particle_count();
  const auto size = static_cast<Eigen::Index>(6 * count);
  std::vector<bool> held(6 * count, false);
  Eigen::VectorXd prescribed = Eigen::VectorXd::Zero(size);
  for (const auto& c : problem.constraints.list()) {
    held[6 * c.particle + c.dof] = true;
    prescribed[static_cast<Eigen::Index>(6 * c.particle + c.dof)] = c.rate;
  }
  // columns of particles that share no neighbour are told apart by the particle's own bonds
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t b = 0; b < problem.forces.bond_count(); ++b) {
    const auto [i, j] = problem.forces.ends(b);
    for (const auto& [moved, dof_count] : {std::pair{i, 6}, std::pair{j, 6}})
      for (int dof = 0; dof < dof_count; ++dof) {
        particles::SpatialField<> u(count);
        u[moved][dof] = 1;
        const bond::BondLoad load = problem.forces.load(b, u);
        const auto column = static_cast<int>(6 * moved) + dof;
        for (int k = 0; k < 3; ++k) {
          entries.emplace_back(static_cast<int>(6 * i) + k, column, -load.force[k]);
          entries.emplace_back(static_cast<int>(6 * j) + k, column, load.force[k]);
          entries.emplace_back(static_cast<int>(6 * i) + 3 + k, column, -load.moment_first[k]);
          entries.emplace_back(static_cast<int>(6 * j) + 3 + k, column, -load.moment_second[k]);
        }
      }
  }
  Eigen::SparseMatrix<double> stiffness(size, size);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd load = -(stiffness * prescribed);
  std::vector<Eigen::Triplet<double>> kept;
  std::vector<int> number(6 * count, -1);
  int free = 0;
  for (std::size_t d = 0; d < 6 * count; ++d)
    if (!held[d] && stiffness.coeff(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(d)) > 0)
      number[d] = free++;
  for (int column = 0; column < stiffness.outerSize(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator it(stiffness, column); it; ++it) {
      const int r = number[static_cast<std::size_t>(it.row())], c = number[static_cast<std::size_t>(column)];
      if (r >= 0 && c >= 0)
        kept.emplace_back(r, c, it.value());
    }
  Eigen::SparseMatrix<double> inner(free, free);
  inner.setFromTriplets(kept.begin(), kept.end());
  Eigen::VectorXd right(free);
  for (std::size_t d = 0; d < 6 * count; ++d)
    if (number[d] >= 0)
      right[number[d]] = load[static_cast<Eigen::Index>(d)];
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(inner);
  REQUIRE(solver.info() == Eigen::Success);
  const Eigen::VectorXd solution = solver.solve(right);
  particles::Motion motion = particles::Motion::at_rest(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int dof = 0; dof < 6; ++dof) {
      const std::size_t d = 6 * i + static_cast<std::size_t>(dof);
      motion.displacement[i][dof] =
          number[d] >= 0 ? solution[number[d]] : prescribed[static_cast<Eigen::Index>(d)];
    }
  static_cast<void>(pool);
  return motion;
}

/// A cube under tension by both methods' common vocabulary.
struct Test {
  simulation::Specimen specimen;
  bond::LinearForces forces;
  boundary::TensionSetup setup;
  particles::Inertia inertia;
  core::ThreadPool pool;

  Test(simulation::Specimen body, Axis axis, double velocity, double tolerance)
      : specimen(std::move(body)), forces(alumina(), specimen.particles, specimen.network),
        setup(boundary::SymmetricTension{axis, velocity, tolerance}.apply(specimen.particles,
                                                                          specimen.network, specimen.box)),
        inertia(particles::solid_spheres(specimen.particles, std::vector{3900.0})), pool(2) {}

  integrate::Problem<bond::LinearForces> problem() const { return {forces, inertia, setup.constraints}; }
};

/// Elastic energy of the admissible field that stretches the body evenly by `axial` and shrinks it by `transverse`,
/// but for the prescribed components, which it takes as they are.
double energy_of_even_strain(Test& test, double axial, double transverse) {
  particles::SpatialField<> u(test.specimen.particles.size());
  const int axis = core::index_of(test.setup.axis);
  for (std::size_t i = 0; i < u.size(); ++i)
    for (int k = 0; k < 3; ++k)
      u[i][k] = (k == axis ? axial : -transverse) * test.specimen.particles.position[i][k];
  for (const auto& c : test.setup.constraints.list())
    u[c.particle][c.dof] = c.rate;
  return test.forces.elastic_energy(u, test.pool);
}

} // namespace

TEST_CASE("a simple cubic lattice has its exact modulus along each axis, and no Poisson effect") {
  constexpr double d = 1e-3;
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    Test test(bodies::cubic_lattice(5, d), axis, 1e-6, 1e-9);
    const auto problem = test.problem();
    const particles::Motion motion = solve_directly(problem, test.pool);
    const homogenize::TensionGauge gauge(test.specimen.particles, test.specimen.network, test.setup);
    const auto reading =
        gauge.faces(motion.displacement, integrate::static_reactions(problem, motion, test.pool));
    // columns of beams side by side, one on each d^2: E = (E_mu A / d) d / d^2 with A = pi (r_mu d/2)^2
    const double exact = modulus * std::numbers::pi * ratio * ratio / 4;
    CHECK(reading.youngs_modulus() == doctest::Approx(exact).epsilon(1e-10));
    CHECK(reading.nominal_youngs_modulus() ==
          doctest::Approx(exact * 5 / 4).epsilon(1e-10)); // gauge length 4 d of 5 d
    CHECK(std::abs(reading.poissons_ratio()) < 1e-10);
    const auto interior = gauge.interior(motion.displacement);
    CHECK(interior.youngs_modulus(reading.stress) == doctest::Approx(exact).epsilon(1e-10));
    CHECK(std::abs(interior.poissons_ratio()) < 1e-10);
    CHECK(reading.force_fixed == doctest::Approx(reading.force_loaded).epsilon(1e-10));
  }
}

TEST_CASE(
    "the static tension test measures what the gauge reads off a solution of its own, whatever the strain") {
  struct Direct {
    void solve(const integrate::Problem<bond::LinearForces>& problem, particles::Motion& motion,
               core::ThreadPool& pool, const core::Monitor&) const {
      motion = solve_directly(problem, pool);
    }
  };
  const auto body = bodies::shaken_cube(5, 1e-3, 6.2, 11);
  Test test(body, Axis::y, 1e-6, body.gap());
  const particles::Motion motion = solve_directly(test.problem(), test.pool);
  const homogenize::TensionGauge gauge(body.particles, body.network, test.setup);
  const auto expected =
      gauge.faces(motion.displacement, integrate::static_reactions(test.problem(), motion, test.pool));
  const auto within = gauge.interior(motion.displacement);
  for (const double strain : {1e-3, -2e-5}) {
    const auto reading = homogenize::StaticTension{.axis = Axis::y, .strain = strain}.measure(
        Direct{}, test.forces, body, test.pool);
    CHECK(reading.faces.youngs_modulus() == doctest::Approx(expected.youngs_modulus()).epsilon(1e-9));
    CHECK(reading.faces.poissons_ratio() == doctest::Approx(expected.poissons_ratio()).epsilon(1e-9));
    CHECK(reading.interior_youngs_modulus() ==
          doctest::Approx(within.youngs_modulus(expected.stress)).epsilon(1e-9));
    CHECK(reading.faces.nominal_strain == doctest::Approx(strain).epsilon(1e-12));
    // Clapeyron: the work is half of force times way
    CHECK(reading.work ==
          doctest::Approx(0.5 * reading.faces.force_loaded * strain * body.box.size().y()).epsilon(1e-9));
  }
  CHECK_THROWS_AS(homogenize::StaticTension{.strain = 0}.measure(Direct{}, test.forces, body, test.pool),
                  core::InvalidInput);
}

TEST_CASE(
    "a disordered cube lies under its affine bound, in balance, its stresses adding up to the reactions") {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    const auto specimen = bodies::shaken_cube(7, 1e-3, 6.2, 3);
    const double tolerance = specimen.gap();
    Test test(specimen, axis, 1e-6, tolerance);
    const auto problem = test.problem();
    const particles::Motion motion = solve_directly(problem, test.pool);
    const auto reaction = integrate::static_reactions(problem, motion, test.pool);
    const homogenize::TensionGauge gauge(test.specimen.particles, test.specimen.network, test.setup);
    const auto reading = gauge.faces(motion.displacement, reaction);

    // the true energy is the least of all admissible fields: any even strain lies above (Voigt), and the work done
    const double energy = test.forces.elastic_energy(motion.displacement, test.pool);
    const double even = reading.axial_strain;
    double bound = energy_of_even_strain(test, even, 0);
    for (const double poissons_ratio : {0.1, 0.2, 0.25, 0.3, 0.4})
      bound = std::min(bound, energy_of_even_strain(test, even, poissons_ratio * even));
    CHECK(energy < bound);
    CHECK(energy > 0.2 * bound); // and is not far off: the bound is meant to bite
    CHECK(energy == doctest::Approx(0.5 * reading.force_loaded * 1e-6).epsilon(1e-9)); // Clapeyron

    CHECK(reading.force_fixed == doctest::Approx(reading.force_loaded).epsilon(1e-9));
    CHECK(reading.poissons_ratio() > 0);
    CHECK(reading.poissons_ratio() < 0.5);

    std::vector<Vec3> forces;
    test.forces.bond_forces(motion.displacement, forces, test.pool);
    const stress::LoveWeber<> love_weber(stress::tessellation::Hexahedra(test.specimen.box, {3, 2, 4}));
    const Mat3 moment =
        stress::moment_of_stress(love_weber.estimate(test.specimen.particles, test.specimen.network, forces));
    std::vector<Vec3> external(test.specimen.particles.size(), Vec3::Zero());
    for (std::size_t k = 0; k < reaction.size(); ++k) {
      const auto& c = test.setup.constraints.list()[k];
      external[c.particle][c.dof] += reaction[k];
    }
    const Mat3 expected = stress::moment_of_forces(test.specimen.particles.position, external);
    CHECK((moment - expected).norm() < 1e-9 * expected.norm());
    // F/S differs from the mean stress by the gauge length over the side: centres lie inside the faces
    const int k = core::index_of(axis);
    const double mean = moment(k, k) / test.specimen.box.volume();
    CHECK(mean < reading.stress);
    CHECK(mean ==
          doctest::Approx(reading.stress * test.setup.faces.gauge_length(axis) / test.specimen.box.size()[k])
              .epsilon(0.05));
  }
}

TEST_CASE("velocity Verlet under the paper's loading finds the moduli of the direct solution") {
  Test test(bodies::shaken_cube(7, 1e-3, 6.2, 5), Axis::x, 1e-5, 0);
  test.setup = boundary::SymmetricTension{Axis::x, 1e-5, test.specimen.gap()}.apply(
      test.specimen.particles, test.specimen.network, test.specimen.box);
  const auto problem = test.problem();
  const particles::Motion direct = solve_directly(problem, test.pool);
  const homogenize::TensionGauge gauge(test.specimen.particles, test.specimen.network, test.setup);
  const auto expected =
      gauge.faces(direct.displacement, integrate::static_reactions(problem, direct, test.pool));

  constexpr double dt = 2e-5;
  integrate::scale_density(test.forces, test.inertia, dt, 0.5, integrate::DensityScaling::per_particle,
                           test.pool);
  const double omega =
      integrate::first_axial_frequency(problem, test.specimen.particles, 0, 7e-3, Axis::x, test.pool);
  const integrate::VelocityVerlet verlet(
      {.time_step = dt, .damping = integrate::Damping::of_mode(0.02, omega)});
  homogenize::TensionRecorder<bond::LinearForces> recorder(test.specimen.particles, test.specimen.network,
                                                           test.setup, problem, test.pool, {});
  particles::Motion motion = particles::Motion::at_rest(test.specimen.particles.size());
  const auto report = verlet.run(problem, motion, 40000, test.pool, std::ref(recorder));
  CHECK(report.ending == integrate::Ending::observer);
  CHECK(recorder.converged());
  const auto moduli = recorder.moduli();
  // the average over all steps carries the first ones, in which the wave has not arrived: it approaches from below
  CHECK(moduli.youngs_modulus == doctest::Approx(expected.youngs_modulus()).epsilon(5e-3));
  CHECK(moduli.poissons_ratio == doctest::Approx(expected.poissons_ratio()).epsilon(1e-2));
  // what is averaged once the motion is steady is closer
  const double strain = recorder.strain(motion);
  CHECK(recorder.force_fixed(strain) ==
        doctest::Approx(expected.force_fixed * strain / expected.axial_strain).epsilon(1e-3));
  CHECK(recorder.force_loaded(strain) == doctest::Approx(recorder.force_fixed(strain)).epsilon(1e-3));

  const auto energy = integrate::energy_ledger(problem, motion, test.pool);
  CHECK(std::abs(energy.imbalance()) < 1e-4 * energy.external_work);

  const stress::LoveWeber<> love_weber(stress::tessellation::Hexahedra(test.specimen.box, {3, 3, 3}));
  const auto field =
      love_weber.estimate(test.specimen.particles, test.specimen.network, recorder.bond_forces(strain));
  CHECK(stress::moment_of_stress(field)(0, 0) ==
        doctest::Approx(recorder.moment_of_reactions(strain)).epsilon(1e-3));
}

TEST_CASE("density scaling gives the step asked for and leaves statics alone") {
  Test test(bodies::shaken_cube(6, 1e-3, 6.2, 7), Axis::z, 1e-5, 3e-4);
  for (const auto scaling : {integrate::DensityScaling::uniform, integrate::DensityScaling::per_particle}) {
    particles::Inertia inertia = test.inertia;
    const auto report = integrate::scale_density(test.forces, inertia, 3e-5, 0.5, scaling, test.pool);
    CHECK(0.5 * integrate::critical_time_step(test.forces, inertia).time_step ==
          doctest::Approx(3e-5).epsilon(1e-12));
    CHECK(report.smallest_factor <=
          report.mass_factor * (1 + 1e-12)); // a mean, but for the rounding of the sums
    CHECK(report.mass_factor <= report.largest_factor * (1 + 1e-12));
    if (scaling == integrate::DensityScaling::uniform)
      CHECK(report.smallest_factor == doctest::Approx(report.largest_factor).epsilon(1e-12));
    // the true limit is never below the guaranteed one
    const integrate::Problem<bond::LinearForces> problem{test.forces, inertia, test.setup.constraints};
    CHECK(2 / integrate::largest_frequency(problem, test.pool, 1e-8) >= 3e-5 / 0.5 * (1 - 1e-6));
  }
  particles::Inertia inertia = test.inertia;
  CHECK_THROWS_WITH_AS(integrate::scale_density(test.forces, inertia, 0, 0.5, {}, test.pool),
                       doctest::Contains("wanted time step = 0"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(integrate::scale_density(test.forces, inertia, 1e-5, 1, {}, test.pool),
                       doctest::Contains("D_t"), core::InvalidInput);
  network::BondNetwork unbonded;
  unbonded.particle_count = test.specimen.particles.size();
  const bond::LinearForces nothing(alumina(), test.specimen.particles, unbonded);
  CHECK_THROWS_WITH_AS(integrate::scale_density(nothing, inertia, 1e-5, 0.5, {}, test.pool),
                       doctest::Contains("at least one bond"), core::InvalidInput);
}

TEST_CASE(
    "a particle that hangs on nothing changes neither the others' masses nor the frequency of the body") {
  const auto vibration = [](simulation::Specimen specimen) {
    Test test(std::move(specimen), Axis::x, 1e-5, 3e-4);
    const double mass = test.inertia.mass.back();
    const auto report = integrate::scale_density(test.forces, test.inertia, 2e-5, 0.5,
                                                 integrate::DensityScaling::per_particle, test.pool);
    const double omega = integrate::first_axial_frequency(test.problem(), test.specimen.particles, 0, 6e-3,
                                                          Axis::x, test.pool);
    return std::tuple{report, omega, test.inertia.mass.back() / mass};
  };
  const simulation::Specimen specimen = bodies::shaken_cube(6, 1e-3, 6.2, 7);
  auto with_another = specimen;
  with_another.particles.resize(specimen.particles.size() + 1);
  with_another.particles.position.back() = {3e-3, 3e-3,
                                            3e-3}; // amidst the others, where the shape moves most
  with_another.particles.radius.back() = 1e-3;
  with_another.network.particle_count += 1;
  const auto [expected, omega, unused] = vibration(specimen);
  const auto [report, same_omega, factor] = vibration(with_another);
  CHECK(same_omega == doctest::Approx(omega).epsilon(1e-12));
  CHECK(report.mass_factor == doctest::Approx(expected.mass_factor).epsilon(1e-12));
  CHECK(factor == doctest::Approx(report.mass_factor).epsilon(1e-12));
}

TEST_CASE("Rayleigh's quotient of a row's own sine is its exact frequency") {
  // a row of n equal springs held at both ends: omega_1 = 2 sqrt(k/m) sin(pi/2n)
  constexpr std::size_t n = 12;
  particles::ParticleSet row;
  network::BondNetwork bonds;
  row.resize(n + 1);
  for (std::size_t i = 0; i <= n; ++i) {
    row.position[i] = {static_cast<double>(i), 0, 0};
    row.radius[i] = 0.5;
    if (i < n) {
      bonds.first.push_back(static_cast<ParticleIndex>(i));
      bonds.second.push_back(static_cast<ParticleIndex>(i + 1));
      bonds.branch.push_back(Vec3::UnitX());
    }
  }
  bonds.particle_count = n + 1;
  const bond::LinearForces forces(alumina(), row, bonds);
  const auto inertia = particles::solid_spheres(row, std::vector{3900.0});
  const particles::Constraints none;
  const integrate::Problem<bond::LinearForces> problem{forces, inertia, none};
  core::ThreadPool pool;
  const double exact =
      2 * std::sqrt(forces.stiffness(0).normal / inertia.mass[0]) * std::sin(std::numbers::pi / (2 * n));
  CHECK(integrate::first_axial_frequency(problem, row, 0, n, Axis::x, pool) ==
        doctest::Approx(exact).epsilon(1e-12));
  CHECK_THROWS_AS(integrate::frequency_of_shape(problem, particles::SpatialField<>(n + 1), pool),
                  core::InvalidInput);
  CHECK_THROWS_AS(integrate::frequency_of_shape(problem, particles::SpatialField<>(3), pool),
                  core::InvalidInput);
}
