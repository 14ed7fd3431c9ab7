#include <cdem/integrate/velocity_verlet.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <numbers>

#include "sample.hpp"

namespace {

using namespace sample;
using core::InvalidInput;
using core::NotReached;
using integrate::Damping;
using integrate::Ending;
using integrate::Step;
using integrate::VelocityVerlet;
using particles::Motion;

/// Runs `motion` of `body` on one thread.
VelocityVerlet::Report run(const Body& body, Motion& motion, double time_step, std::uint64_t steps,
                           Damping damping = {}) {
  core::ThreadPool pool;
  return VelocityVerlet({.time_step = time_step, .damping = damping})
      .run(body.problem(), motion, steps, pool);
}

/// Two equal spheres joined by a beam along x; the first may be held.
Body pair(bool held) {
  Body body(row(2, 1e-3, 0.5e-3), beam());
  if (held)
    for (std::uint8_t dof = 0; dof < 6; ++dof)
      body.constraints.add({0, dof, 0});
  return body;
}

/// Displacement of x'' + 2 ratio omega x' + omega^2 x = 0 from x = 1 at rest.
double damped_oscillation(double omega, double ratio, double time) {
  const double damped = omega * std::sqrt(1 - ratio * ratio);
  return std::exp(-ratio * omega * time) *
         (std::cos(damped * time) + ratio * omega / damped * std::sin(damped * time));
}

} // namespace

TEST_CASE("an oscillator follows the leapfrog's exact discrete solution") {
  // u(n+1) - 2 u(n) + u(n-1) = -h^2 u(n) and a start at rest give u(n) = u(0) cos(n phi), sin(phi/2) = h/2
  struct Case {
    std::string what;
    bool held;
    int dof;
  };
  for (const Case& oscillator : {Case{"stretch, one end held", true, 0}, Case{"stretch, free", false, 0},
                                 Case{"twist, one end held", true, 3}, Case{"twist, free", false, 3}}) {
    CAPTURE(oscillator.what);
    const bool held = oscillator.held;
    const int dof = oscillator.dof;
    const Body body = pair(held);
    const auto& k = body.forces.stiffness(0);
    const double stiffness = dof == 0 ? k.normal : k.torsion;
    const double inertia = dof == 0 ? body.inertia.mass[1] : body.inertia.moment[1];
    const double omega = std::sqrt((held ? 1 : 2) * stiffness / inertia);
    for (const double h : {0.01, 0.5, 1.9}) {
      Motion motion = Motion::at_rest(2);
      motion.displacement[1][dof] = 1;
      if (!held)
        motion.displacement[0][dof] = -1;
      const double phi = 2 * std::asin(h / 2);
      double worst = 0;
      core::ThreadPool pool;
      VelocityVerlet({.time_step = h / omega}).run(body.problem(), motion, 1000, pool, [&](const Step& step) {
        const double exact = std::cos(static_cast<double>(step.motion.step) * phi);
        worst = std::max(worst, std::abs(step.motion.displacement[1][dof] - exact));
        if (!held)
          worst = std::max(worst, std::abs(step.motion.displacement[0][dof] + exact));
        return true;
      });
      CHECK(worst < 1e-11);
      for (int other = 0; other < 6; ++other)
        if (other != dof)
          CHECK(motion.displacement[1][other] == 0);
    }
  }
}

TEST_CASE("a damped oscillator meets the exact solution, at second order in the step") {
  const Body body = pair(true);
  const double omega = std::sqrt(body.forces.stiffness(0).normal / body.inertia.mass[1]);
  struct Case {
    std::string what;
    Damping damping;
  };
  for (const Case& damped :
       {Case{"none", {}}, Case{"alpha", Damping::of_mode(0.1, omega)}, Case{"beta", {0, 0.2 / omega}},
        Case{"strong beta", {0, 1.0 / omega}}, Case{"both", Damping::between(0.2, 0.5 * omega, 3 * omega)}}) {
    CAPTURE(damped.what);
    const Damping damping = damped.damping;
    const double ratio = damping.ratio_at(omega);
    const double time = 8 / omega;
    double error[4]; // the largest on the way
    int steps = 200;
    for (double& largest : error) {
      Motion motion = Motion::at_rest(2);
      motion.displacement[1][0] = 1;
      largest = 0;
      core::ThreadPool pool;
      VelocityVerlet({.time_step = time / steps, .damping = damping})
          .run(body.problem(), motion, static_cast<std::uint64_t>(steps), pool, [&](const Step& step) {
            const double exact = damped_oscillation(omega, ratio, step.motion.time);
            largest = std::max(largest, std::abs(step.motion.displacement[1][0] - exact));
            return true;
          });
      steps *= 2;
    }
    CHECK(error[3] < 1e-5);
    for (int level = 1; level < 4; ++level) {
      const double order = std::log2(error[level - 1] / error[level]);
      CHECK(order > 1.9);
      CHECK(order < 2.1);
    }
  }
}

