#include <cdem/core/random.hpp>
#include <cdem/homogenize/calibration_fit.hpp>
#include <cdem/homogenize/standard_charts.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace cdem;
using homogenize::calibrate;
using homogenize::CalibrationChart;
using homogenize::CalibrationPoint;

namespace {

/// P = 0.1 + 0.9 r - 0.3 r^2 + 0.1 r^3, Q = 0.42 - 0.45 r + 0.1 r^2: near those of real packings.
CalibrationChart exact_chart() {
  CalibrationChart chart;
  chart.name = "made up";
  chart.coordination = 6.2;
  chart.micro_poissons_ratio = 0.3;
  chart.particles = 1000;
  chart.packings = 4;
  chart.smallest_ratio = 0.1;
  chart.largest_ratio = 0.9;
  chart.modulus = {{0.1, 0.9, -0.3, 0.1}};
  chart.poissons_ratio = {{0.42, -0.45, 0.1}};
  return chart;
}

/// What `packings` bodies of that chart would give, with errors of standard deviation `noise` (relative, and a third of it for
/// nu), of each point by itself or common to all points of a packing.
std::vector<CalibrationPoint> sample(int packings, int ratios, double noise, bool common,
                                     std::uint64_t seed) {
  const CalibrationChart chart = exact_chart();
  core::Random random(seed);
  std::vector<CalibrationPoint> points;
  for (int p = 0; p < packings; ++p) {
    double modulus = noise * random.normal(), poissons = noise / 3 * random.normal();
    for (int k = 0; k < ratios; ++k) {
      if (!common)
        modulus = noise * random.normal(), poissons = noise / 3 * random.normal();
      const double r = 0.1 + 0.8 * k / (ratios - 1);
      points.push_back({static_cast<std::uint64_t>(p), r, chart.relative_modulus(r) * (1 + modulus),
                        chart.poissons_ratio(r) + poissons});
    }
  }
  return points;
}

/// Orders by what is left out alone.
constexpr homogenize::FitParameters by_validation{.modulus_tolerance = 0, .poissons_tolerance = 0};

std::string complaint(const homogenize::TargetModuli& wanted, const CalibrationChart& chart = exact_chart()) {
  try {
    calibrate(wanted, chart);
  } catch (const core::InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

} // namespace

TEST_CASE("exact polynomials are recovered, with their orders") {
  const auto fit = homogenize::fit_chart(sample(1, 9, 0, false, 1), {.coordination = 6.2}, by_validation);
  REQUIRE(fit.chart.modulus.order() == 3);
  REQUIRE(fit.chart.poissons_ratio.order() == 2);
  for (std::size_t k = 0; k < 4; ++k)
    CHECK(fit.chart.modulus.coefficients[k] ==
          doctest::Approx(exact_chart().modulus.coefficients[k]).epsilon(1e-11));
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(fit.chart.poissons_ratio.coefficients[k] ==
          doctest::Approx(exact_chart().poissons_ratio.coefficients[k]).epsilon(1e-11));
  CHECK(fit.chart.modulus_residual < 1e-14);
  CHECK(fit.chart.smallest_ratio == 0.1);
  CHECK(fit.chart.largest_ratio == 0.9);
  CHECK(std::isnan(fit.chart.modulus_scatter)); // one packing tells nothing of it
}

TEST_CASE("under noise cross-validation takes the true orders, and scatter is what was put in") {
  int modulus_right = 0, poissons_right = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto fit =
        homogenize::fit_chart(sample(5, 17, 1e-3, false, seed), {.coordination = 6.2}, by_validation);
    modulus_right += fit.chart.modulus.order() == 3;
    poissons_right += fit.chart.poissons_ratio.order() == 2;
    CHECK(fit.chart.modulus_scatter == doctest::Approx(1e-3).epsilon(0.35));
    CHECK(fit.chart.poissons_scatter == doctest::Approx(1e-3 / 3).epsilon(0.35));
    CHECK(std::abs(fit.chart.scatter_correlation) < 0.5);
    CHECK(fit.modulus.error[0] > 5 * fit.modulus.error[2]);
  }
  CHECK(modulus_right >= 17);
  CHECK(poissons_right >= 17);
}

TEST_CASE("a tolerance takes the lowest order that meets it") {
  const auto points = sample(1, 9, 0, false, 1);
  const auto low = homogenize::fit_chart(points, {.coordination = 6.2},
                                         {.modulus_tolerance = 0.05, .poissons_tolerance = 0.02});
  CHECK(low.chart.modulus.order() < 3);
  CHECK(low.chart.poissons_ratio.order() == 1);
  CHECK(low.modulus.error[static_cast<std::size_t>(low.modulus.order - 1)] <= 0.05);
  CHECK(low.chart.modulus_residual > 1e-6);
}

TEST_CASE("what is common to all points of a packing is scatter, and needs no higher order") {
  const auto fit = homogenize::fit_chart(sample(6, 9, 0.01, true, 4), {.coordination = 6.2}, by_validation);
  CHECK(fit.chart.modulus.order() <= 3); // what is below a third of the scatter is not followed
  CHECK(fit.chart.modulus_residual < 5e-3);
  CHECK(fit.chart.modulus_scatter > 0.004);
  CHECK(fit.chart.modulus_scatter < 0.02);
}

TEST_CASE("inverted moduli give back the moduli") {
  const CalibrationChart chart = exact_chart();
  for (const double r : {0.1, 0.169, 0.545, 0.722, 0.9}) {
    const homogenize::TargetModuli wanted{.youngs_modulus = 123e9 * chart.relative_modulus(r),
                                          .poissons_ratio = chart.poissons_ratio(r)};
    const auto found = calibrate(wanted, chart);
    CHECK(found.radius_ratio == doctest::Approx(r).epsilon(1e-12));
    CHECK(found.youngs_modulus == doctest::Approx(123e9).epsilon(1e-11));
    CHECK(found.material().poissons_ratio == 0.3);
  }
}

TEST_CASE("the uncertainty is the scatter of what packings of that kind would need") {
  CalibrationChart chart = exact_chart();
  chart.packings = 1000000; // the mean is known
  chart.modulus_scatter = 0.01;
  chart.poissons_scatter = 0.002;
  chart.scatter_correlation = -0.6;
  const homogenize::TargetModuli wanted{350e9, 0.24};
  const auto expected = calibrate(wanted, chart);
  core::Random random(7);
  double modulus_square = 0, ratio_square = 0;
  constexpr int count = 4000;
  for (int i = 0; i < count; ++i) { // one packing after the other, each with a chart of its own
    const double a = random.normal(), b = -0.6 * a + 0.8 * random.normal();
    CalibrationChart own = exact_chart();
    for (double& c : own.modulus.coefficients)
      c *= 1 + 0.01 * a;
    own.poissons_ratio.coefficients[0] += 0.002 * b;
    const auto needed = calibrate(wanted, own);
    const double m = std::log(needed.youngs_modulus / expected.youngs_modulus),
                 r = needed.radius_ratio - expected.radius_ratio;
    modulus_square += m * m;
    ratio_square += r * r;
  }
  CHECK(std::sqrt(modulus_square / count) ==
        doctest::Approx(expected.youngs_modulus_deviation).epsilon(0.05)); // 4.5 standard errors
  CHECK(std::sqrt(ratio_square / count) ==
        doctest::Approx(expected.radius_ratio_deviation).epsilon(0.05)); // 4.5 standard errors
  CHECK(expected.macro_modulus_deviation == doctest::Approx(0.01).epsilon(1e-5));
  CHECK(expected.macro_poissons_deviation == doctest::Approx(0.002).epsilon(1e-5));
}

TEST_CASE("the shipped charts hold, and know the three materials of [L17] and the limits of each other") {
  for (const CalibrationChart& chart : {homogenize::standard_charts::unequal_spheres(),
                                        homogenize::standard_charts::nearly_equal_spheres()}) {
    CAPTURE(chart.name);
    CHECK_NOTHROW(chart.validate());
    CHECK(chart.coordination == 6.2);
    CHECK(chart.particles == 100000);
    CHECK(chart.packings == 5);
    CHECK(chart.modulus_residual < 5e-4);
    CHECK(chart.poissons_residual < 2e-4);
    for (const homogenize::TargetModuli& wanted :
         {homogenize::TargetModuli{350e9, 0.24}, {65e9, 0.20}, {72.5e9, 0.33}}) {
      const auto found = calibrate(wanted, chart);
      CHECK(found.youngs_modulus_deviation < 0.02);
      CHECK(found.radius_ratio_deviation < 0.005);
    }
    CHECK_THROWS_AS(calibrate({350e9, 0.45}, chart), core::InvalidInput);
  }
}

TEST_CASE("what cannot be reached is refused, naming the range") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(complaint({350e9, 0.24}) == "accepted");
  CHECK(complaint({350e9, 0.45}) ==
        "Poisson's ratio to calibrate for = 0.45 is not accepted: 0.096 (r_mu = 0.9) to "
        "0.376 (r_mu = 0.1) is within reach of this packing");
  CHECK(complaint({350e9, 0.09}).find("Poisson's ratio to calibrate for = 0.09") == 0);
  CHECK(complaint({350e9, nan}).find("Poisson's ratio to calibrate for = nan") == 0);
  for (const double modulus : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()})
    CHECK(complaint({modulus, 0.24}).find("Young's modulus to calibrate for = ") == 0);

  const auto bad = [](auto change) {
    CalibrationChart chart = exact_chart();
    change(chart);
    return complaint({350e9, 0.24}, chart);
  };
  CHECK(bad([](auto& c) {
          c.poissons_ratio = {{0.3, -0.3, 0.3}};
        }).find("slope of nu of the chart at r_mu = 0.5") == 0); // rises from 0.5 on
  CHECK(bad([](auto& c) { c.modulus = {{0.1, -0.2}}; }).find("slope of ln E_a of the chart") == 0);
  CHECK(bad([](auto& c) {
          c.modulus.coefficients.clear();
        }).find("number of coefficients of the chart = 0") == 0);
  CHECK(bad([](auto& c) { c.modulus.coefficients[1] = NAN; }).find("a coefficient of the chart = nan") == 0);
  CHECK(bad([](auto& c) { c.largest_ratio = 1.1; }).find("range of r_mu of the chart = 0.1 to 1.1") == 0);
  CHECK(bad([](auto& c) { c.packings = 0; }).find("number of packings of the chart = 0") == 0);
}

