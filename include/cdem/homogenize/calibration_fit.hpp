#pragma once

/// @file
/// The chart of a kind of packing from measurements on some of it.

#include <cdem/homogenize/calibration_chart.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace cdem::homogenize {

/// What one packing gave at one r_mu.
struct CalibrationPoint {
  std::uint64_t packing = 0;   ///< number or seed: tells packings apart
  double radius_ratio = 0;     ///< r_mu
  double relative_modulus = 0; ///< E_a = E_M / E_mu
  double poissons_ratio = 0;   ///< nu_M
};

/// How well each order of a polynomial foretells an r_mu that it has not seen.
struct OrderChoice {
  std::vector<double> error; ///< [orders from 1 on] root mean square; NaN where points are too few
  int order = 0;             ///< chosen
};

/// How a chart is fitted.
struct FitParameters {
  int highest_order = 6;           ///< 1 to 12; none is tried that r_mu are too few for, one of them left out
  double modulus_tolerance = 5e-4; ///< error of E_a, relative, that needs no higher order
  double poissons_tolerance = 2e-4; ///< the same of nu
};

/// A chart, and how its orders came about.
struct CalibrationFit {
  CalibrationChart chart;
  OrderChoice modulus, poissons_ratio;
};

namespace detail {

/// Points of a curve, and the weights of their errors.
struct Curve {
  std::vector<double> x, y, weight;
};

/// Polynomial of least sum of (weight (p(x) - y))^2, the points of number `left_out` aside.
inline Polynomial fit(const Curve& curve, int order, std::size_t left_out) {
  const std::size_t count = curve.x.size() - (left_out < curve.x.size() ? 1 : 0);
  Eigen::MatrixXd powers(count, order + 1);
  Eigen::VectorXd values(count);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (i == left_out)
      continue;
    double power = curve.weight[i];
    for (int k = 0; k <= order; ++k, power *= curve.x[i])
      powers(row, k) = power;
    values[row++] = curve.weight[i] * curve.y[i];
  }
  const Eigen::VectorXd c = powers.colPivHouseholderQr().solve(values);
  return {std::vector<double>(c.begin(), c.end())};
}

inline double residual(const Curve& curve, const Polynomial& p, std::size_t i) {
  return curve.weight[i] * (p(curve.x[i]) - curve.y[i]);
}

/// The lowest order whose error is within one standard error of the least, or so small that it does not matter.
///
/// One r_mu after the other is left out, all its packings at once, the two at the ends excepted (there it would be
/// extrapolation). To leave out a packing would tell nothing: packings differ by about the same at all r_mu.
/// @param negligible  an error that needs no higher order
inline OrderChoice choose_order(const Curve& curve, int highest, double negligible) {
  const std::size_t count = curve.x.size();
  OrderChoice choice;
  std::vector<double> mean, deviation; // of the squared errors
  for (int order = 1; order <= highest; ++order) {
    if (count < static_cast<std::size_t>(order) + 2) { // one left out: at least as many as coefficients
      choice.error.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    double sum = 0, sum_of_squares = 0;
    for (std::size_t i = 1; i + 1 < count; ++i) {
      const double error = residual(curve, fit(curve, order, i), i);
      sum += error * error;
      sum_of_squares += error * error * error * error;
    }
    const double n = static_cast<double>(count - 2);
    mean.push_back(sum / n);
    deviation.push_back(std::sqrt(std::max(0.0, sum_of_squares / n - mean.back() * mean.back()) / n));
    choice.error.push_back(std::sqrt(mean.back()));
  }
  const auto least = static_cast<std::size_t>(std::min_element(mean.begin(), mean.end()) - mean.begin());
  const double enough = std::max(mean[least] + deviation[least], negligible * negligible);
  choice.order = 1;
  while (mean[static_cast<std::size_t>(choice.order - 1)] > enough)
    ++choice.order;
  return choice;
}

/// The points by r_mu, then by packing, found to make a chart.
inline std::vector<CalibrationPoint> checked_points(std::span<const CalibrationPoint> points) {
  for (const CalibrationPoint& point : points) {
    core::expect(point.radius_ratio > 0 && point.radius_ratio <= 1, "r_mu of a calibration point",
                 point.radius_ratio, "a number in ]0, 1] is expected");
    core::expect_positive(point.relative_modulus, "E_a of a calibration point");
    core::expect_finite(point.poissons_ratio, "nu of a calibration point");
  }
  std::vector<CalibrationPoint> sorted(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end(), [](const CalibrationPoint& a, const CalibrationPoint& b) {
    return std::pair(a.radius_ratio, a.packing) < std::pair(b.radius_ratio, b.packing);
  });
  for (std::size_t i = 1; i < sorted.size(); ++i)
    core::expect(sorted[i].radius_ratio > sorted[i - 1].radius_ratio ||
                     sorted[i].packing > sorted[i - 1].packing,
                 "packing measured twice at r_mu = " + core::to_text(sorted[i].radius_ratio),
                 sorted[i].packing, "each packing once is expected");
  return sorted;
}

/// Means of the packings against r_mu, and how the packings scatter about them.
struct MeanCurves {
  Curve modulus;  ///< E_a / r_mu^2, by relative errors
  Curve poissons; ///< nu
  std::uint32_t packings = 0;
  double modulus_scatter = 0, poissons_scatter = 0, correlation = 0;
};

inline MeanCurves mean_curves(const std::vector<CalibrationPoint>& sorted) {
  MeanCurves mean;
  double modulus_square = 0, poissons_square = 0, product = 0, freedom = 0;
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    const double r = sorted[begin].radius_ratio;
    double modulus = 0, poissons = 0;
    for (; end < sorted.size() && !(sorted[end].radius_ratio > r); ++end) {
      modulus += sorted[end].relative_modulus;
      poissons += sorted[end].poissons_ratio;
    }
    const std::size_t count = end - begin;
    if (begin == 0)
      mean.packings = static_cast<std::uint32_t>(count);
    bool same = count == mean.packings;
    for (std::size_t i = 0; same && i < count; ++i)
      same = sorted[begin + i].packing == sorted[i].packing;
    core::expect(same, "number of packings at r_mu = " + core::to_text(r), count,
                 "the same " + std::to_string(mean.packings) + " packings at every r_mu are expected");
    modulus /= static_cast<double>(count);
    poissons /= static_cast<double>(count);
    for (std::size_t i = begin; i < end; ++i) {
      const double dm = sorted[i].relative_modulus / modulus - 1, dp = sorted[i].poissons_ratio - poissons;
      modulus_square += dm * dm;
      poissons_square += dp * dp;
      product += dm * dp;
    }
    freedom += static_cast<double>(count - 1);
    mean.modulus.x.push_back(r);
    mean.modulus.y.push_back(modulus / (r * r));
    mean.modulus.weight.push_back(r * r / modulus);
    mean.poissons.x.push_back(r);
    mean.poissons.y.push_back(poissons);
    mean.poissons.weight.push_back(1);
  }
  mean.modulus_scatter = std::sqrt(modulus_square / freedom); // NaN for one packing
  mean.poissons_scatter = std::sqrt(poissons_square / freedom);
  const double size = std::sqrt(modulus_square * poissons_square);
  mean.correlation = size > 0 ? product / size : 0;
  return mean;
}