TEST_CASE("without bonds, flight and constant load are exact") {
  Network net = row(2, 1, 0.25);
  net.bonds.first.clear();
  net.bonds.second.clear();
  net.bonds.branch.clear();
  Body body(std::move(net), beam());
  body.inertia = {{2, 4}, {0.5, 8}}; // binary fractions throughout: nothing is rounded
  Motion motion = Motion::at_rest(2);
  motion.velocity[0].linear() = Vec3(1, -2, 3);
  motion.velocity[0].angular() = Vec3(0.5, 0, -4);
  SUBCASE("flight") {
    run(body, motion, 0.125, 80);
    CHECK(motion.time == 10);
    CHECK(motion.step == 80);
    CHECK(motion.displacement[0].linear() == Vec3(10, -20, 30));
    CHECK(motion.displacement[0].angular() == Vec3(5, 0, -40));
    CHECK(motion.velocity[0].linear() == Vec3(1, -2, 3));
    CHECK(motion.displacement[1].linear() == Vec3::Zero());
  }
  SUBCASE("constant load") {
    body.load.resize(2);
    body.load[0].linear() = Vec3(4, 0, 0);
    body.load[1].angular() = Vec3(0, 16, 0);
    run(body, motion, 0.125, 80);
    CHECK(motion.displacement[0].linear() == Vec3(10 + 0.5 * 2 * 100, -20, 30)); // v t + F/m t^2/2
    CHECK(motion.velocity[0].linear() == Vec3(1 + 2 * 10, -2, 3));
    CHECK(motion.displacement[1].angular() == Vec3(0, 0.5 * 2 * 100, 0));
    CHECK(motion.velocity[1].angular() == Vec3(0, 2 * 10, 0));
  }
  SUBCASE("mass damping: (1 - alpha dt/2)/(1 + alpha dt/2) a step") {
    run(body, motion, 0.125, 80, {.alpha = 0.5});
    CHECK(motion.velocity[0].linear().z() ==
          doctest::Approx(3 * std::pow((1 - 0.03125) / (1 + 0.03125), 80)).epsilon(1e-13));
    CHECK(motion.velocity[0].linear().z() == doctest::Approx(3 * std::exp(-5.0)).epsilon(2e-3));
  }
}

TEST_CASE("undamped, E_kin + E_el - dt^2/8 F.M^-1 F is conserved to 1e-10 over 10,000 steps") {
  for (const bool held : {false, true}) {
    CAPTURE(held);
    const Body body = lattice_body(6, 1, held);
    const double dt = 0.5 * stability_limit(body, 1e-6);
    Motion motion = shaken(body, 2);
    run(body, motion, dt, 0);
    const auto shadow = [&] { return energy(body, motion) - dt * dt / 8 * force_norm(body, motion); };
    const double start = shadow();
    REQUIRE(start > 0);
    double worst = 0, lowest = energy(body, motion), highest = lowest;
    for (int part = 0; part < 1000; ++part) {
      run(body, motion, dt, 10);
      worst = std::max(worst, std::abs(shadow() / start - 1));
      lowest = std::min(lowest, energy(body, motion));
      highest = std::max(highest, energy(body, motion));
    }
    MESSAGE("relative change of the conserved energy: " << worst);
    CHECK(motion.step == 10000);
    CHECK(worst < 1e-10);
    CHECK(highest - lowest > 1e-3 * start); // the plain energy does oscillate: the term is needed
  }
}

