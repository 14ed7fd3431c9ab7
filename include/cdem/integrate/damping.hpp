#pragma once

/// @file
/// Rayleigh damping.

#include <cdem/core/error.hpp>

#include <cmath>

namespace cdem::integrate {

/// Rayleigh damping C = alpha M + beta K, [L17] section 2.2.
///
/// A mode of angular frequency w is damped with the ratio (alpha/w + beta w)/2 of the critical damping.
struct Damping {
  double alpha = 0; ///< 1/s, on the masses
  double beta = 0;  ///< s, on the stiffness; costs a second evaluation of the forces at every step

  /// Mass damping alone that gives `ratio` at angular frequency `omega`, less above it: alpha = 2 ratio
  /// omega.
  static Damping of_mode(double ratio, double omega) {
    check(ratio, omega);
    return {2 * ratio * omega, 0};
  }

  /// Both, so that the ratio is `ratio` at two frequencies and less in between.
  ///
  ///     alpha = 2 ratio w1 w2/(w1 + w2),   beta = 2 ratio/(w1 + w2)
  static Damping between(double ratio, double lower_omega, double upper_omega) {
    check(ratio, lower_omega);
    check(ratio, upper_omega);
    const double sum = lower_omega + upper_omega;
    return {2 * ratio * lower_omega * upper_omega / sum, 2 * ratio / sum};
  }

  /// Damping ratio of a mode of angular frequency `omega`, rad/s, above 0.
  double ratio_at(double omega) const {
    core::expect_positive(omega, "angular frequency of the damping ratio", "rad/s");
    return 0.5 * (alpha / omega + beta * omega);
  }

  /// Factor on the undamped stable step, for stiffness damping at the extrapolated velocity (VelocityVerlet).
  ///
  ///     sqrt(1 + 4 xi^2) - 2 xi,   xi = beta omega_max / 2
  ///
  /// With h = omega dt the characteristic polynomial z^3 + (h^2 + 3 xi h - 2) z^2 + (1 - 4 xi h) z + xi h has
  /// all its roots inside the unit circle (Jury's test) just when h^2 + 8 xi h < 4. Mass damping is solved for
  /// in closed form and leaves the limit, a root at z = -1, where it is.
  /// @param largest_omega  the body's largest angular frequency, or a bound above it: the product of the
  ///                       undamped step and the factor falls with it, so that the step stays a safe one
  double step_factor(double largest_omega) const {
    core::expect_not_negative(largest_omega, "largest angular frequency", "rad/s");
    const double twice_ratio = beta * largest_omega;
    return 1 / (std::sqrt(1 + twice_ratio * twice_ratio) + twice_ratio);
  }

  /// @throws core::InvalidInput if alpha or beta is negative or not finite
  void validate() const {
    core::expect_not_negative(alpha, "alpha of the Rayleigh damping", "1/s");
    core::expect_not_negative(beta, "beta of the Rayleigh damping", "s");
  }

private:
  static void check(double ratio, double omega) {
    core::expect_not_negative(ratio, "damping ratio");
    core::expect_positive(omega, "angular frequency of the damping ratio", "rad/s");
  }
};

} // namespace cdem::integrate
