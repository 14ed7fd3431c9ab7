#pragma once

/// @file
/// Numbers that carry their derivatives: forward automatic differentiation of small functions.

#include <cdem/core/unrolled.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <type_traits>

namespace cdem::core {

/// A value and its derivatives by `count` variables. Functions written for any Real take it as their Real.
///
/// Exact to rounding (chain rule, no difference quotient). Dual<Dual<double, n>, n> carries second derivatives.
/// Comparisons look at the value alone, so that a branch is differentiated on the side that is taken.
/// Beside + - * / and comparisons: sqrt, exp, log, log1p, expm1, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh,
/// pow, abs, min, max, hypot; find them without a namespace (`using std::sqrt;` is not needed, nor does it harm).
/// @complexity  a product costs 2 count + 1 products of Real
template <class Real, std::size_t count>
struct Dual {
  Real value{};
  Real derivative[count] = {};

  Dual() = default;
  /// A constant.
  template <class Number>
  requires std::is_arithmetic_v<Number> Dual(Number constant) : value(static_cast<double>(constant)) {}
  /// A constant of the underlying numbers.
  Dual(const Real& constant) requires(!std::is_arithmetic_v<Real>) : value(constant) {}

  /// Variable number `index` of the function.
  static Dual variable(const Real& value, std::size_t index) {
    Dual x;
    x.value = value;
    x.derivative[index] = Real(1);
    return x;
  }

  /// f(x) from f and f' at the value: the chain rule.
  static Dual chain(const Dual& x, const Real& f, const Real& slope) {
    Dual y;
    y.value = f;
    unrolled<count>([&](std::size_t k)
                        __attribute__((always_inline)) { y.derivative[k] = slope * x.derivative[k]; });
    return y;
  }

  Dual& operator+=(const Dual& other) {
    value += other.value;
    unrolled<count>([&](std::size_t k)
                        __attribute__((always_inline)) { derivative[k] += other.derivative[k]; });
    return *this;
  }
  Dual& operator-=(const Dual& other) {
    value -= other.value;
    unrolled<count>([&](std::size_t k)
                        __attribute__((always_inline)) { derivative[k] -= other.derivative[k]; });
    return *this;
  }
  Dual& operator*=(const Dual& other) { return *this = *this * other; }
  Dual& operator/=(const Dual& other) { return *this = *this / other; }

  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator+(const Dual& a) { return a; }
  friend Dual operator-(const Dual& a) { return chain(a, -a.value, Real(-1)); }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual y;
    y.value = a.value * b.value;
    unrolled<count>([&](std::size_t k) __attribute__((always_inline)) {
      y.derivative[k] = a.value * b.derivative[k] + b.value * a.derivative[k];
    });
    return y;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual y;
    const Real inverse = Real(1) / b.value;
    y.value = a.value * inverse;
    unrolled<count>([&](std::size_t k) __attribute__((always_inline)) {
      y.derivative[k] = (a.derivative[k] - y.value * b.derivative[k]) * inverse;
    });
    return y;
  }

  // Numbers need no derivatives of their own.
  template <class Number>
  requires std::is_arithmetic_v<Number>
  friend Dual operator*(const Dual& a, Number b) {
    const Real factor(static_cast<double>(b));
    return chain(a, a.value * factor, factor);
  }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  friend Dual operator*(Number a, const Dual& b) { return b * a; }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  friend Dual operator/(const Dual& a, Number b) { return a * (1.0 / static_cast<double>(b)); }

  friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }

  friend Dual sqrt(const Dual& x) {
    using std::sqrt;
    const Real root = sqrt(x.value);
    return chain(x, root, Real(0.5) / root);
  }
  friend Dual exp(const Dual& x) {
    using std::exp;
    const Real f = exp(x.value);
    return chain(x, f, f);
  }
  friend Dual expm1(const Dual& x) {
    using std::exp;
    using std::expm1;
    return chain(x, expm1(x.value), exp(x.value));
  }
  friend Dual log(const Dual& x) {
    using std::log;
    return chain(x, log(x.value), Real(1) / x.value);
  }
  friend Dual log1p(const Dual& x) {
    using std::log1p;
    return chain(x, log1p(x.value), Real(1) / (Real(1) + x.value));
  }
  friend Dual sin(const Dual& x) {
    using std::cos;
    using std::sin;
    return chain(x, sin(x.value), cos(x.value));
  }
  friend Dual cos(const Dual& x) {
    using std::cos;
    using std::sin;
    return chain(x, cos(x.value), -sin(x.value));
  }
  friend Dual tan(const Dual& x) {
    using std::tan;
    const Real f = tan(x.value);
    return chain(x, f, Real(1) + f * f);
  }
  friend Dual asin(const Dual& x) {
    using std::asin;
    using std::sqrt;
    return chain(x, asin(x.value), Real(1) / sqrt(Real(1) - x.value * x.value));
  }
  friend Dual acos(const Dual& x) {
    using std::acos;
    using std::sqrt;
    return chain(x, acos(x.value), Real(-1) / sqrt(Real(1) - x.value * x.value));
  }
  friend Dual atan(const Dual& x) {
    using std::atan;
    return chain(x, atan(x.value), Real(1) / (Real(1) + x.value * x.value));
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    using std::atan2;
    const Real inverse = Real(1) / (x.value * x.value + y.value * y.value);
    return chain(y, atan2(y.value, x.value), x.value * inverse) - chain(x, Real(0), y.value * inverse);
  }
  friend Dual sinh(const Dual& x) {
    using std::cosh;
    using std::sinh;
    return chain(x, sinh(x.value), cosh(x.value));
  }
  friend Dual cosh(const Dual& x) {
    using std::cosh;
    using std::sinh;
    return chain(x, cosh(x.value), sinh(x.value));
  }
  friend Dual tanh(const Dual& x) {
    using std::tanh;
    const Real f = tanh(x.value);
    return chain(x, f, Real(1) - f * f);
  }
  friend Dual pow(const Dual& x, double exponent) {
    using std::pow;
    return chain(x, pow(x.value, exponent), Real(exponent) * pow(x.value, exponent - 1));
  }
  friend Dual abs(const Dual& x) { return x.value < Real(0) ? -x : x; }
  friend Dual min(const Dual& a, const Dual& b) { return b.value < a.value ? b : a; }
  friend Dual max(const Dual& a, const Dual& b) { return a.value < b.value ? b : a; }
  friend Dual hypot(const Dual& a, const Dual& b) { return sqrt(a * a + b * b); }
};

} // namespace cdem::core
