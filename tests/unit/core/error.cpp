#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>

using namespace cdem::core;

namespace {
const double not_a_number = std::numeric_limits<double>::quiet_NaN();
const double inf = std::numeric_limits<double>::infinity();
} // namespace

TEST_CASE("a message names the value and what is accepted") {
  CHECK_THROWS_WITH_AS(reject("edge", 3, "an even number is expected"),
                       "edge = 3 is not accepted: an even number is expected", InvalidInput);
  CHECK_THROWS_WITH_AS(expect(false, "axis", 'w', "x, y or z"), "axis = w is not accepted: x, y or z",
                       InvalidInput);
  CHECK_NOTHROW(expect(true, "edge", 4, "an even number is expected"));
}

TEST_CASE("positive numbers") {
  CHECK_NOTHROW(expect_positive(1e-300, "mass", "kg"));
  CHECK_THROWS_WITH_AS(expect_positive(0, "mass", "kg"),
                       "mass = 0 is not accepted: a finite number above 0 kg is expected", InvalidInput);
  CHECK_THROWS_WITH_AS(expect_positive(-2.5, "factor"),
                       "factor = -2.5 is not accepted: a finite number above 0 is expected", InvalidInput);
  CHECK_THROWS_AS(expect_positive(not_a_number, "mass"), InvalidInput);
  CHECK_THROWS_AS(expect_positive(inf, "mass"), InvalidInput);
}

TEST_CASE("numbers that are not negative") {
  CHECK_NOTHROW(expect_not_negative(0, "alpha"));
  CHECK_THROWS_WITH_AS(expect_not_negative(-1, "alpha", "1/s"),
                       "alpha = -1 is not accepted: a finite number, 0 or above, in 1/s is expected",
                       InvalidInput);
  CHECK_THROWS_AS(expect_not_negative(not_a_number, "alpha"), InvalidInput);
  CHECK_THROWS_AS(expect_not_negative(inf, "alpha"), InvalidInput);
}

TEST_CASE("finite numbers") {
  CHECK_NOTHROW(expect_finite(-1e300, "rate"));
  CHECK_THROWS_WITH_AS(expect_finite(not_a_number, "rate"),
                       "rate = nan is not accepted: a finite number is expected", InvalidInput);
  CHECK_THROWS_AS(expect_finite(inf, "rate"), InvalidInput);
  CHECK_THROWS_AS(expect_finite(-inf, "rate"), InvalidInput);
}

TEST_CASE("text of a value") {
  CHECK(to_text(0.1) == "0.1");
  CHECK(to_text(1.23456789012) == "1.23456789012");
  CHECK(to_text(std::uint8_t{65}) == "65"); // a number, not a letter
  CHECK(to_text(std::int8_t{-3}) == "-3");
  CHECK(to_text("text") == "text");
}

TEST_CASE("each error can be caught as what it is") {
  CHECK_THROWS_AS(throw InvalidInput("x"), std::invalid_argument);
  CHECK_THROWS_AS(throw NotReached("x"), std::runtime_error);
  CHECK_THROWS_AS(throw FileError("x"), std::runtime_error);
  CHECK_THROWS_AS(throw Interrupted("x"), std::runtime_error);
}

TEST_CASE("axes") {
  CHECK(index_of(Axis::x) == 0);
  CHECK(index_of(Axis::z) == 2);
  CHECK(name_of(Axis::x) == 'x');
  CHECK(name_of(Axis::y) == 'y');
  CHECK(name_of(Axis::z) == 'z');
}