TEST_CASE("undamped, the plain energy does not drift, and its oscillation falls as dt^2") {
  const Body body = lattice_body(6, 3, true);
  const double limit = stability_limit(body, 1e-6);
  double deviation[3];
  for (int level = 0; level < 3; ++level) {
    const double dt = 0.4 * limit / (1 << level);
    const std::uint64_t steps = 2500u << level;
    Motion motion = shaken(body, 4);
    std::vector<double> plain;
    core::ThreadPool pool;
    VelocityVerlet({.time_step = dt}).run(body.problem(), motion, steps, pool, [&](const Step& step) {
      if (step.motion.step % (1u << level) == 0)
        plain.push_back(energy(body, step.motion));
      return true;
    });
    const Eigen::Map<const Eigen::VectorXd> values(plain.data(), static_cast<Eigen::Index>(plain.size()));
    const double mean = values.mean();
    deviation[level] = std::sqrt((values.array() - mean).square().mean()) / mean;
    // least squares slope, as a change over the whole run, in standard deviations
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(values.size(), -0.5, 0.5);
    const double drift = time.dot(values) / time.squaredNorm() / mean;
    MESSAGE("oscillation " << deviation[level] << ", drift " << drift);
    CHECK(std::abs(drift) < deviation[level]);
  }
  CHECK(std::log2(deviation[0] / deviation[1]) == doctest::Approx(2).epsilon(0.05));
  CHECK(std::log2(deviation[1] / deviation[2]) == doctest::Approx(2).epsilon(0.05));
}

TEST_CASE("just under the stability limit a run stays bounded, 5 % over it it blows up and says so") {
  const Body body = lattice_body(6, 5, true);
  const double limit = stability_limit(body);
  SUBCASE("under") {
    const double h = 2 * 0.999;
    Motion motion = shaken(body, 6);
    run(body, motion, 0.999 * limit, 0);
    const double conserved = energy(body, motion) - std::pow(0.999 * limit, 2) / 8 * force_norm(body, motion);
    // each mode keeps kinetic + (1 - (omega dt)^2/4) elastic, so that the sum cannot exceed
    const double bound = conserved / (1 - h * h / 4);
    double highest = 0;
    core::ThreadPool pool;
    VelocityVerlet({.time_step = 0.999 * limit})
        .run(body.problem(), motion, 10000, pool, [&](const Step& step) {
          highest = std::max(highest, energy(body, step.motion));
          return true;
        });
    CHECK(highest <= bound);
    CHECK(highest > conserved);
  }
  SUBCASE("over") {
    Motion motion = shaken(body, 6);
    const std::string message = message_of<NotReached>([&] { run(body, motion, 1.05 * limit, 10000); });
    CHECK(motion.step < 10000);
    CHECK(contains(message, "velocity Verlet blew up at step " + std::to_string(motion.step) + " "));
    CHECK(contains(message, "time_step = " + core::to_text(1.05 * limit) + " s is above the step"));
    CHECK(contains(message, "take a smaller step, or scale the density"));
  }
  SUBCASE("over by far, from a body at rest that is pulled") {
    Body pulled = lattice_body(4, 5, true);
    pulled.constraints.add({63, 0, 1e-3});
    for (const double factor : {1.5, 1e3, 1e150, 1e300}) {
      CAPTURE(factor);
      Motion motion = Motion::at_rest(pulled.size());
      CHECK(contains(message_of<NotReached>([&] { run(pulled, motion, factor * limit, 10000); }),
                     "velocity Verlet blew up at step"));
    }
  }
}

TEST_CASE("with stiffness damping the limit is step_factor times the undamped one") {
  const Body body = lattice_body(4, 7, true);
  const double limit = stability_limit(body), omega = 2 / limit;
  for (const double ratio : {0.01, 0.1, 1.0}) {
    for (const double alpha : {0.0, 0.5 * omega}) {
      CAPTURE(ratio);
      CAPTURE(alpha);
      const Damping damping{alpha, 2 * ratio / omega};
      const double stable = limit * damping.step_factor(omega);
      Motion motion = shaken(body, 8);
      const double start = energy(body, motion);
      run(body, motion, 0.999 * stable, 5000, damping);
      CHECK(energy(body, motion) < start);
      motion = shaken(body, 8);
      CHECK(contains(message_of<NotReached>([&] { run(body, motion, 1.1 * stable, 5000, damping); }),
                     "is above the step that is surely stable"));
    }
  }
}

