#pragma once

/// @file
/// Student's t distribution, for intervals about a mean.

#include <cdem/core/error.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>

namespace cdem::core {

/// Probability that a variable of Student's t distribution lies between -t and t.
///
/// The finite sums in powers of cos(atan(t/sqrt(degrees))), all of one sign.    Abramowitz and Stegun 26.7.3, 26.7.4
/// @param t        not below 0
/// @param degrees  of freedom, 1 or more
/// @complexity     O(degrees)
inline double student_probability(double t, std::uint64_t degrees) {
  const double angle = std::atan(t / std::sqrt(static_cast<double>(degrees)));
  const double cosine = std::cos(angle), square = cosine * cosine;
  const bool odd = degrees % 2 == 1;
  double term = odd ? cosine : 1, sum = degrees == 1 ? 0 : term;
  for (std::uint64_t k = odd ? 3 : 2; k + 1 < degrees && term > 1e-17 * sum; k += 2) {
    term *= square * static_cast<double>(k - 1) / static_cast<double>(k);
    sum += term;
  }
  sum *= std::sin(angle);
  return odd ? 2 / std::numbers::pi * (angle + sum) : sum;
}

/// The t between whose two signs a variable of Student's t distribution lies with a given probability: 1.96 for 0.95 and many
/// degrees, 12.71 for one.
///
/// @param probability  in ]0, 1[; below 1 - 1e-12, since a double does not tell more
/// @param degrees      of freedom, 1 or more
/// @throws InvalidInput for another probability, or no degree
/// @complexity         O(degrees), some 60 times
inline double student_factor(double probability, std::uint64_t degrees) {
  expect(probability > 0 && probability < 1 - 1e-12, "probability", probability,
         "a number above 0 and below 1 - 1e-12 is expected");
  expect(degrees >= 1, "degrees of freedom", degrees, "1 or more is expected");
  double low = 0, high = 1;
  while (student_probability(high, degrees) < probability)
    high *= 2;
  for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
    (student_probability(middle, degrees) < probability ? low : high) = middle;
  return high;
}

} // namespace cdem::core
