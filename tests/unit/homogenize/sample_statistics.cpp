#include <cdem/homogenize/sample_statistics.hpp>

#include <doctest/doctest.h>

#include <array>
#include <vector>

using namespace cdem;
using namespace cdem::homogenize;

TEST_CASE("mean, deviation and prediction interval by hand") {
  const std::array values{1.0, 2.0, 3.0, 4.0, std::nan("")};
  const auto sample = sample_statistics(values);
  CHECK(sample.count == 4);
  CHECK(sample.mean == doctest::Approx(2.5));
  CHECK(sample.deviation == doctest::Approx(std::sqrt(5.0 / 3)));
  CHECK(sample.standard_error() == doctest::Approx(std::sqrt(5.0 / 12)));
  CHECK(sample.prediction() == doctest::Approx(3.18245 * std::sqrt(5.0 / 3) * std::sqrt(1.25)).epsilon(1e-5));
  CHECK(std::isnan(sample_statistics(std::array{1.0}).prediction()));
  CHECK(sample_statistics(std::vector<double>{}).count == 0);
}

TEST_CASE("a line through exact points, and its error by hand") {
  const std::array x{0.0, 1.0, 2.0}, y{3.0, 5.0, 7.0}, error{0.1, 0.1, 0.1};
  const Line line = fit_line(x, y, error);
  CHECK(line.intercept == doctest::Approx(3));
  CHECK(line.slope == doctest::Approx(2));
  CHECK(line.intercept_error == doctest::Approx(0.1 * std::sqrt(5.0 / 6))); // sum x^2 / (n sum (x - mean)^2)
  const std::array same{1.0, 1.0, 1.0}, none{0.1, 0.0, 0.1};
  CHECK_THROWS_AS(fit_line(same, y, error), core::InvalidInput);
  CHECK_THROWS_AS(fit_line(x, y, none), core::InvalidInput);
}