namespace {

/// Forces that push apart, the more the farther: stable at no time step.
struct Repulsion {
  double stiffness = 1;
  std::size_t particle_count() const { return 2; }
  void evaluate(const Field& displacement, Field& force, core::ThreadPool&) const {
    for (std::size_t i = 0; i < 2; ++i)
      for (int dof = 0; dof < 6; ++dof)
        force[i][dof] = stiffness * displacement[i][dof];
  }
  double elastic_energy(const Field&, core::ThreadPool&) const { return 0; }
  Eigen::Matrix<double, 6, 6> diagonal_block(ParticleIndex) const {
    return Eigen::Matrix<double, 6, 6>::Identity();
  }
};

} // namespace

TEST_CASE("forces that grow or turn into NaN end the run, with the step and another cause") {
  const particles::Inertia inertia{{1, 1}, {1, 1}};
  const particles::Constraints none;
  core::ThreadPool pool;
  const VelocityVerlet verlet({.time_step = 0.1});
  Motion motion = Motion::at_rest(2);
  motion.displacement[1][2] = 1e-3;
  SUBCASE("growing") {
    const Repulsion forces;
    const std::string message = message_of<NotReached>([&] {
      verlet.run(integrate::Problem{forces, inertia, none}, motion, 10000, pool);
    });
    CHECK(contains(message, "at step " + std::to_string(motion.step) + " "));
    CHECK(contains(message, "s is below the step that is stable for a linear body"));
  }
  SUBCASE("not a number") {
    const Repulsion forces{std::numeric_limits<double>::quiet_NaN()};
    const std::string message = message_of<NotReached>([&] {
      verlet.run(integrate::Problem{forces, inertia, none}, motion, 10000, pool);
    });
    CHECK(contains(message, "blew up at step 1 (t = 0.1 s): the kinetic energy is nan J"));
  }
  SUBCASE("not a number on a prescribed degree of freedom") {
    const Repulsion forces{std::numeric_limits<double>::quiet_NaN()};
    particles::Constraints all;
    for (ParticleIndex i = 0; i < 2; ++i)
      for (std::uint8_t dof = 0; dof < 6; ++dof)
        all.add({i, dof, 1});
    CHECK(contains(message_of<NotReached>([&] {
                     verlet.run(integrate::Problem{forces, inertia, all}, motion, 10000, pool);
                   }),
                   "blew up at step 1 "));
  }
}

TEST_CASE("a chain pulled at a constant rate: both ends' reactions are the exact ones") {
  // u = rate t x/L satisfies the equations of motion with stiffness damping, from the first step on
  const std::size_t count = 11;
  Body body(row(count, 1e-3, 0.4e-3), beam(0.5, 5));
  const double rate = 1e-3;
  for (std::uint8_t dof = 0; dof < 6; ++dof)
    body.constraints.add({0, dof, 0});
  body.constraints.add({count - 1, 0, rate});
  const double chain_stiffness = body.forces.stiffness(0).normal / (count - 1);
  Motion motion = Motion::at_rest(count);
  for (std::size_t i = 0; i < count; ++i)
    motion.velocity[i][0] = rate * static_cast<double>(i) / (count - 1);
  const double dt = 0.4 * stability_limit(body, 1e-6), beta = 0.2 * dt;
  const double scale = chain_stiffness * rate * 500 * dt;
  double worst = 0;
  core::ThreadPool pool;
  VelocityVerlet({.time_step = dt, .damping = {0, beta}})
      .run(body.problem(), motion, 500, pool, [&](const Step& step) {
        const double exact = chain_stiffness * rate * (step.motion.time + beta);
        worst = std::max({worst, std::abs(step.reaction[6] - exact), std::abs(step.reaction[0] + exact)});
        for (std::size_t k = 1; k < 6; ++k)
          worst = std::max(worst, std::abs(step.reaction[k]));
        return true;
      });
  CHECK(worst < 1e-11 * scale);
  const auto at_rest = integrate::static_reactions(body.problem(), motion, pool);
  CHECK(at_rest[6] == doctest::Approx(chain_stiffness * rate * motion.time).epsilon(1e-11));
  CHECK(at_rest[0] == doctest::Approx(-chain_stiffness * rate * motion.time).epsilon(1e-11));
}

