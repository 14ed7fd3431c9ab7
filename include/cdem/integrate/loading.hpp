#pragma once

/// @file
/// How a prescribed motion sets in.

#include <cdem/core/error.hpp>

namespace cdem::integrate {

/// How the prescribed rates set in: at once, or over a ramp.
///
/// A prescribed degree of freedom follows u = rate s(t). Imposed suddenly, s = t. Accelerated from rest over the ramp
/// T, as [L17] section 2.3 suggests for faster convergence, with x = t/T up to 1:
///
///     s' = 3 x^2 - 2 x^3,   s = T (x^3 - x^4/2),   s'' = 6 x (1 - x)/T;   after it s = t - T/2
///
/// The acceleration is continuous, so that a mode of angular frequency w keeps an amplitude of at most some
/// 12/(w T)^2 of what it has after a sudden start.
struct Loading {
  double ramp = 0; ///< T, s; 0: suddenly

  /// s and its derivatives at one moment.
  struct Amplitude {
    double way = 0;          ///< s, displacement over rate, s
    double speed = 1;        ///< s', velocity over rate
    double acceleration = 0; ///< s'', acceleration over rate, 1/s
  };

  /// @param time  s, from the beginning; not negative
  Amplitude at(double time) const noexcept {
    if (time >= ramp)
      return {time - 0.5 * ramp, 1, 0};
    const double x = time / ramp;
    return {ramp * x * x * x * (1 - 0.5 * x), x * x * (3 - 2 * x), 6 * x * (1 - x) / ramp};
  }

  /// @throws core::InvalidInput if the ramp is negative or not finite
  void validate() const { core::expect_not_negative(ramp, "ramp of the loading", "s"); }
};

} // namespace cdem::integrate
