#include <cdem/integrate/critical_time_step.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "sample.hpp"

namespace {

using namespace sample;
using core::NotReached;
using integrate::critical_time_step;
using integrate::largest_frequency;

double exact_limit(const Body& body) {
  return stability_limit(body, 1e-12);
}

/// Largest eigenvalue of M^-1 K by a dense symmetric solver.
double dense_frequency(const Body& body) {
  const auto dofs = 6 * static_cast<Eigen::Index>(body.size());
  core::ThreadPool pool;
  Field unit(body.size()), force(body.size());
  Eigen::MatrixXd matrix(dofs, dofs);
  const auto scale = [&](Eigen::Index d) {
    const auto i = static_cast<std::size_t>(d / 6);
    return 1 / std::sqrt(d % 6 < 3 ? body.inertia.mass[i] : body.inertia.moment[i]);
  };
  for (Eigen::Index column = 0; column < dofs; ++column) {
    double& moved = unit[static_cast<std::size_t>(column / 6)][static_cast<int>(column % 6)];
    moved = 1;
    body.forces.evaluate(unit, force, pool);
    moved = 0;
    for (Eigen::Index row = 0; row < dofs; ++row)
      matrix(row, column) =
          -scale(row) * scale(column) * force[static_cast<std::size_t>(row / 6)][static_cast<int>(row % 6)];
  }
  for (const auto& constraint : body.constraints.list()) {
    const Eigen::Index d = 6 * static_cast<Eigen::Index>(constraint.particle) + constraint.dof;
    matrix.row(d).setZero();
    matrix.col(d).setZero();
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
                       .eigenvalues()
                       .maxCoeff());
}

} // namespace

TEST_CASE("two equal particles and a ring of equal springs: the bound is the exact limit") {
  const bond::Spring<> spring({.materials = {{1e9, 0.5}}});
  const Body two(row(2, 1e-3, 0.5e-3), spring);
  const double k = two.forces.stiffness(0).normal, m = two.inertia.mass[0];
  CHECK(critical_time_step(two.forces, two.inertia).time_step ==
        doctest::Approx(2 / std::sqrt(2 * k / m)).epsilon(1e-14));
  CHECK(exact_limit(two) == doctest::Approx(2 / std::sqrt(2 * k / m)).epsilon(1e-12));

  const Body ring(row(12, 1e-3, 0.5e-3, true), spring); // omega_max^2 = 4 k/m, neighbours in turn
  const auto critical = critical_time_step(ring.forces, ring.inertia);
  CHECK(critical.time_step == doctest::Approx(std::sqrt(m / k)).epsilon(1e-14));
  CHECK(critical.angular_frequency == doctest::Approx(2 / critical.time_step).epsilon(1e-15));
  CHECK(exact_limit(ring) == doctest::Approx(std::sqrt(m / k)).epsilon(1e-12));

  // an open row of n: omega_max^2 = 4 k/m sin^2(pi (n - 1)/(2 n))
  const Body open(row(12, 1e-3, 0.5e-3), spring);
  const double omega = 2 * std::sqrt(k / m) * std::sin(std::acos(-1) * 11 / 24);
  CHECK(exact_limit(open) == doctest::Approx(2 / omega).epsilon(1e-9));
  CHECK(critical_time_step(open.forces, open.inertia).time_step <= 2 / omega);
}

TEST_CASE("the bound is guaranteed and never far from the limit") {
  double lowest = 1, highest = 0;
  const auto look = [&](const Body& body) {
    const double ratio = critical_time_step(body.forces, body.inertia).time_step / exact_limit(body);
    CHECK(ratio <= 1 + 1e-12);
    if (body.constraints.empty()) // one particle alone is a trial motion
      CHECK(ratio >= std::sqrt(0.5) * (1 - 1e-6));
    lowest = std::min(lowest, ratio);
    highest = std::max(highest, ratio);
  };
  SUBCASE("beams") {
    for (const double radius_ratio : {0.1, 0.3, 0.545, 0.722, 1.0})
      for (const double contrast : {1.0, 5.0, 100.0})
        for (const std::uint64_t seed : {1u, 2u, 3u})
          look(Body(shaken_lattice(6, seed), beam(radius_ratio, contrast)));
  }
  SUBCASE("springs") {
    for (const double tangential_ratio : {0.0, 0.3, 1.0})
      for (const double contrast : {1.0, 5.0, 100.0})
        for (const std::uint64_t seed : {1u, 2u, 3u})
          look(Body(shaken_lattice(6, seed), bond::Spring<>({.materials = {{1e9, 0.5}, {contrast * 1e9, 0.5}},
                                                             .tangential_ratio = tangential_ratio})));
  }
  SUBCASE("with masses apart by 1e4") {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      Body body(shaken_lattice(6, seed), beam());
      for (std::size_t i = 0; i < body.size(); i += 3) {
        body.inertia.mass[i] *= 1e4;
        body.inertia.moment[i] *= 1e4;
      }
      look(body);
    }
  }
  SUBCASE("with a part held: the bound is that of the free body") {
    const Body free = lattice_body(5, 4), held = lattice_body(5, 4, true);
    look(held);
    CHECK(critical_time_step(held.forces, held.inertia).time_step ==
          critical_time_step(free.forces, free.inertia).time_step);
  }
  MESSAGE("bound over limit: " << lowest << " to " << highest);
}

