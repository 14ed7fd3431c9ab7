#pragma once

/// @file
/// What a few packings say of all the others: mean, scatter, prediction interval, the limit of large sizes.

#include <cdem/core/error.hpp>
#include <cdem/core/student.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace cdem::homogenize {

/// Mean and scatter of a sample.
struct SampleStatistics {
  std::size_t count = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double deviation =
      std::numeric_limits<double>::quiet_NaN(); ///< standard deviation, n - 1 in it; NaN below 2 values

  /// Standard error of the mean.
  double standard_error() const { return deviation / std::sqrt(static_cast<double>(count)); }

  /// Half the width of the interval about the mean in which one more value falls with the probability given, if values are
  /// normally distributed: t s sqrt(1 + 1/n). NaN below 2 values.                                  [L17] figure 6: 95 %
  double prediction(double probability = 0.95) const {
    if (count < 2)
      return std::numeric_limits<double>::quiet_NaN();
    return core::student_factor(probability, count - 1) * deviation *
           std::sqrt(1 + 1 / static_cast<double>(count));
  }
};

/// @param values  those that are not finite were not measured and do not count
inline SampleStatistics sample_statistics(std::span<const double> values) {
  SampleStatistics sample;
  double sum = 0;
  for (const double value : values)
    if (std::isfinite(value)) {
      ++sample.count;
      sum += value;
    }
  if (sample.count == 0)
    return sample;
  sample.mean = sum / static_cast<double>(sample.count);
  if (sample.count < 2)
    return sample;
  double squares = 0;
  for (const double value : values)
    if (std::isfinite(value))
      squares += (value - sample.mean) * (value - sample.mean);
  sample.deviation = std::sqrt(squares / static_cast<double>(sample.count - 1));
  return sample;
}

/// A straight line y = intercept + slope x.
struct Line {
  double intercept = 0;
  double slope = 0;
  double intercept_error = 0; ///< standard error, from the errors given
};

/// The line of least squares through points with known errors.
///
/// With x = N^(-1/3), the part of a body that lies at its faces, the intercept is the body without faces.
/// @param error  [points] standard errors of y, above 0
/// @throws core::InvalidInput for fewer than two different x, or an error that is not above 0
inline Line fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> error) {
  core::expect(x.size() == y.size() && x.size() == error.size() && x.size() >= 2, "number of points",
               x.size(), "two or more, with as many values and errors, are expected");
  double w = 0, wx = 0, wy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    core::expect_positive(error[i], "error of point " + std::to_string(i));
    const double weight = 1 / (error[i] * error[i]);
    w += weight;
    wx += weight * x[i];
    wy += weight * y[i];
  }
  const double x_mean = wx / w, y_mean = wy / w;
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double weight = 1 / (error[i] * error[i]);
    xx += weight * (x[i] - x_mean) * (x[i] - x_mean);
    xy += weight * (x[i] - x_mean) * (y[i] - y_mean);
  }
  core::expect(xx > 0, "spread of the points", xx, "two different positions are expected");
  const double slope = xy / xx;
  return {y_mean - slope * x_mean, slope, std::sqrt(1 / w + x_mean * x_mean / xx)};
}

} // namespace cdem::homogenize