TEST_CASE("reactions of a body moved rigidly are what its inertia and its mass damping ask for") {
  // everything prescribed at one rate: nothing deforms, the drag alpha m v is all there is to overcome
  Body body = lattice_body(3, 9);
  for (std::size_t i = 0; i < body.size(); ++i)
    body.constraints.add({static_cast<ParticleIndex>(i), 1, 0.5});
  Motion motion = Motion::at_rest(body.size());
  core::ThreadPool pool;
  const double alpha = 30, dt = 0.3 * stability_limit(body, 1e-6);
  double worst = 0;
  VelocityVerlet({.time_step = dt, .damping = {alpha, 0.1 * dt}})
      .run(body.problem(), motion, 200, pool, [&](const Step& step) {
        for (std::size_t k = 0; k < step.reaction.size(); ++k)
          worst = std::max(worst, std::abs(step.reaction[k] / (alpha * body.inertia.mass[k] * 0.5) - 1));
        return true;
      });
  CHECK(worst < 1e-13); // equal displacements leave no rounding in the bonds
  CHECK(motion.displacement[5][1] == 0.5 * motion.time);
}

TEST_CASE("damped to rest under a load: displacement and reactions solve K u = F, at any density") {
  Body body = lattice_body(3, 10, true);
  body.load.resize(body.size());
  core::Random random(11);
  for (auto& load : body.load) {
    load.linear() = random_vector(random, 1);
    load.angular() = random_vector(random, 1e-3);
  }
  // the exact solution by a direct method, from the stiffness taken column by column
  const auto dofs = 6 * static_cast<Eigen::Index>(body.size());
  core::ThreadPool pool;
  Eigen::MatrixXd stiffness(dofs, dofs);
  Eigen::VectorXd load(dofs);
  const auto entry = [](auto& field, Eigen::Index d) -> decltype(auto) {
    return field[static_cast<std::size_t>(d / 6)][static_cast<int>(d % 6)];
  };
  Field probe(body.size()), force(body.size());
  for (Eigen::Index column = 0; column < dofs; ++column) {
    entry(probe, column) = 1;
    body.forces.evaluate(probe, force, pool);
    entry(probe, column) = 0;
    for (Eigen::Index d = 0; d < dofs; ++d)
      stiffness(d, column) = -entry(force, d);
    load[column] = entry(body.load, column);
  }
  Eigen::MatrixXd held = stiffness;
  Eigen::VectorXd right = load;
  for (const auto& constraint : body.constraints.list()) {
    const Eigen::Index d = 6 * static_cast<Eigen::Index>(constraint.particle) + constraint.dof;
    held.row(d).setZero();
    held.col(d).setZero();
    held(d, d) = stiffness(d, d);
    right[d] = 0;
  }
  const Eigen::VectorXd exact = held.llt().solve(right);
  const Eigen::VectorXd exact_reaction = stiffness * exact - load;

  double time_step[2];
  int run_number = 0;
  for (const double density_factor : {1.0, 1e4}) {
    CAPTURE(density_factor);
    Body scaled = body;
    scaled.inertia.scale(density_factor);
    const auto critical = integrate::critical_time_step(scaled.forces, scaled.inertia);
    const double dt = 0.5 * critical.time_step;
    time_step[run_number++] = dt;
    Motion motion = Motion::at_rest(body.size());
    std::vector<double> reaction;
    VelocityVerlet({.time_step = dt, .damping = Damping::of_mode(1, 0.03 * critical.angular_frequency)})
        .run(scaled.problem(), motion, 6000, pool, [&](const Step& step) {
          reaction.assign(step.reaction.begin(), step.reaction.end());
          return true;
        });
    for (Eigen::Index i = 0; i < dofs / 6; ++i) {
      CHECK((motion.displacement[static_cast<std::size_t>(i)].linear() - exact.segment<3>(6 * i)).norm() <
            1e-9 * exact.lpNorm<Eigen::Infinity>());
      CHECK(
          (motion.displacement[static_cast<std::size_t>(i)].angular() - exact.segment<3>(6 * i + 3)).norm() <
          1e-9 * exact.lpNorm<Eigen::Infinity>());
    }
    for (std::size_t k = 0; k < reaction.size(); ++k) {
      const auto& c = body.constraints.list()[k];
      CHECK(reaction[k] == doctest::Approx(exact_reaction[6 * static_cast<Eigen::Index>(c.particle) + c.dof])
                               .scale(1)
                               .epsilon(1e-8));
    }
  }
  CHECK(time_step[1] == doctest::Approx(100 * time_step[0]).epsilon(1e-12));
}