/// Fits one curve by the order that cross-validation chooses. @param rms  what is left, root mean square
inline Polynomial fit_by_choice(const Curve& curve, int highest, double negligible, OrderChoice& choice,
                                double& rms) {
  choice = choose_order(curve, highest, negligible);
  const Polynomial polynomial = fit(curve, choice.order, curve.x.size());
  double sum = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    sum += residual(curve, polynomial, i) * residual(curve, polynomial, i);
  rms = std::sqrt(sum / static_cast<double>(curve.x.size()));
  return polynomial;
}

} // namespace detail

/// Fits a chart: E_a = r_mu^2 P(r_mu), nu = Q(r_mu), orders chosen by cross-validation.
///
/// P and Q are fitted to the means of the packings at each r_mu, P by relative errors. An order is chosen by leaving out one
/// r_mu at a time: the lowest whose error is within one standard error of the least, or below the tolerance or a third of
/// the scatter between packings (which adds 5 % to what that leaves open).
/// @param points  any order; every r_mu by as many packings as there are, each once
/// @param chart   name, ecd, coordination, micro_poissons_ratio and particles, which are kept
/// @throws core::InvalidInput for points that are not finite, not positive, twice the same, fewer than 4 r_mu, parameters
///         out of range, or a chart that cannot be inverted
/// @complexity O(orders r_mu) small fits
inline CalibrationFit fit_chart(std::span<const CalibrationPoint> points, CalibrationChart chart,
                                const FitParameters& parameters = {}) {
  const int highest = parameters.highest_order;
  core::expect(highest >= 1 && highest <= 12, "highest order of the chart", highest, "1 to 12 is expected");
  core::expect_not_negative(parameters.modulus_tolerance, "tolerance of E_a of the chart");
  core::expect_not_negative(parameters.poissons_tolerance, "tolerance of nu of the chart");
  const detail::MeanCurves mean = detail::mean_curves(detail::checked_points(points));
  core::expect(mean.modulus.x.size() >= 4, "number of different r_mu to calibrate with",
               mean.modulus.x.size(), "4 or more is expected");
  chart.packings = mean.packings;
  chart.smallest_ratio = mean.modulus.x.front();
  chart.largest_ratio = mean.modulus.x.back();
  chart.modulus_scatter = mean.modulus_scatter;
  chart.poissons_scatter = mean.poissons_scatter;
  chart.scatter_correlation = mean.correlation;
  const auto negligible = [](double tolerance, double scatter) {
    return std::isfinite(scatter) ? std::max(tolerance, scatter / 3) : tolerance;
  };
  CalibrationFit found;
  chart.modulus = detail::fit_by_choice(mean.modulus, highest,
                                        negligible(parameters.modulus_tolerance, mean.modulus_scatter),
                                        found.modulus, chart.modulus_residual);
  chart.poissons_ratio = detail::fit_by_choice(
      mean.poissons, highest, negligible(parameters.poissons_tolerance, mean.poissons_scatter),
      found.poissons_ratio, chart.poissons_residual);
  chart.validate();
  found.chart = std::move(chart);
  return found;
}

} // namespace cdem::homogenize
