#pragma once

/// @file
/// From the moduli of a material to the micro parameters of its beams.

#include <cdem/bond/material.hpp>
#include <cdem/core/error.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cdem::homogenize {

/// c_0 + c_1 x + c_2 x^2 + ...
struct Polynomial {
  std::vector<double> coefficients;

  int order() const noexcept { return static_cast<int>(coefficients.size()) - 1; }
  double operator()(double x) const {
    double sum = 0;
    for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c)
      sum = sum * x + *c;
    return sum;
  }
  double slope(double x) const {
    double sum = 0;
    for (std::size_t k = coefficients.size(); k-- > 1;)
      sum = sum * x + static_cast<double>(k) * coefficients[k];
    return sum;
  }
};

/// How Young's modulus and Poisson's ratio of an equivalent continuous domain follow from its beams' radius ratio r_mu.
///
/// E_a = E_M / E_mu = r_mu^2 P(r_mu),   nu_M = Q(r_mu)                                  [L17] section 2.4, figure 7
///
/// E_mu does not matter beyond its being the unit of stress; r_mu^2, the section of a beam, is what E_a follows first,
/// so that P is nearly straight. A chart belongs to one kind of packing, coordination number and microscopic Poisson's
/// ratio.
struct CalibrationChart {
  std::string name = {}; ///< the packing in words, one line
  std::string ecd =
      {}; ///< everything the chart depends on, one `name = value` a line; what a kept chart is recognised by
  double coordination = 0;                      ///< Z
  double micro_poissons_ratio = 0;              ///< nu_mu, sets G_mu
  std::uint32_t particles = 0;                  ///< of a packing measured
  std::uint32_t packings = 0;                   ///< measured
  double smallest_ratio = 0, largest_ratio = 0; ///< range of r_mu
  Polynomial modulus = {};                      ///< P
  Polynomial poissons_ratio = {};               ///< Q
  /// Root mean square over r_mu of what the polynomials miss of the packings' mean: of E_a relative, of nu absolute.
  double modulus_residual = 0, poissons_residual = 0;
  /// Standard deviation between packings of `particles` at equal r_mu: of E_a relative, of nu absolute. NaN for one
  /// packing.
  double modulus_scatter = 0, poissons_scatter = 0;
  double scatter_correlation = 0; ///< of the two, -1 to 1

  /// E_a at r_mu.
  double relative_modulus(double r) const { return r * r * modulus(r); }
  /// d ln E_a / d r_mu
  double relative_modulus_slope(double r) const { return 2 / r + modulus.slope(r) / modulus(r); }

  /// @throws core::InvalidInput naming what is wrong: a range outside ]0, 1], polynomials without coefficients or with
  ///         some that are not finite, an E_a that is not positive and rising or a nu that does not fall with r_mu
  void validate() const {
    core::expect(smallest_ratio > 0 && smallest_ratio < largest_ratio && largest_ratio <= 1,
                 "range of r_mu of the chart",
                 core::to_text(smallest_ratio) + " to " + core::to_text(largest_ratio),
                 "a range in ]0, 1] is expected");
    for (const auto* polynomial : {&modulus, &poissons_ratio}) {
      core::expect(!polynomial->coefficients.empty(), "number of coefficients of the chart", 0,
                   "1 or more is expected");
      for (const double c : polynomial->coefficients)
        core::expect_finite(c, "a coefficient of the chart");
    }
    core::expect_positive(coordination, "coordination number of the chart");
    core::expect(packings > 0, "number of packings of the chart", packings, "1 or more is expected");
    core::expect_not_negative(modulus_residual, "residual of E_a of the chart");
    core::expect_not_negative(poissons_residual, "residual of nu of the chart");
    constexpr int steps = 1000;
    for (int step = 0; step <= steps; ++step) {
      const double r = smallest_ratio + (largest_ratio - smallest_ratio) * step / steps;
      if (!(modulus(r) > 0 && relative_modulus_slope(r) > 0 && poissons_ratio.slope(r) < 0)) [[unlikely]]
        reject(r);
    }
  }

private:
  /// Names what is wrong at r_mu.
  [[noreturn]] void reject(double r) const {
    const std::string at = " of the chart at r_mu = " + core::to_text(r);
    core::expect(modulus(r) > 0, "E_a" + at, relative_modulus(r), "a modulus above 0 is expected");
    core::expect(relative_modulus_slope(r) > 0, "slope of ln E_a" + at, relative_modulus_slope(r),
                 "a modulus that rises with r_mu is expected");
    core::reject("slope of nu" + at, poissons_ratio.slope(r),
                 "a Poisson's ratio that falls with r_mu is expected: only then it can be inverted");
  }
};