TEST_CASE("points that make no chart are refused") {
  const auto refused = [](auto change) {
    auto points = sample(2, 9, 1e-3, false, 1);
    change(points);
    try {
      homogenize::fit_chart(points, {.coordination = 6.2});
    } catch (const core::InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK(refused([](auto&) {}) == "accepted");
  CHECK(refused([](auto& p) { p.resize(3); }).find("number of different r_mu to calibrate with = 3") == 0);
  CHECK(refused([](auto& p) { p.pop_back(); }).find("number of packings at r_mu = 0.9 = 1") == 0);
  CHECK(refused([](auto& p) { p.push_back(p[0]); }).find("packing measured twice at r_mu = 0.1 = 0") == 0);
  CHECK(refused([](auto& p) { p[2].relative_modulus = 0; }).find("E_a of a calibration point = 0") == 0);
  CHECK(refused([](auto& p) { p[2].poissons_ratio = NAN; }).find("nu of a calibration point = nan") == 0);
  CHECK(refused([](auto& p) { p[2].radius_ratio = NAN; }).find("r_mu of a calibration point = nan") == 0);
  CHECK_THROWS_AS(homogenize::fit_chart({}, {}), core::InvalidInput);
  CHECK_THROWS_AS(
      homogenize::fit_chart(sample(2, 9, 0, false, 1), {.coordination = 6.2}, {.highest_order = 0}),
      core::InvalidInput);
}
