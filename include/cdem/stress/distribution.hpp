#pragma once

/// @file
/// How a stress is distributed over the specimens: moments, prediction interval, normal or log-normal.
///
/// The tests take the values for independent ones. Stresses of neighbouring specimens are not quite: take every other one along
/// each axis to see whether it matters.

#include <cdem/core/error.hpp>
#include <cdem/core/student.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace cdem::stress {

/// Moments of a sample, each without bias for a normal one.
struct SampleMoments {
  std::size_t count = 0; ///< n
  double mean = 0;
  double standard_deviation = 0; ///< s, with n - 1
  double skewness = 0;           ///< G1 = g1 sqrt(n (n - 1))/(n - 2); 0 for a normal distribution
  double excess_kurtosis = 0; ///< G2 = ((n + 1) g2 + 6)(n - 1)/((n - 2)(n - 3)); 0 for a normal distribution

  double coefficient_of_variation() const { return standard_deviation / std::abs(mean); }
  /// Standard error of the coefficient of variation c of a normal sample, c sqrt(1/2 + c^2)/sqrt(n).
  double coefficient_error() const {
    const double c = coefficient_of_variation();
    return c * std::sqrt((0.5 + c * c) / static_cast<double>(count));
  }
  /// Standard error of G1 for a normal sample: sqrt(6 n (n - 1)/((n - 2)(n + 1)(n + 3))).
  double skewness_error() const {
    const double n = static_cast<double>(count);
    return std::sqrt(6 * n * (n - 1) / ((n - 2) * (n + 1) * (n + 3)));
  }
  /// Standard error of G2 for a normal sample: 2 sqrt((n^2 - 1)/((n - 3)(n + 5))) times that of G1.
  double kurtosis_error() const {
    const double n = static_cast<double>(count);
    return 2 * skewness_error() * std::sqrt((n * n - 1) / ((n - 3) * (n + 5)));
  }
  /// Half the interval that holds the next value with a given probability, if the sample is normal:
  /// t s sqrt(1 + 1/n), t Student's with n - 1 degrees.
  /// @throws core::InvalidInput for a probability outside ]0, 1[
  double prediction(double probability = 0.95) const {
    const double n = static_cast<double>(count);
    return core::student_factor(probability, count - 1) * standard_deviation * std::sqrt(1 + 1 / n);
  }
};

/// Moments of a sample.                                                            Joanes and Gill 1998
/// @throws core::InvalidInput for fewer than 4 values, one that is not finite, or values that are all the same
/// @complexity O(n), no allocation
inline SampleMoments sample_moments(std::span<const double> values) {
  core::expect(values.size() >= 4, "number of values", values.size(), "4 or more is expected");
  SampleMoments moments;
  moments.count = values.size();
  const double n = static_cast<double>(values.size());
  for (const double value : values) {
    core::expect_finite(value, "value");
    moments.mean += value / n;
  }
  double m2 = 0, m3 = 0, m4 = 0;
  for (const double value : values) {
    const double d = value - moments.mean, square = d * d;
    m2 += square / n;
    m3 += square * d / n;
    m4 += square * square / n;
  }
  core::expect(m2 > 0, "variance of the values", m2, "values that differ are expected");
  moments.standard_deviation = std::sqrt(m2 * n / (n - 1));
  moments.skewness = m3 / (m2 * std::sqrt(m2)) * std::sqrt(n * (n - 1)) / (n - 2);
  moments.excess_kurtosis = ((n + 1) * (m4 / (m2 * m2) - 3) + 6) * (n - 1) / ((n - 2) * (n - 3));
  return moments;
}

/// The Anderson–Darling test of a sample against a distribution whose two parameters are estimated from it.
struct AndersonDarling {
  double statistic = 0; ///< A^2
  double modified =
      0; ///< A^2 (1 + 0.75/n + 2.25/n^2), whose distribution hardly depends on n: 0.752 is exceeded by 5 %
  double p_value =
      1; ///< probability of no smaller a statistic if the distribution is the right one; 3.7e-24 stands for less
};