/// What a material is to have.
struct TargetModuli {
  double youngs_modulus = 0; ///< E_M, Pa
  double poissons_ratio = 0; ///< nu_M
};

/// Micro parameters of the beams, with what is known of their uncertainty: standard deviations for a packing that the
/// chart has not seen, of the chart's size. They fall as 1/sqrt(particles). NaN where the chart is of one packing.
struct MicroParameters {
  double youngs_modulus = 0;           ///< E_mu, Pa
  double radius_ratio = 0;             ///< r_mu
  double micro_poissons_ratio = 0;     ///< nu_mu of the chart
  double youngs_modulus_deviation = 0; ///< of E_mu that such a packing would need, relative
  double radius_ratio_deviation = 0;   ///< of r_mu that such a packing would need
  double macro_modulus_deviation = 0;  ///< of the E_M that such a packing will have, relative
  double macro_poissons_deviation = 0; ///< of its nu_M

  /// For a bond law.
  bond::Material material() const { return {youngs_modulus, radius_ratio, micro_poissons_ratio}; }
};

/// Micro parameters that give a material its moduli: nu_M fixes r_mu, then E_mu = E_M / E_a(r_mu).
///
///     MicroParameters calibrated = calibrate({.youngs_modulus = 350e9, .poissons_ratio = 0.24}, chart);
///
/// Deviations d_E (relative) of E_a and d_nu of nu from the chart move r_mu by -d_nu/nu' and ln E_mu by
/// (ln E_a)' d_nu/nu' - d_E. Their variances are the scatter between packings, (1 + 1/packings) times, and the residual
/// of the polynomials.
/// @throws core::InvalidInput for a chart that is not valid, E_M not positive, nu_M out of the chart's reach (names the
///         range)
/// @complexity O(1)
inline MicroParameters calibrate(const TargetModuli& wanted, const CalibrationChart& chart) {
  chart.validate();
  core::expect_positive(wanted.youngs_modulus, "Young's modulus to calibrate for", "Pa");
  const double highest = chart.poissons_ratio(chart.smallest_ratio),
               lowest = chart.poissons_ratio(chart.largest_ratio);
  core::expect(wanted.poissons_ratio >= lowest && wanted.poissons_ratio <= highest,
               "Poisson's ratio to calibrate for", wanted.poissons_ratio,
               core::to_text(lowest) + " (r_mu = " + core::to_text(chart.largest_ratio) + ") to " +
                   core::to_text(highest) + " (r_mu = " + core::to_text(chart.smallest_ratio) +
                   ") is within reach of this packing");
  double low = chart.smallest_ratio, high = chart.largest_ratio;
  for (int halving = 0; halving < 100; ++halving) {
    const double middle = 0.5 * (low + high);
    (chart.poissons_ratio(middle) > wanted.poissons_ratio ? low : high) = middle;
  }
  MicroParameters found;
  found.radius_ratio = 0.5 * (low + high);
  found.youngs_modulus = wanted.youngs_modulus / chart.relative_modulus(found.radius_ratio);
  found.micro_poissons_ratio = chart.micro_poissons_ratio;

  const double unseen = 1 + 1.0 / chart.packings;
  const double modulus_variance = unseen * chart.modulus_scatter * chart.modulus_scatter +
                                  chart.modulus_residual * chart.modulus_residual;
  const double poissons_variance = unseen * chart.poissons_scatter * chart.poissons_scatter +
                                   chart.poissons_residual * chart.poissons_residual;
  const double covariance =
      unseen * chart.scatter_correlation * chart.modulus_scatter * chart.poissons_scatter;
  const double slope = chart.poissons_ratio.slope(found.radius_ratio);
  const double lever = chart.relative_modulus_slope(found.radius_ratio) / slope; // d ln E_a / d nu
  found.radius_ratio_deviation = std::sqrt(poissons_variance) / std::abs(slope);
  found.youngs_modulus_deviation =
      std::sqrt(modulus_variance + lever * lever * poissons_variance - 2 * lever * covariance);
  found.macro_modulus_deviation = std::sqrt(modulus_variance);
  found.macro_poissons_deviation = std::sqrt(poissons_variance);
  return found;
}

} // namespace cdem::homogenize
