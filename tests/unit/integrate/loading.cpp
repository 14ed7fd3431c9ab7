#include <cdem/integrate/loading.hpp>
#include <cdem/integrate/velocity_verlet.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "sample.hpp"

namespace {

using namespace sample;
using integrate::Damping;
using integrate::Loading;
using integrate::Step;
using integrate::VelocityVerlet;
using particles::Motion;

/// Two equal spheres joined by a beam along x, the first held but for its motion along x, which is prescribed.
Body pulled_pair(double rate) {
  Body body(row(2, 1e-3, 0.5e-3), beam());
  body.constraints.add({0, 0, rate});
  for (std::uint8_t dof = 1; dof < 6; ++dof)
    body.constraints.add({0, dof, 0});
  return body;
}

double frequency(const Body& pair) {
  return std::sqrt(pair.forces.stiffness(0).normal / pair.inertia.mass[1]);
}

/// s(t) - s''(t)/w^2 + s''''(t)/w^4 solves u'' + w^2 u = w^2 s where s is a polynomial of degree 4.
struct Particular {
  double omega, ramp;
  double at(double t) const {
    const double x = t / ramp, w2 = omega * omega;
    return t < ramp ? ramp * (x * x * x - 0.5 * x * x * x * x) - 6 * x * (1 - x) / ramp / w2 -
                          12 / (ramp * ramp * ramp) / (w2 * w2)
                    : t - 0.5 * ramp;
  }
  double rate_at(double t) const {
    const double x = t / ramp, w2 = omega * omega;
    return t < ramp ? x * x * (3 - 2 * x) - (6 - 12 * x) / (ramp * ramp) / w2 : 1;
  }
};

/// What hangs on a spring, at rest at first, when the spring's other end moves as s: by the particular solution and the
/// free vibration that meets displacement and velocity where the ramp begins and ends.
double exact(double omega, double ramp, double time) {
  const Particular p{omega, ramp};
  const auto free = [&](double since, double u, double v) {
    return u * std::cos(omega * since) + v / omega * std::sin(omega * since);
  };
  const double u0 = -p.at(0), v0 = -p.rate_at(0);
  if (time < ramp)
    return p.at(time) + free(time, u0, v0);
  const double before = std::nextafter(ramp, 0.0);
  const double u = p.at(before) + free(ramp, u0, v0) - p.at(ramp);
  const double v =
      p.rate_at(before) + omega * (v0 / omega * std::cos(omega * ramp) - u0 * std::sin(omega * ramp)) - 1;
  return p.at(time) + free(time - ramp, u, v);
}

/// Largest distance of the hanging particle from where it would hang at rest, over the ten periods after the ramp.
double vibration(const Body& body, double omega, double ramp) {
  const double period = 2 * std::numbers::pi / omega, dt = period / 200;
  Motion motion = Motion::at_rest(2);
  core::ThreadPool pool;
  double largest = 0;
  VelocityVerlet({.time_step = dt, .loading = {.ramp = ramp}})
      .run(body.problem(), motion, static_cast<std::uint64_t>((ramp + 10 * period) / dt), pool,
           [&](const Step& step) {
             if (step.motion.time > ramp)
               largest = std::max(largest,
                                  std::abs(step.motion.displacement[1][0] - step.motion.displacement[0][0]));
             return true;
           });
  return largest;
}

} // namespace

TEST_CASE("a sudden loading is u = t to the last bit") {
  for (const double t : {0.0, 1e-300, 0.1, 1.0 / 3, 7e9}) {
    const auto now = Loading{}.at(t);
    CHECK(now.way == t);
    CHECK(now.speed == 1);
    CHECK(now.acceleration == 0);
  }
}

TEST_CASE("a ramp starts at rest, ends at full speed, and its derivatives are those of its way") {
  const Loading loading{.ramp = 0.3};
  CHECK(loading.at(0).way == 0);
  CHECK(loading.at(0).speed == 0);
  CHECK(loading.at(0).acceleration == 0);
  CHECK(loading.at(0.3).way == 0.15);
  CHECK(loading.at(0.3).speed == 1);
  CHECK(loading.at(0.3).acceleration == 0);
  const double before = std::nextafter(0.3, 0.0);
  CHECK(loading.at(before).way == doctest::Approx(0.15));
  CHECK(loading.at(before).speed == doctest::Approx(1));
  CHECK(std::abs(loading.at(before).acceleration) < 1e-12);
  for (double t = 0.01; t < 0.5; t += 0.017) {
    const double h = 1e-5;
    const auto low = loading.at(t - h), now = loading.at(t), high = loading.at(t + h);
    CHECK((high.way - low.way) / (2 * h) == doctest::Approx(now.speed).epsilon(1e-7));
    CHECK(std::abs((high.speed - low.speed) / (2 * h) - now.acceleration) < 1e-6);
    CHECK(now.speed > low.speed - 1e-15); // never backwards
  }
}

