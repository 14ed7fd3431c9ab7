#pragma once

/// @file
/// Figures of a stress field: over the specimens, and invariants of one tensor.

#include <cdem/core/error.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <string>

namespace cdem::stress {

/// Von Mises equivalent stress, Pa: sqrt(3/2 s:s), s the deviator of the symmetric part.
inline double von_mises(const Mat3& stress) {
  const Mat3 symmetric = 0.5 * (stress + stress.transpose());
  const Mat3 deviator = symmetric - symmetric.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

/// Mean (hydrostatic) stress, Pa: a third of the trace, tension positive.
inline double hydrostatic(const Mat3& stress) {
  return stress.trace() / 3;
}

/// A quantity over the specimens of a field; every specimen counts with its volume.
struct Statistics {
  double mean = 0;
  double minimum = 0;
  double maximum = 0;
  double standard_deviation = 0; ///< sqrt of the mean squared deviation (divided by the volume, not by n - 1)

  /// Standard deviation over the mean's magnitude, CoV of [L17] section 2.5; infinite or NaN for a mean of 0.
  double coefficient_of_variation() const { return standard_deviation / std::abs(mean); }
};

namespace detail {
inline void expect_specimens(const StressField& field) {
  core::expect(field.size() > 0, "number of specimens", field.size(), "1 or more is expected");
  core::expect(field.volume.size() == field.size(), "number of specimen volumes", field.volume.size(),
               "one per specimen (" + std::to_string(field.size()) + ") is expected");
  for (std::size_t cell = 0; cell < field.size(); ++cell)
    if (!(std::isfinite(field.volume[cell]) && field.volume[cell] > 0))
      core::reject("volume of specimen " + std::to_string(cell), field.volume[cell],
                   "a finite number above 0 m^3 is expected");
}
} // namespace detail

/// Statistics of quantity(stress), such as von_mises, over the specimens, empty ones included.
///
/// @throws core::InvalidInput for a field without specimens, a volume that is not positive, or a quantity
///         that is not finite; names the first such specimen
/// @complexity O(specimens), no allocation
template <std::invocable<const Mat3&> Quantity>
Statistics statistics(const StressField& field, Quantity&& quantity) {
  detail::expect_specimens(field);
  Statistics result;
  result.minimum = std::numeric_limits<double>::infinity();
  result.maximum = -result.minimum;
  double volume = 0;
  double squares =
      0; // sum of volume times squared deviation, brought up to date as the mean moves (West 1979)
  for (std::size_t cell = 0; cell < field.size(); ++cell) {
    const double value = std::invoke(quantity, field.stress[cell]);
    if (!std::isfinite(value))
      core::reject("quantity in specimen " + std::to_string(cell), value, "a finite number is expected");
    volume += field.volume[cell];
    const double deviation = value - result.mean;
    result.mean += field.volume[cell] / volume * deviation;
    squares += field.volume[cell] * deviation * (value - result.mean);
    result.minimum = std::min(result.minimum, value);
    result.maximum = std::max(result.maximum, value);
  }
  result.standard_deviation = std::sqrt(std::max(0.0, squares / volume));
  return result;
}

/// Statistics of one component, sigma of row `force` and column `branch`.
inline Statistics statistics(const StressField& field, Axis force, Axis branch) {
  return statistics(field, [=](const Mat3& stress) { return stress(index_of(force), index_of(branch)); });
}

/// Mean stress of the specimens weighted by volume, Pa.
/// @throws core::InvalidInput for a field without specimens or a volume that is not positive
inline Mat3 mean_stress(const StressField& field) {
  detail::expect_specimens(field);
  Mat3 moment = Mat3::Zero();
  double volume = 0;
  for (std::size_t cell = 0; cell < field.size(); ++cell) {
    moment += field.volume[cell] * field.stress[cell];
    volume += field.volume[cell];
  }
  return moment / volume;
}

} // namespace cdem::stress
