// Moments and tests of samples: exact sets, published values, and the tests' own rates of error on random samples.

#include <cdem/stress/distribution.hpp>

#include <doctest/doctest.h>

#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using sample::contains;
using sample::not_a_number;
using sample::refusal;
using stress::SampleMoments;

/// Weights in g of 20 chicks of 21 days, Bliss 1967, on which D'Agostino and Stephens (1986) show their tests.
const std::vector<double> chicks{156, 162, 168, 182, 186, 190, 190, 196, 202, 210,
                                 214, 220, 226, 230, 230, 236, 236, 242, 246, 270};

std::vector<double> normal_sample(core::Random& random, std::size_t count, double mean = 0,
                                  double deviation = 1) {
  std::vector<double> values(count);
  for (double& value : values)
    value = mean + deviation * random.normal();
  return values;
}

std::vector<double> exponentials(std::vector<double> values) {
  for (double& value : values)
    value = std::exp(value);
  return values;
}

TEST_CASE("moments of sets that can be done by hand") {
  const SampleMoments one = stress::sample_moments(std::vector<double>{0, 0, 0, 1});
  CHECK(one.count == 4);
  CHECK(one.mean == 0.25);
  CHECK(one.standard_deviation == doctest::Approx(0.5));
  CHECK(one.skewness == doctest::Approx(2));        // g1 = 2/sqrt(3)
  CHECK(one.excess_kurtosis == doctest::Approx(4)); // g2 = -2/3
  CHECK(one.coefficient_of_variation() == doctest::Approx(2));
  const SampleMoments even = stress::sample_moments(std::vector<double>{1, 2, 3, 4, 5});
  CHECK(even.mean == doctest::Approx(3));
  CHECK(even.standard_deviation == doctest::Approx(std::sqrt(2.5)));
  CHECK(std::abs(even.skewness) < 1e-15);
  CHECK(even.excess_kurtosis == doctest::Approx(-1.2)); // g2 = 34/20 - 3 = -1.3; (6 (-1.3) + 6) 4/6
  // far from zero nothing is lost
  std::vector<double> shifted{0, 0, 0, 1};
  for (double& value : shifted)
    value += 1e8;
  CHECK(stress::sample_moments(shifted).skewness == doctest::Approx(2).epsilon(1e-7));
}

TEST_CASE("published values: the chicks' weights") {
  const SampleMoments moments = stress::sample_moments(chicks);
  CHECK(moments.mean == doctest::Approx(209.6));
  CHECK(moments.standard_deviation == doctest::Approx(30.65).epsilon(1e-3)); // as printed
  const auto normal = stress::anderson_darling_normal(chicks);
  CHECK(normal.statistic == doctest::Approx(0.214).epsilon(2e-3)); // as printed
  // SciPy 1.10: anderson(), skew(bias=False), kurtosis(bias=False), norm and lognorm.logpdf()
  CHECK(normal.statistic == doctest::Approx(0.21417425823119984).epsilon(1e-12));
  CHECK(stress::anderson_darling_lognormal(chicks).statistic ==
        doctest::Approx(0.2746775788967817).epsilon(1e-12));
  CHECK(moments.skewness == doctest::Approx(-0.04881231857245566).epsilon(1e-12));
  CHECK(moments.excess_kurtosis == doctest::Approx(-0.6585972342331341).epsilon(1e-12));
  const auto likelier = stress::normal_or_lognormal(chicks);
  CHECK(likelier.normal == doctest::Approx(-96.31612221095627).epsilon(1e-12));
  CHECK(likelier.lognormal == doctest::Approx(-96.53618113996617).epsilon(1e-12));
  CHECK(likelier.score == doctest::Approx(-0.44985913300673575).epsilon(1e-10));
  CHECK(moments.prediction() == doctest::Approx(2.093024054408263 * 30.646370095004727 * std::sqrt(1.05)));
}

TEST_CASE("critical values of Stephens' table: 0.631, 0.752, 0.873, 1.035 are exceeded by 10, 5, 2.5, 1 %") {
  CHECK(stress::detail::normality_p_value(0.631) == doctest::Approx(0.10).epsilon(0.02));
  CHECK(stress::detail::normality_p_value(0.752) == doctest::Approx(0.05).epsilon(0.02));
  CHECK(stress::detail::normality_p_value(0.873) == doctest::Approx(0.025).epsilon(0.02));
  CHECK(stress::detail::normality_p_value(1.035) == doctest::Approx(0.01).epsilon(0.02));
  double last = 1;
  for (double a = 0.05; a < 12; a += 0.01) {
    const double p = stress::detail::normality_p_value(a);
    CHECK(p < last + 2e-3); // the pieces of the fit meet within that
    CHECK(p > 0);
    last = p;
  }
}