TEST_CASE("a mass pulled by a ramp through a bond meets the exact solution, at second order in the step") {
  const double rate = 1e-3;
  const Body body = pulled_pair(rate);
  const double omega = frequency(body), period = 2 * std::numbers::pi / omega;
  for (const double periods : {0.4, 2.3}) {
    CAPTURE(periods);
    const double ramp = periods * period, time = ramp + 2 * period;
    double error[4]; // the largest on the way
    int steps = 200;
    for (double& largest : error) {
      Motion motion = Motion::at_rest(2);
      core::ThreadPool pool;
      largest = 0;
      VelocityVerlet({.time_step = time / steps, .loading = {.ramp = ramp}})
          .run(body.problem(), motion, static_cast<std::uint64_t>(steps), pool, [&](const Step& step) {
            const double wanted = rate * exact(omega, ramp, step.motion.time);
            largest = std::max(largest, std::abs(step.motion.displacement[1][0] - wanted));
            return true;
          });
      largest /= rate * time;
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

TEST_CASE("a ramp over several periods leaves a small part of the vibration that a sudden start leaves") {
  const double rate = 1e-3;
  const Body body = pulled_pair(rate);
  const double omega = frequency(body), period = 2 * std::numbers::pi / omega;
  const double sudden = vibration(body, omega, 0);
  CHECK(sudden == doctest::Approx(rate / omega).epsilon(1e-3)); // the amplitude of a jump in velocity
  double last = sudden;
  for (const double periods : {2.0, 4.0, 8.0}) {
    CAPTURE(periods);
    const double left = vibration(body, omega, periods * period);
    const double phase = 2 * std::numbers::pi * periods;
    CHECK(left < 1.01 * 12 / (phase * phase) * sudden); // the bound of the class's comment
    CHECK(left < last);
    last = left;
  }
}

TEST_CASE("reactions of a body accelerated rigidly are what its inertia and its mass damping ask for") {
  Body body = lattice_body(3, 9);
  for (std::size_t i = 0; i < body.size(); ++i)
    body.constraints.add({static_cast<ParticleIndex>(i), 1, 0.5});
  Motion motion = Motion::at_rest(body.size());
  core::ThreadPool pool;
  const double alpha = 30, dt = 0.3 * stability_limit(body, 1e-6);
  const Loading loading{.ramp = 150.5 * dt};
  double worst = 0;
  VelocityVerlet({.time_step = dt, .damping = {alpha, 0.1 * dt}, .loading = loading})
      .run(body.problem(), motion, 200, pool, [&](const Step& step) {
        const auto now = loading.at(step.motion.time);
        for (std::size_t k = 0; k < step.reaction.size(); ++k) {
          const double wanted = body.inertia.mass[k] * 0.5 * (now.acceleration + alpha * now.speed);
          worst = std::max(worst, std::abs(step.reaction[k] / wanted - 1));
        }
        return true;
      });
  CHECK(worst < 1e-12);
  CHECK(motion.displacement[5][1] == 0.5 * loading.at(motion.time).way);
  // all the work went into motion and drag: sum m v dv + alpha m v^2 dt
  double mass = 0;
  for (const double m : body.inertia.mass)
    mass += m;
  CHECK(motion.energy.external_work - motion.energy.dissipated ==
        doctest::Approx(0.5 * mass * 0.25).epsilon(1e-4));
}

TEST_CASE("a run over the end of a ramp goes on bit by bit, however it is cut up and watched") {
  Body body = lattice_body(4, 14, true);
  body.constraints.add({63, 1, -0.5});
  body.constraints.add({62, 4, 100});
  const double dt = 0.5 * stability_limit(body, 1e-6), omega = 2 / stability_limit(body, 1e-6);
  VelocityVerlet::Parameters parameters{.time_step = dt,
                                        .damping = Damping::between(0.05, 0.05 * omega, omega),
                                        .loading = {.ramp = 60.3 * dt}};
  core::ThreadPool pool, three(3);
  Motion whole = Motion::at_rest(body.size());
  VelocityVerlet(parameters).run(body.problem(), whole, 100, pool);
  SUBCASE("in parts, on another number of threads") {
    Motion motion = Motion::at_rest(body.size());
    for (const unsigned steps : {37u, 20u, 5u, 38u})
      VelocityVerlet(parameters).run(body.problem(), motion, steps, three);
    CHECK(same_bytes(motion, whole));
  }
  SUBCASE("observed at every step and now and then") {
    std::vector<Motion> seen;
    Motion motion = Motion::at_rest(body.size());
    VelocityVerlet(parameters).run(body.problem(), motion, 100, pool, [&](const Step& step) {
      if (step.motion.step % 30 == 0)
        seen.push_back(step.motion);
      return true;
    });
    CHECK(same_bytes(motion, whole));
    parameters.observe_every = 30;
    motion = Motion::at_rest(body.size());
    std::size_t looks = 0;
    VelocityVerlet(parameters).run(body.problem(), motion, 100, three, [&](const Step& step) {
      CHECK(same_bytes(step.motion, seen.at(looks++)));
      const auto now = parameters.loading.at(step.motion.time);
      CHECK(step.motion.velocity[63][1] == -0.5 * now.speed);
      CHECK(step.motion.acceleration[63][1] == -0.5 * now.acceleration);
      return true;
    });
    CHECK(looks == 3);
    CHECK(same_bytes(motion, whole));
  }
  SUBCASE("but not under another loading") {
    parameters.loading.ramp *= 2;
    CHECK(contains(message_of([&] { VelocityVerlet(parameters).run(body.problem(), whole, 1, pool); }),
                   "a motion goes on under the constraints it began with"));
  }
}

TEST_CASE("bad ramps are refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {-1e-9, nan, infinity})
    CHECK(contains(message_of([&] { VelocityVerlet({.time_step = 1, .loading = {.ramp = bad}}); }),
                   "ramp of the loading = " + core::to_text(bad) +
                       " is not accepted: a finite number, 0 or above, in s is expected"));
}
