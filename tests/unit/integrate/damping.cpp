#include <cdem/integrate/damping.hpp>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include <limits>

#include "sample.hpp"

namespace {

using namespace sample;
using integrate::Damping;

/// Largest modulus of the eigenvalues of one step, (u, v, a) to (u, v, a), of a mode of omega = 1.
double spectral_radius(const Damping& damping, double dt) {
  Eigen::Matrix3d step;
  for (int column = 0; column < 3; ++column) {
    const double u = column == 0, v = column == 1, a = column == 2;
    const double half = v + 0.5 * dt * a, next = u + dt * half;
    const double free = -next - damping.beta * (half + 0.5 * dt * a);
    const double velocity = (half + 0.5 * dt * free) / (1 + 0.5 * dt * damping.alpha);
    step.col(column) << next, velocity, free - damping.alpha * velocity;
  }
  return step.eigenvalues().cwiseAbs().maxCoeff();
}

} // namespace

TEST_CASE("of_mode damps its frequency with the ratio asked for, and higher ones less") {
  const Damping damping = Damping::of_mode(0.3, 50);
  CHECK(damping.alpha == doctest::Approx(30).epsilon(1e-15));
  CHECK(damping.beta == 0);
  CHECK(damping.ratio_at(50) == doctest::Approx(0.3).epsilon(1e-15));
  CHECK(damping.ratio_at(500) == doctest::Approx(0.03).epsilon(1e-14));
}

TEST_CASE("between gives the ratio at both frequencies and less in between") {
  const Damping damping = Damping::between(0.2, 10, 1000);
  CHECK(damping.ratio_at(10) == doctest::Approx(0.2).epsilon(1e-14));
  CHECK(damping.ratio_at(1000) == doctest::Approx(0.2).epsilon(1e-14));
  for (double omega = 11; omega < 1000; omega *= 1.3)
    CHECK(damping.ratio_at(omega) < 0.2);
  CHECK(damping.ratio_at(5) > 0.2);
  CHECK(damping.ratio_at(2000) > 0.2);
  const Damping swapped = Damping::between(0.2, 1000, 10);
  CHECK(swapped.alpha == damping.alpha);
  CHECK(swapped.beta == damping.beta);
}

TEST_CASE("no damping is no damping") {
  for (const Damping& damping : {Damping{}, Damping::of_mode(0, 1), Damping::between(0, 1, 2)}) {
    CHECK(damping.alpha == 0);
    CHECK(damping.beta == 0);
    CHECK(damping.ratio_at(3) == 0);
    CHECK(damping.step_factor(1e9) == 1);
  }
  CHECK(Damping{5, 0}.step_factor(1e9) == 1);
  CHECK(Damping{0, 5}.step_factor(0) == 1);
}

TEST_CASE("step_factor is where an eigenvalue of the step leaves the unit circle") {
  for (const double ratio : {0.0, 1e-3, 0.05, 0.3, 1.0, 5.0})
    for (const double alpha : {0.0, 0.1, 1.0, 5.0}) {
      CAPTURE(ratio);
      CAPTURE(alpha);
      const Damping damping{alpha, 2 * ratio};
      const double limit = 2 * damping.step_factor(1);
      CHECK(spectral_radius(damping, 1.001 * limit) > 1 + 1e-5);
      for (double part = 0.02; part < 1; part += 0.02) // stable all the way, not only at the end
        CHECK(spectral_radius(damping, part * limit) <= 1 + 1e-7);
    }
}

TEST_CASE("the damped stable step falls with the frequency: a bound of it gives a safe step") {
  const Damping damping{0, 1e-3};
  double previous = std::numeric_limits<double>::infinity();
  for (double omega = 1; omega < 1e8; omega *= 1.7) {
    const double step = 2 / omega * damping.step_factor(omega);
    CHECK(step < previous);
    CHECK(step > 0);
    previous = step;
  }
  // far above 1/beta: dt -> 1/(beta omega^2), which a difference of large numbers would lose
  CHECK(damping.step_factor(1e12) == doctest::Approx(1 / (2 * 1e-3 * 1e12)).epsilon(1e-12));
}

TEST_CASE("bad damping is refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {-0.1, nan, inf}) {
    const std::string text = "damping ratio = " + core::to_text(bad) + " is not accepted";
    CHECK(contains(message_of([&] { Damping::of_mode(bad, 1); }), text));
    CHECK(contains(message_of([&] { Damping::between(bad, 1, 2); }), text));
    CHECK(contains(message_of([&] {
                     Damping{bad, 0}.validate();
                   }),
                   "alpha of the Rayleigh damping = " + core::to_text(bad)));
    CHECK(contains(message_of([&] {
                     Damping{0, bad}.validate();
                   }),
                   "beta of the Rayleigh damping = " + core::to_text(bad)));
    CHECK(contains(message_of([&] { Damping{}.step_factor(bad); }), "largest angular frequency = "));
  }
  for (const double bad : {0.0, -0.1, nan, inf}) {
    const std::string text =
        "angular frequency of the damping ratio = " + core::to_text(bad) + " is not accepted";
    CHECK(contains(message_of([&] { Damping::of_mode(0.1, bad); }), text));
    CHECK(contains(message_of([&] { Damping::between(0.1, bad, 2); }), text));
    CHECK(contains(message_of([&] { Damping::between(0.1, 2, bad); }), text));
    CHECK(contains(message_of([&] { Damping{1, 1}.ratio_at(bad); }), text));
  }
}