TEST_CASE("errors of the first kind are as rare as the test says, standard errors as wide") {
  core::Random random(1);
  const int trials = 4000;
  for (const std::size_t count : {20U, 100U}) {
    int refused = 0, refused_logs = 0, likelier = 0, outside = 0;
    double skewness = 0, kurtosis = 0, cov = 0, cov_squares = 0, cov_error = 0;
    for (int k = 0; k < trials; ++k) {
      const auto values = normal_sample(random, count, 10, 1);
      refused += stress::anderson_darling_normal(values).p_value < 0.05;
      refused_logs += stress::anderson_darling_lognormal(exponentials(values)).p_value < 0.05;
      const SampleMoments moments = stress::sample_moments(values);
      skewness += moments.skewness * moments.skewness / trials;
      kurtosis += moments.excess_kurtosis * moments.excess_kurtosis / trials;
      cov += moments.coefficient_of_variation() / trials;
      cov_squares += std::pow(moments.coefficient_of_variation(), 2) / trials;
      cov_error += moments.coefficient_error() / trials;
      likelier += stress::normal_or_lognormal(values).in_favour_of_lognormal() > 0;
      outside += std::abs(10 + random.normal() - moments.mean) > moments.prediction();
    }
    const double three_sigma = 3 * std::sqrt(0.05 * 0.95 / trials);
    CHECK(std::abs(refused / double(trials) - 0.05) < three_sigma);
    CHECK(refused_logs == refused); // the same numbers, but for rounding
    CHECK(std::abs(outside / double(trials) - 0.05) < three_sigma);
    const SampleMoments any = stress::sample_moments(normal_sample(random, count));
    CHECK(std::sqrt(skewness) == doctest::Approx(any.skewness_error()).epsilon(0.05));
    CHECK(std::sqrt(kurtosis) == doctest::Approx(any.kurtosis_error()).epsilon(0.08));
    CHECK(std::sqrt(cov_squares - cov * cov) == doctest::Approx(cov_error).epsilon(0.08));
    CHECK(likelier < trials / 2); // normal samples
  }
}

TEST_CASE("a log-normal sample is told from a normal one, and the other way round") {
  core::Random random(2);
  const auto plain = normal_sample(random, 10000, 240, 36); // CoV 15 %
  const auto logarithmic = exponentials(normal_sample(random, 10000, std::log(240.0), 0.15));
  CHECK(stress::anderson_darling_normal(plain).p_value > 0.05);
  CHECK(stress::anderson_darling_lognormal(plain).p_value < 1e-4);
  CHECK(stress::normal_or_lognormal(plain).score < -3);
  CHECK(stress::anderson_darling_lognormal(logarithmic).p_value > 0.05);
  CHECK(stress::anderson_darling_normal(logarithmic).p_value < 1e-4);
  CHECK(stress::normal_or_lognormal(logarithmic).score > 3);
  // a change of unit changes neither the tests nor the comparison
  std::vector<double> pascal(logarithmic);
  for (double& value : pascal)
    value *= 1e6;
  CHECK(stress::normal_or_lognormal(pascal).in_favour_of_lognormal() ==
        doctest::Approx(stress::normal_or_lognormal(logarithmic).in_favour_of_lognormal()).epsilon(1e-6));
  // far tails: the p-value stays where the fit ends
  std::vector<double> outlier(plain);
  outlier.push_back(1e9);
  CHECK(stress::anderson_darling_normal(outlier).p_value == 3.7e-24);
}

TEST_CASE("bad input is refused by name") {
  const auto message = [](auto&& call, std::vector<double> values) {
    return refusal([&] { (void)call(values); });
  };
  const auto moments = [](const auto& v) { return stress::sample_moments(v); };
  const auto test = [](const auto& v) { return stress::anderson_darling_normal(v); };
  const auto logs = [](const auto& v) { return stress::anderson_darling_lognormal(v); };
  const auto compare = [](const auto& v) { return stress::normal_or_lognormal(v); };
  CHECK(contains(message(moments, {1, 2, 3}), "number of values = 3"));
  CHECK(contains(message(moments, {1, 2, 3, not_a_number}), "value = nan"));
  CHECK(contains(message(moments, {7, 7, 7, 7}), "variance of the values = 0"));
  CHECK(contains(message(test, {1, 2, 3, 4, 5, 6, 7}), "number of values = 7"));
  CHECK(contains(message(logs, {1, 2, 3, 4, 5, 6, 7, 0}), "value = 0"));
  CHECK(contains(message(compare, {1, 2, 3, -4}), "value = -4"));
  CHECK(contains(refusal([] { (void)stress::sample_moments(chicks).prediction(1); }), "probability = 1"));
}

} // namespace
