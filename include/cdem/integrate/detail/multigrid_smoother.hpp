#pragma once

/// @file
/// Gains of the static multigrid's smoother.

#include <cmath>
#include <numbers>

namespace cdem::integrate::detail {

/// Gain of step j = 0, ..., steps - 1 of the smoother x := x + gain D^-1 (b - K x).
///
/// The steps multiply an error of eigenvalue s (of D^-1 K, in units of its largest) by the polynomial p of that degree
/// with p(0) = 1 that makes the V-cycle's bound sup s p^2 / (1 - p^2) least; the gains are the inverses of its roots. It is
/// p(s) = +-T_2n+1(y) / sqrt(1 + c s) with y^2 = (1 + c s) / (1 + c), 1 / sqrt(1 + c) = cos(n pi / (2n + 1)): T is odd,
/// and one where p is to be one.
/// Lottes, Optimal polynomial smoothers for multigrid V-cycles, Numer. Linear Algebra Appl. 30 (2023) e2518, gives it as a
/// weighted Chebyshev iteration of the fourth kind.
inline float smoothing_gain(int j, int steps) {
  // D^-1 K of links, D its 6x6 diagonal blocks, has no eigenvalue above 2: |a - b|^2 <= 2 |a|^2 + 2 |b|^2 in the
  // energy of each link.
  constexpr double largest_eigenvalue = 2;
  const double end = std::cos(steps * std::numbers::pi / (2 * steps + 1));
  const double y = std::cos((2 * j + 1) * std::numbers::pi / (4 * steps + 2));
  const double root = (y * y - end * end) / (1 - end * end);
  return static_cast<float>(1 / (root * largest_eigenvalue));
}

} // namespace cdem::integrate::detail