namespace detail {

/// The logarithms. @throws core::InvalidInput for a value that is not above 0
inline std::vector<double> logarithms(std::span<const double> values) {
  std::vector<double> logs;
  logs.reserve(values.size());
  for (const double value : values) {
    core::expect_positive(value, "value");
    logs.push_back(std::log(value));
  }
  return logs;
}

/// p-value of the modified statistic.       D'Agostino and Stephens 1986, table 4.9
inline double normality_p_value(double a) {
  if (a >= 10)
    return 3.7e-24; // where the fit ends
  if (a >= 0.6)
    return std::exp(1.2937 - 5.709 * a + 0.0186 * a * a);
  if (a >= 0.34)
    return std::exp(0.9177 - 4.279 * a - 1.38 * a * a);
  if (a >= 0.2)
    return 1 - std::exp(-8.318 + 42.796 * a - 59.938 * a * a);
  return 1 - std::exp(-13.436 + 101.14 * a - 223.73 * a * a);
}

/// Logarithm of the likelihood of a normal sample at its maximum: mean and deviation (with n) are the sample's.
inline double normal_log_likelihood(const SampleMoments& moments) {
  const double n = static_cast<double>(moments.count);
  const double variance = moments.standard_deviation * moments.standard_deviation * (n - 1) / n;
  return -0.5 * n * (std::log(2 * std::numbers::pi * variance) + 1);
}

} // namespace detail

/// Tests whether a sample may come from a normal distribution of unknown mean and deviation.
///
/// A^2 = -n - (1/n) sum over i of (2 i - 1) (ln Phi(z_i) + ln(1 - Phi(z_(n+1-i)))),  z the sorted values less their mean over s
///                                                                       Anderson and Darling 1954; Stephens 1974
/// @throws core::InvalidInput for fewer than 8 values, one that is not finite, or values that are all the same
/// @complexity O(n log n)
inline AndersonDarling anderson_darling_normal(std::span<const double> values) {
  core::expect(values.size() >= 8, "number of values", values.size(), "8 or more is expected");
  const SampleMoments moments = sample_moments(values);
  std::vector<double> z(values.begin(), values.end());
  std::sort(z.begin(), z.end());
  for (double& value : z)
    value = (value - moments.mean) / moments.standard_deviation;
  const auto log_below = [](double x) { return std::log(0.5 * std::erfc(-x / std::numbers::sqrt2)); };
  const double n = static_cast<double>(z.size());
  double sum = 0;
  for (std::size_t i = 0; i < z.size(); ++i)
    sum += (2 * static_cast<double>(i) + 1) * (log_below(z[i]) + log_below(-z[z.size() - 1 - i]));
  AndersonDarling test;
  test.statistic = -n - sum / n;
  test.modified = test.statistic * (1 + 0.75 / n + 2.25 / (n * n));
  test.p_value = detail::normality_p_value(test.modified);
  return test;
}

/// The same for a log-normal distribution: the logarithms are tested.
/// @throws core::InvalidInput likewise, or for a value that is not above 0
inline AndersonDarling anderson_darling_lognormal(std::span<const double> values) {
  return anderson_darling_normal(detail::logarithms(values));
}

/// Which of two distributions makes a sample likelier.
struct LikelihoodComparison {
  double normal = 0;    ///< logarithm of the likelihood at its maximum, per unit of the values
  double lognormal = 0; ///< likewise
  double score =
      0; ///< Vuong's: standard normal if both are equally far from the truth; above 0 for log-normal

  /// ln of the likelihood ratio. Both have two parameters, so twice this is the difference of Akaike's (and Schwarz's) criterion.
  double in_favour_of_lognormal() const { return lognormal - normal; }
};

/// Compares a normal with a log-normal distribution, each with the parameters that suit the sample best.    Vuong 1989
/// @throws core::InvalidInput for fewer than 4 values, one that is not above 0, or values that are all the same
/// @complexity O(n)
inline LikelihoodComparison normal_or_lognormal(std::span<const double> values) {
  const std::vector<double> logs = detail::logarithms(values);
  const SampleMoments plain = sample_moments(values), logarithmic = sample_moments(logs);
  const double n = static_cast<double>(values.size());
  LikelihoodComparison comparison;
  comparison.normal = detail::normal_log_likelihood(plain);
  comparison.lognormal = detail::normal_log_likelihood(logarithmic) - n * logarithmic.mean;
  const double mean = comparison.in_favour_of_lognormal() / n;
  const double narrower = (n - 1) / n;
  const auto log_density = [&](const SampleMoments& m, double x) {
    const double variance = m.standard_deviation * m.standard_deviation * narrower, d = x - m.mean;
    return -0.5 * (std::log(2 * std::numbers::pi * variance) + d * d / variance);
  };
  double squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double ratio = log_density(logarithmic, logs[i]) - logs[i] - log_density(plain, values[i]);
    squares += (ratio - mean) * (ratio - mean);
  }
  comparison.score = comparison.in_favour_of_lognormal() / std::sqrt(squares);
  return comparison;
}

} // namespace cdem::stress