TEST_CASE("a free body keeps its linear and angular momentum") {
  // small motion: the moment is taken about the rest positions, sum of x0 x m v + I w
  const Body body = lattice_body(6, 12);
  Motion motion = shaken(body, 13);
  const auto momentum = [&] {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < body.size(); ++i) {
      const Vec3 linear = body.inertia.mass[i] * motion.velocity[i].linear();
      sum.head<3>() += linear;
      sum.tail<3>() += body.net.particles.position[i].cross(linear) +
                       body.inertia.moment[i] * motion.velocity[i].angular();
    }
    return sum;
  };
  const Eigen::Matrix<double, 6, 1> start = momentum();
  double mass = 0, arm = 0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    mass += body.inertia.mass[i] * motion.velocity[i].linear().norm();
    arm = std::max(arm, body.net.particles.position[i].norm());
  }
  const double dt = 0.7 * stability_limit(body, 1e-6);
  SUBCASE("undamped") {
    run(body, motion, dt, 5000);
  }
  SUBCASE("with stiffness damping, which acts between particles") {
    run(body, motion, 0.5 * dt, 5000, {0, 0.2 * dt});
  }
  const Eigen::Matrix<double, 6, 1> change = momentum() - start;
  CHECK(change.head<3>().norm() < 1e-11 * mass);
  CHECK(change.tail<3>().norm() < 1e-11 * mass * arm);
}

TEST_CASE("a free body damped on its masses loses its momentum at the rate of the damping") {
  const Body body = lattice_body(4, 14);
  Motion motion = shaken(body, 15);
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < body.size(); ++i)
      sum += body.inertia.mass[i] * motion.velocity[i].linear();
    return sum;
  };
  const Vec3 start = momentum();
  const double dt = 0.5 * stability_limit(body, 1e-6), alpha = 0.01 / dt;
  run(body, motion, dt, 200, {alpha, 0});
  const Vec3 expected = start * std::pow((1 - 0.005) / (1 + 0.005), 200);
  CHECK((momentum() - expected).norm() < 1e-11 * start.norm());
}

