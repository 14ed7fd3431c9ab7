#include <cdem/integrate/integrator.hpp>
#include <cdem/integrate/velocity_verlet.hpp>

#include <doctest/doctest.h>

#include "sample.hpp"

namespace {

using namespace sample;
using integrate::Damping;
using integrate::EnergyLedger;
using integrate::Loading;
using integrate::VelocityVerlet;
using particles::Motion;

/// The ledger after `time`, and the largest imbalance on the way.
std::pair<EnergyLedger, double> ledger_after(const Body& body, Motion motion, double time, int steps,
                                             Damping damping, Loading loading = {}) {
  core::ThreadPool pool;
  double worst = 0;
  VelocityVerlet({.time_step = time / steps, .damping = damping, .loading = loading})
      .run(body.problem(), motion, static_cast<std::uint64_t>(steps), pool, [&](const integrate::Step& step) {
        if (step.motion.step % 10 == 0)
          worst = std::max(worst,
                           std::abs(integrate::energy_ledger(body.problem(), step.motion, pool).imbalance()));
        return true;
      });
  return {integrate::energy_ledger(body.problem(), motion, pool), worst};
}

} // namespace

TEST_CASE("the ledger closes, and its imbalance falls as dt^2") {
  Body body = lattice_body(4, 1, true);
  const double limit = stability_limit(body, 1e-6), omega = 2 / limit;
  const double time = 60 * limit;
  Damping damping;
  Loading loading;
  bool is_shaken = false;
  SUBCASE("free vibration") {
    is_shaken = true;
  }
  SUBCASE("mass damping") {
    is_shaken = true;
    damping = {0.05 * omega, 0};
  }
  SUBCASE("stiffness damping") {
    is_shaken = true;
    damping = {0, 0.1 / omega};
  }
  SUBCASE("prescribed motion, imposed at once, and both dampings") {
    damping = Damping::between(0.05, 0.05 * omega, omega);
    for (ParticleIndex i = 60; i < 64; ++i) {
      body.constraints.add({i, 0, 0.5});
      body.constraints.add({i, 4, 100});
    }
  }
  SUBCASE("prescribed motion on a ramp, both dampings, and loads on it too") {
    is_shaken = true;
    damping = Damping::between(0.05, 0.05 * omega, omega);
    body.load.resize(body.size());
    body.load[61].linear() = Vec3(1, -2, 0.5);
    loading = {.ramp = 0.6 * time};
    for (ParticleIndex i = 60; i < 64; ++i) {
      body.constraints.add({i, 0, 0.5});
      body.constraints.add({i, 4, 100});
    }
  }
  SUBCASE("load") {
    body.load.resize(body.size());
    body.load[50].linear() = Vec3(1, -2, 0.5);
    body.load[40].angular() = Vec3(0, 1e-3, 2e-3);
    damping = {0.05 * omega, 0};
  }
  SUBCASE("all at once") {
    is_shaken = true;
    damping = Damping::between(0.05, 0.05 * omega, omega);
    body.constraints.add({63, 1, -0.5});
    body.load.resize(body.size());
    for (auto& load : body.load) // on prescribed degrees of freedom too
      load.linear() = Vec3(0.1, 0.2, -0.1);
  }
  const Motion start = is_shaken ? shaken(body, 2) : Motion::at_rest(body.size());
  double imbalance[3];
  int steps = 300;
  for (double& worst : imbalance) {
    const auto [ledger, largest] = ledger_after(body, start, time, steps, damping, loading);
    worst = largest / (ledger.initial + std::abs(ledger.external_work));
    CHECK(ledger.kinetic > 0);
    CHECK(ledger.elastic > 0);
    CHECK((damping.alpha + damping.beta > 0) == (ledger.dissipated > 0));
    CHECK((is_shaken ? ledger.initial > 0 : ledger.initial == 0));
    steps *= 2;
  }
  MESSAGE("imbalance over the energy given: " << imbalance[0] << " " << imbalance[1] << " " << imbalance[2]);
  CHECK(imbalance[2] < 1e-3);
  for (int level = 1; level < 3; ++level) {
    const double order = std::log2(imbalance[level - 1] / imbalance[level]);
    CHECK(order > 1.8);
    CHECK(order < 2.3);
  }
}

TEST_CASE("what an overdamped body is given is dissipated but for what its springs keep") {
  // a constant load on a body that comes to rest does the work F u, half of it stays in the springs
  Body body = lattice_body(3, 3, true);
  body.load.resize(body.size());
  body.load[25].linear() = Vec3(1, 2, 3);
  const auto critical = integrate::critical_time_step(body.forces, body.inertia);
  const double dt = 0.25 * critical.time_step;
  const auto [ledger, worst] = ledger_after(body, Motion::at_rest(body.size()), 10000 * dt, 10000,
                                            Damping::of_mode(1, 0.03 * critical.angular_frequency));
  CHECK(ledger.kinetic < 1e-12 * ledger.elastic);
  CHECK(ledger.external_work == doctest::Approx(2 * ledger.elastic).epsilon(1e-4));
  CHECK(ledger.dissipated == doctest::Approx(ledger.elastic).epsilon(1e-2));
}

TEST_CASE("kinetic energy counts translation and rotation") {
  const particles::Inertia inertia{{2, 3}, {5, 7}};
  Field velocity(2);
  velocity[0].linear() = Vec3(1, 2, 2);
  velocity[1].angular() = Vec3(0, 3, 4);
  core::ThreadPool pool;
  CHECK(integrate::kinetic_energy(inertia, velocity, pool) == 0.5 * (2 * 9 + 7 * 25));
}

TEST_CASE("imposing a velocity at once is booked as work, and only its difference") {
  Body body = lattice_body(3, 4);
  body.constraints.add({5, 0, 2.0});
  body.constraints.add({5, 3, 0});
  Motion motion = Motion::at_rest(body.size());
  motion.velocity[5].linear() = Vec3(1, 0.5, 0);
  motion.velocity[5].angular() = Vec3(300, 0, 0);
  const double before = energy(body, motion);
  core::ThreadPool pool;
  VelocityVerlet({.time_step = 1e-9}).run(body.problem(), motion, 0, pool);
  const double m = body.inertia.mass[5], moment = body.inertia.moment[5];
  CHECK(motion.energy.initial == before);
  CHECK(motion.energy.external_work ==
        doctest::Approx(0.5 * m * (4 - 1) - 0.5 * moment * 300 * 300).epsilon(1e-13));
  const auto ledger = integrate::energy_ledger(body.problem(), motion, pool);
  CHECK(std::abs(ledger.imbalance()) < 1e-14 * before);
}

TEST_CASE("a prescribed position is imposed before the initial energy is taken") {
  Body body = lattice_body(3, 5, true);
  Motion motion = Motion::at_rest(body.size());
  motion.displacement[0][0] = 1e-4; // held: goes back to 0 at the first step
  core::ThreadPool pool;
  VelocityVerlet({.time_step = 1e-9}).run(body.problem(), motion, 1, pool);
  CHECK(motion.displacement[0][0] == 0);
  CHECK(motion.energy.initial == 0);
  CHECK(integrate::energy_ledger(body.problem(), motion, pool).imbalance() == 0);
}
