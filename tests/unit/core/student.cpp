#include <cdem/core/student.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

using namespace cdem::core;

TEST_CASE("Student's t: closed forms for few degrees, tables, the normal limit") {
  for (const double t : {0.0, 0.1, 1.0, 7.0}) {
    CHECK(student_probability(t, 1) == doctest::Approx(2 / std::numbers::pi * std::atan(t)).epsilon(1e-14));
    CHECK(student_probability(t, 2) == doctest::Approx(t / std::sqrt(2 + t * t)).epsilon(1e-14));
    const double a = std::atan(t / std::sqrt(3)); // by hand from the density 1/(1 + t^2/3)^2
    CHECK(student_probability(t, 3) ==
          doctest::Approx(2 / std::numbers::pi * (a + std::sin(a) * std::cos(a))).epsilon(1e-14));
    CHECK(student_probability(t, 1000000) ==
          doctest::Approx(std::erf(t / std::numbers::sqrt2)).epsilon(2e-6));
  }
  // R 4.2, qt(0.975, n) and qt(0.75, n)
  CHECK(student_factor(0.95, 1) == doctest::Approx(12.706204736174705).epsilon(1e-12));
  CHECK(student_factor(0.95, 4) == doctest::Approx(2.7764451051977943).epsilon(1e-12));
  CHECK(student_factor(0.95, 7) == doctest::Approx(2.3646242515927849).epsilon(1e-12));
  CHECK(student_factor(0.5, 10) == doctest::Approx(0.69981206131243168).epsilon(1e-12));
  CHECK(student_factor(0.95, 343) == doctest::Approx(1.9669042814875488).epsilon(1e-9));
}

TEST_CASE("the factor is the inverse of the probability") {
  for (const std::uint64_t degrees : {1U, 2U, 5U, 14U, 99U, 5000U})
    for (const double probability : {1e-6, 0.5, 0.9, 0.999999})
      CHECK(student_probability(student_factor(probability, degrees), degrees) ==
            doctest::Approx(probability).epsilon(1e-12));
}

TEST_CASE("bad input is refused by name") {
  for (const double probability : {0.0, 1.0, -0.5, std::nan("")})
    CHECK_THROWS_WITH_AS((void)student_factor(probability, 3), doctest::Contains("probability = "),
                         InvalidInput);
  CHECK_THROWS_WITH_AS((void)student_factor(0.95, 0), doctest::Contains("degrees of freedom = 0"),
                       InvalidInput);
}