TEST_CASE("runs resume bit by bit, on any number of threads") {
  // more particles than a block of the parallel loop or of the bonds, so that threads do share the work
  Body body = lattice_body(15, 16, true);
  REQUIRE(body.size() > std::max(core::block_size, bond::detail::BlockedBonds<double>::block_size));
  body.constraints.add({static_cast<ParticleIndex>(body.size() - 1), 0, 0.3});
  body.load.resize(body.size());
  body.load[1000].linear() = Vec3(1, 2, 3);
  const auto critical = integrate::critical_time_step(body.forces, body.inertia);
  const VelocityVerlet verlet(
      {.time_step = 0.4 * critical.time_step,
       .damping = Damping::between(0.05, 0.1 * critical.angular_frequency, critical.angular_frequency)});
  const Motion start = shaken(body, 17);
  Motion whole = start;
  core::ThreadPool one;
  verlet.run(body.problem(), whole, 100, one);
  SUBCASE("in two runs") {
    Motion motion = start;
    verlet.run(body.problem(), motion, 37, one);
    verlet.run(body.problem(), motion, 63, one);
    CHECK(same_bytes(motion, whole));
  }
  SUBCASE("threads") {
    for (const int threads : {2, 3, 4}) {
      core::ThreadPool pool(threads);
      Motion motion = start;
      verlet.run(body.problem(), motion, 60, pool);
      verlet.run(body.problem(), motion, 40, one);
      CHECK(same_bytes(motion, whole));
    }
  }
  SUBCASE("ended by the observer") {
    Motion motion = start;
    const auto report =
        verlet.run(body.problem(), motion, 100, one, [](const Step& step) { return step.motion.step < 20; });
    CHECK(report.steps == 20);
    CHECK(report.ending == Ending::observer);
    verlet.run(body.problem(), motion, 80, one);
    CHECK(same_bytes(motion, whole));
  }
  SUBCASE("interrupted") {
    Motion motion = start;
    std::atomic<bool> stop = false;
    const core::Monitor monitor({}, &stop);
    const std::string message = message_of<core::Interrupted>([&] {
      verlet.run(
          body.problem(), motion, 100, one,
          [&](const Step& step) {
            stop = step.motion.step == 37;
            return true;
          },
          monitor);
    });
    CHECK(message == "velocity Verlet interrupted at 37 %: step 37");
    REQUIRE(motion.step == 37);
    verlet.run(body.problem(), motion, 63, one);
    CHECK(same_bytes(motion, whole));
  }
  SUBCASE("observed now and then: the observer sees what it sees when it looks at every step") {
    const auto at_every = [&](std::uint64_t every) {
      auto parameters = verlet.parameters();
      parameters.observe_every = every;
      return VelocityVerlet(parameters);
    };
    std::vector<Motion> seen;
    Motion motion = start;
    at_every(1).run(body.problem(), motion, 100, one, [&](const Step& step) {
      if (step.motion.step % 30 == 0)
        seen.push_back(step.motion);
      return true;
    });
    CHECK(same_bytes(motion, whole));
    for (const int threads : {1, 3}) {
      core::ThreadPool pool(threads);
      motion = start;
      std::size_t looks = 0;
      at_every(30).run(body.problem(), motion, 100, pool, [&](const Step& step) {
        CHECK(same_bytes(step.motion, seen.at(looks++)));
        return true;
      });
      CHECK(looks == 3);
      CHECK(same_bytes(motion, whole));
    }
  }
  SUBCASE("interrupted at a step that nobody sees") {
    Motion motion = start;
    std::atomic<bool> stop = false;
    auto parameters = verlet.parameters();
    parameters.observe_every = 40;
    const std::string message = message_of<core::Interrupted>([&] {
      VelocityVerlet(parameters)
          .run(
              body.problem(), motion, 100, one,
              [&](const Step&) {
                stop = true;
                return true;
              },
              core::Monitor([](const core::Progress&) {}, &stop));
    });
    CHECK(contains(message, "velocity Verlet interrupted at 40 %"));
    verlet.run(body.problem(), motion, 100 - motion.step, one);
    CHECK(same_bytes(motion, whole));
  }
  SUBCASE("an observer that throws") {
    Motion motion = start;
    CHECK_THROWS_AS(verlet.run(body.problem(), motion, 100, one,
                               [](const Step& step) -> bool {
                                 if (step.motion.step == 11)
                                   throw 7;
                                 return true;
                               }),
                    int);
    verlet.run(body.problem(), motion, 89, one);
    CHECK(same_bytes(motion, whole));
  }
}

TEST_CASE("a run tells what it did") {
  const Body body = pair(true);
  Motion motion = Motion::at_rest(2);
  const auto report = run(body, motion, 1e-9, 25);
  CHECK(report.steps == 25);
  CHECK(report.ending == Ending::all_steps);
  CHECK(report.seconds >= 0);
  CHECK(motion.step == 25);
  CHECK(motion.time == doctest::Approx(25e-9).epsilon(1e-12));
  CHECK(run(body, motion, 1e-9, 0).steps == 0);
  CHECK(motion.step == 25);
}

TEST_CASE("a body held everywhere stays where it is") {
  Body body = pair(true);
  for (std::uint8_t dof = 0; dof < 6; ++dof)
    body.constraints.add({1, dof, 0});
  Motion motion = Motion::at_rest(2);
  motion.displacement[1][0] = 1; // the constraints win over it
  motion.velocity[1][4] = 3;
  run(body, motion, 1, 100);
  for (std::size_t i = 0; i < 2; ++i)
    for (int dof = 0; dof < 6; ++dof) {
      CHECK(motion.displacement[i][dof] == 0);
      CHECK(motion.velocity[i][dof] == 0);
    }
}

TEST_CASE("bad parameters are refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const auto message = [](VelocityVerlet::Parameters parameters) {
    return message_of([&] { VelocityVerlet verlet(parameters); });
  };
  for (const double bad : {0.0, -1e-9, nan, infinity})
    CHECK(contains(message({.time_step = bad}),
                   "time_step = " + core::to_text(bad) + " is not accepted: a finite number above 0 s"));
  for (const double bad : {-1.0, nan, infinity}) {
    CHECK(contains(message({1, {bad, 0}}), "alpha of the Rayleigh damping = " + core::to_text(bad)));
    CHECK(contains(message({1, {0, bad}}), "beta of the Rayleigh damping = " + core::to_text(bad)));
  }
  CHECK(message({1, {0, 0}}) == "nothing thrown");
  CHECK(contains(message({1, {0, 0}, 0}), "observe_every = 0 is not accepted: 1 step or more is expected"));
}

