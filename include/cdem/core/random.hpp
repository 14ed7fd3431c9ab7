#pragma once

/// @file
/// Seeded random numbers that are the same on every compiler and standard library.

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace cdem::core {

/// Stream of random numbers from one seed.
///
/// The engine is std::mt19937_64, whose sequence the standard fixes; the distributions are written here because
/// the standard leaves theirs to each library.
class Random {
public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1): the 53 upper bits of one draw.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  /// Uniform in [lower, upper); rounding may give `upper` itself.
  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }

  /// Normal with mean 0 and standard deviation 1 (Box–Muller, one of the pair is dropped: two draws a call).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

  /// One draw of 64 random bits.
  std::uint64_t bits() { return engine_(); }

private:
  std::mt19937_64 engine_;
};

} // namespace cdem::core
