#include <cdem/core/dual.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <string>

namespace {

using cdem::core::Dual;
using One = Dual<double, 1>;
using Two = Dual<double, 2>;

/// A function of one variable with its two derivatives, written by hand.
struct Known {
  std::string name;
  double at;
  Dual<One, 1> found;
  double value, slope, curvature;
};

/// `function` at `x`, with first and second derivative.
template <class Function>
Dual<One, 1> twice(double x, Function&& function) {
  return function(Dual<One, 1>::variable(One::variable(x, 0), 0));
}

} // namespace

TEST_CASE("functions carry the derivatives of the textbook, the second included") {
  const double x = 0.37, root = std::sqrt(1 - x * x);
  const auto of = [&](auto&& function) { return twice(x, function); };
  const Known list[] = {
      {"sqrt", x, of([](auto a) { return sqrt(a); }), std::sqrt(x), 0.5 / std::sqrt(x),
       -0.25 * std::pow(x, -1.5)},
      {"exp", x, of([](auto a) { return exp(a); }), std::exp(x), std::exp(x), std::exp(x)},
      {"expm1", x, of([](auto a) { return expm1(a); }), std::expm1(x), std::exp(x), std::exp(x)},
      {"log", x, of([](auto a) { return log(a); }), std::log(x), 1 / x, -1 / (x * x)},
      {"log1p", x, of([](auto a) { return log1p(a); }), std::log1p(x), 1 / (1 + x), -1 / ((1 + x) * (1 + x))},
      {"sin", x, of([](auto a) { return sin(a); }), std::sin(x), std::cos(x), -std::sin(x)},
      {"cos", x, of([](auto a) { return cos(a); }), std::cos(x), -std::sin(x), -std::cos(x)},
      {"tan", x, of([](auto a) { return tan(a); }), std::tan(x), 1 / std::pow(std::cos(x), 2),
       2 * std::tan(x) / std::pow(std::cos(x), 2)},
      {"asin", x, of([](auto a) { return asin(a); }), std::asin(x), 1 / root, x / std::pow(root, 3)},
      {"acos", x, of([](auto a) { return acos(a); }), std::acos(x), -1 / root, -x / std::pow(root, 3)},
      {"atan", x, of([](auto a) { return atan(a); }), std::atan(x), 1 / (1 + x * x),
       -2 * x / std::pow(1 + x * x, 2)},
      {"sinh", x, of([](auto a) { return sinh(a); }), std::sinh(x), std::cosh(x), std::sinh(x)},
      {"cosh", x, of([](auto a) { return cosh(a); }), std::cosh(x), std::sinh(x), std::cosh(x)},
      {"tanh", x, of([](auto a) { return tanh(a); }), std::tanh(x), 1 / std::pow(std::cosh(x), 2),
       -2 * std::tanh(x) / std::pow(std::cosh(x), 2)},
      {"pow", x, of([](auto a) { return pow(a, 2.5); }), std::pow(x, 2.5), 2.5 * std::pow(x, 1.5),
       3.75 * std::sqrt(x)},
      {"1/x", x, of([](auto a) { return 1 / a; }), 1 / x, -1 / (x * x), 2 / (x * x * x)},
      {"x*x*x", x, of([](auto a) { return a * a * a; }), x * x * x, 3 * x * x, 6 * x},
      {"quotient", x, of([](auto a) { return a / (1 + a); }), x / (1 + x), std::pow(1 + x, -2),
       -2 * std::pow(1 + x, -3)},
      {"abs", x, of([](auto a) { return abs(-a); }), x, 1, 0},
      {"numbers", x, of([](auto a) { return 3 * a - a / 2 + 1 - a * 0.5f; }), 2 * x + 1, 2, 0},
  };
  for (const Known& known : list) {
    CAPTURE(known.name);
    CHECK(known.found.value.value == doctest::Approx(known.value).epsilon(1e-14));
    CHECK(known.found.value.derivative[0] == doctest::Approx(known.slope).epsilon(1e-13));
    CHECK(known.found.derivative[0].value == doctest::Approx(known.slope).epsilon(1e-13));
    CHECK(known.found.derivative[0].derivative[0] == doctest::Approx(known.curvature).epsilon(1e-13));
  }
}

TEST_CASE("functions of two variables carry both partial derivatives") {
  const double x = 0.6, y = -0.8;
  const Two a = Two::variable(x, 0), b = Two::variable(y, 1);
  const Two angle = atan2(b, a), distance = hypot(a, b);
  CHECK(angle.value == std::atan2(y, x));
  CHECK(angle.derivative[0] == doctest::Approx(0.8).epsilon(1e-14)); // -y/r^2, r = 1
  CHECK(angle.derivative[1] == doctest::Approx(0.6).epsilon(1e-14));
  CHECK(distance.derivative[0] == doctest::Approx(0.6).epsilon(1e-14));
  CHECK(distance.derivative[1] == doctest::Approx(-0.8).epsilon(1e-14));
  Two all = a * b;
  all += a;
  all -= 2 * b;
  all *= a;
  all /= b;
  CHECK(all.value == doctest::Approx((x * y + x - 2 * y) * x / y).epsilon(1e-14));
  CHECK(all.derivative[0] == doctest::Approx((2 * x * y + 2 * x - 2 * y) / y).epsilon(1e-14));
  CHECK(all.derivative[1] == doctest::Approx(-x * x / (y * y)).epsilon(1e-14));
}

TEST_CASE("a branch is differentiated on the side that is taken") {
  const Two a = Two::variable(1, 0), b = Two::variable(2, 1);
  CHECK(max(a, b).derivative[1] == 1);
  CHECK(max(a, b).derivative[0] == 0);
  CHECK(min(a, b).derivative[0] == 1);
  CHECK((a < b && b > a && a <= b && b >= a && !(a == b) && a < 1.5));
  const auto kinked = [](auto z) { return z < 0 ? 5 * z : z * z; };
  CHECK(kinked(Two::variable(-1, 0)).derivative[0] == 5);
  CHECK(kinked(Two::variable(3, 0)).derivative[0] == 6);
}