TEST_CASE("problems and motions that do not fit are refused, before anything moves") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Body body = pair(false);
  Motion motion = Motion::at_rest(2);
  const auto message = [&] { return message_of([&] { run(body, motion, 1e-9, 1); }); };
  REQUIRE(message() == "nothing thrown");
  motion = Motion::at_rest(2);
  SUBCASE("masses") {
    body.inertia.mass.pop_back();
    CHECK(message() == "number of masses = 1 is not accepted: the number of particles, 2, is expected");
  }
  SUBCASE("moments") {
    body.inertia.moment.push_back(1);
    CHECK(message() ==
          "number of moments of inertia = 3 is not accepted: the number of particles, 2, is expected");
  }
  SUBCASE("mass") {
    for (const double bad : {0.0, -1.0, nan}) {
      body.inertia.mass[1] = bad;
      CHECK(contains(message(), "mass of particle 1 = " + core::to_text(bad) + " is not accepted"));
    }
  }
  SUBCASE("moment") {
    for (const double bad : {0.0, -1.0, nan}) {
      body.inertia.moment[0] = bad;
      CHECK(contains(message(), "moment of inertia of particle 0 = " + core::to_text(bad)));
    }
  }
  SUBCASE("number of loads") {
    body.load.resize(3);
    CHECK(message() ==
          "number of entries of the load = 3 is not accepted: the number of particles, 2, is expected");
  }
  SUBCASE("load") {
    body.load.resize(2);
    body.load[1][4] = nan;
    CHECK(contains(message(), "load of particle 1, degree of freedom 4 = nan"));
  }
  SUBCASE("constraint on a particle that is not there") {
    body.constraints.add({2, 0, 0});
    CHECK(message() == "constrained particle = 2 is not accepted: a number below 2 is expected");
  }
  SUBCASE("number of displacements") {
    motion.displacement.resize(3);
    CHECK(contains(message(), "number of entries of the displacement = 3"));
  }
  SUBCASE("number of velocities") {
    motion.velocity.resize(1);
    CHECK(contains(message(), "number of entries of the velocity = 1"));
  }
  SUBCASE("number of accelerations") {
    motion.acceleration.resize(1);
    CHECK(contains(message(), "number of entries of the acceleration = 1"));
  }
  SUBCASE("displacement") {
    motion.displacement[0][5] = nan;
    CHECK(contains(message(), "displacement of particle 0, degree of freedom 5 = nan"));
  }
  SUBCASE("velocity") {
    motion.velocity[1][0] = std::numeric_limits<double>::infinity();
    CHECK(contains(message(), "velocity of particle 1, degree of freedom 0 = inf"));
  }
  SUBCASE("acceleration") {
    motion.acceleration.resize(2);
    motion.acceleration[1][1] = nan;
    CHECK(contains(message(), "acceleration of particle 1, degree of freedom 1 = nan"));
  }
  CHECK(motion.step == 0);
}

TEST_CASE("a motion does not go on under constraints other than its own") {
  Body body = pair(true);
  body.constraints.add({1, 0, 2});
  Motion motion = Motion::at_rest(2);
  run(body, motion, 0x1p-30, 10);
  Body other = pair(true);
  const auto message = [&] { return message_of([&] { run(other, motion, 0x1p-30, 1); }); };
  SUBCASE("another rate") {
    other.constraints.add({1, 0, 0});
    CHECK(contains(message(),
                   "rate of the constraint on particle 1, degree of freedom 0 = 0 is not accepted: "
                   "a motion goes on under the constraints it began with"));
    CHECK(contains(message(), "moves at 2"));
  }
  SUBCASE("a rate that happens to be the velocity, elsewhere than the motion is") {
    motion.time *= 2;
    other.constraints.add({1, 0, 2});
    CHECK(contains(message(), "goes on under the constraints it began with"));
  }
  SUBCASE("fewer are allowed: the particle flies on") {
    CHECK(message() == "nothing thrown");
  }
}