TEST_CASE("the bound is 2/sqrt(2 lambda) of the block of the particle it names, the largest of all") {
  const Body body = lattice_body(5, 5);
  const auto critical = critical_time_step(body.forces, body.inertia);
  double largest = 0;
  ParticleIndex where = 0;
  for (ParticleIndex i = 0; i < body.size(); ++i) { // an unsymmetric solver, without the shortcut
    Eigen::Matrix<double, 6, 6> block = body.forces.diagonal_block(i);
    block.topRows<3>() /= body.inertia.mass[i];
    block.bottomRows<3>() /= body.inertia.moment[i];
    const double lambda =
        Eigen::EigenSolver<Eigen::Matrix<double, 6, 6>>(block).eigenvalues().real().maxCoeff();
    if (lambda > largest) {
      largest = lambda;
      where = i;
    }
  }
  CHECK(critical.particle == where);
  CHECK(critical.angular_frequency == doctest::Approx(std::sqrt(2 * largest)).epsilon(1e-11));
}

TEST_CASE("density scaling lengthens the step by its square root") {
  Body body = lattice_body(5, 6);
  const double before = critical_time_step(body.forces, body.inertia).time_step;
  const double limit = exact_limit(body);
  body.inertia.scale(250);
  CHECK(critical_time_step(body.forces, body.inertia).time_step ==
        doctest::Approx(std::sqrt(250) * before).epsilon(1e-13));
  CHECK(exact_limit(body) == doctest::Approx(std::sqrt(250) * limit).epsilon(1e-9));
}

TEST_CASE("without bonds any step is stable") {
  Network loose = shaken_lattice(3, 7);
  loose.bonds.first.clear();
  loose.bonds.second.clear();
  loose.bonds.branch.clear();
  const Body body(std::move(loose), beam());
  const auto critical = critical_time_step(body.forces, body.inertia);
  CHECK(critical.time_step == std::numeric_limits<double>::infinity());
  CHECK(critical.angular_frequency == 0);
  core::ThreadPool pool;
  CHECK(largest_frequency(body.problem(), pool) == 0);
}

TEST_CASE("the power iteration finds the largest frequency, from below") {
  core::ThreadPool pool;
  for (const bool held : {false, true}) {
    const Body body = lattice_body(4, 8, held);
    const double exact = dense_frequency(body);
    double previous = 0;
    for (const double tolerance : {1e-2, 1e-4, 1e-8, 1e-13}) {
      const double found = largest_frequency(body.problem(), pool, tolerance, 1000000);
      CHECK(found <= exact * (1 + 1e-12));
      CHECK(found >= previous);
      previous = found;
    }
    CHECK(previous == doctest::Approx(exact).epsilon(1e-10));
  }
  Body all_held = lattice_body(3, 8);
  all_held.hold_left(1);
  CHECK(largest_frequency(all_held.problem(), pool) == 0);
}

namespace {

/// A body whose stiffness is not a number.
struct Broken {
  std::size_t particle_count() const { return 2; }
  void evaluate(const Field&, Field& force, core::ThreadPool&) const {
    force[0][0] = std::numeric_limits<double>::quiet_NaN();
  }
  double elastic_energy(const Field&, core::ThreadPool&) const { return 0; }
  Eigen::Matrix<double, 6, 6> diagonal_block(ParticleIndex) const {
    return Eigen::Matrix<double, 6, 6>::Constant(std::numeric_limits<double>::quiet_NaN());
  }
};

} // namespace

TEST_CASE("bad input is refused, and a search without success says so") {
  Body body = lattice_body(3, 9);
  core::ThreadPool pool;
  const auto critical = [&] { critical_time_step(body.forces, body.inertia); };
  const auto frequency = [&](double tolerance, int iterations) {
    return [&body, &pool, tolerance, iterations] {
      largest_frequency(body.problem(), pool, tolerance, iterations);
    };
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SUBCASE("parameters") {
    for (const double bad : {0.0, -1e-3, nan})
      CHECK(contains(message_of(frequency(bad, 10)),
                     "tolerance of the power iteration = " + core::to_text(bad) + " is not accepted"));
    for (const int bad : {0, -5})
      CHECK(contains(message_of(frequency(1e-3, bad)), "iterations of the power iteration = "));
    CHECK(contains(message_of<NotReached>(frequency(1e-12, 3)), "did not converge to 1e-12 in 3 iterations"));
  }
  SUBCASE("inertia") {
    body.inertia.mass[3] = 0;
    CHECK(contains(message_of(critical), "mass of particle 3 = 0 is not accepted"));
    CHECK(contains(message_of(frequency(1e-3, 10)), "mass of particle 3 = 0 is not accepted"));
    body.inertia.mass.pop_back();
    CHECK(contains(message_of(critical), "number of masses = 26"));
    body.inertia.mass.resize(27, 1);
    body.inertia.mass[3] = 1;
    body.inertia.moment[2] = -1;
    CHECK(contains(message_of(critical), "moment of inertia of particle 2 = -1"));
  }
  SUBCASE("forces that are not finite") {
    const particles::Inertia inertia{{1, 1}, {1, 1}};
    const particles::Constraints none;
    const Broken forces;
    CHECK(contains(message_of<NotReached>([&] { critical_time_step(forces, inertia); }),
                   "stiffness of particle 0 over its mass is not finite"));
    CHECK(contains(message_of<NotReached>([&] {
                     largest_frequency(integrate::Problem{forces, inertia, none}, pool);
                   }),
                   "forces that are not finite"));
  }
}
