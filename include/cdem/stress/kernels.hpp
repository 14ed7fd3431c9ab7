#pragma once

/// @file
/// What coarse graining smears with: a density around a point, and its integrals along straight lines.

#include <cdem/core/error.hpp>

#include <cmath>
#include <concepts>
#include <numbers>

namespace cdem::stress {

/// `kernel.reach()`: the distance, m, from which on it is 0.
template <class K>
concept HasReach = requires(const K& kernel) {
  { kernel.reach() } -> std::same_as<double>;
};

/// `kernel.density(distance)`: phi, 1/m^3, of integral 1 over space; asked for below the reach.
template <class K>
concept GivesDensity = requires(const K& kernel, double distance) {
  { kernel.density(distance) } -> std::same_as<double>;
};

/// `kernel.integral(begin, end, square)` and `kernel.first_moment(begin, end, square)`: the integrals of phi dt (1/m^2) and
/// t phi dt (1/m) along a line that passes the centre at the distance b, square = b^2; t is measured from the place nearest to the
/// centre, and begin <= end lie within the reach.
template <class K>
concept IntegratesAlongLines = requires(const K& kernel, double begin, double end, double square) {
  { kernel.integral(begin, end, square) } -> std::same_as<double>;
  { kernel.first_moment(begin, end, square) } -> std::same_as<double>;
};

/// A kernel of coarse graining. Models: Lucy, Gaussian.
template <class K>
concept SmoothingKernel = HasReach<K> && GivesDensity<K> && IntegratesAlongLines<K>;

/// Lucy's polynomial, twice continuously differentiable, of bounded support.
///
/// phi(r) = 105/(16 pi c^3) (1 + 3 r/c) (1 - r/c)^3 for r < c               Lucy 1977
///
/// Its standard deviation along an axis is c/sqrt(12). Line integrals are in closed form.
class Lucy {
public:
  /// @param radius  c, m
  /// @throws core::InvalidInput unless it is a finite number above 0
  explicit Lucy(double radius) : radius_(radius) {
    core::expect_positive(radius, "radius of the kernel", "m");
    height_ = 105 / (16 * std::numbers::pi * radius * radius * radius);
  }

  double reach() const noexcept { return radius_; }
  double density(double distance) const {
    const double x = distance / radius_, rest = 1 - x;
    return height_ * (1 + 3 * x) * rest * rest * rest;
  }
  double integral(double begin, double end, double square) const {
    const double b2 = square / (radius_ * radius_), b4 = b2 * b2;
    const Place from(begin / radius_, b2), to(end / radius_, b2);
    const auto part = [&](const Place& p) { // of 1 - 6 r^2 + 8 r^3 - 3 r^4, its logarithm left out
      const double t2 = p.t * p.t;
      return p.t *
             (1 - b2 * 6 - t2 * 2 + 2 * p.r * (p.r * p.r + 1.5 * b2) - 3 * b4 - t2 * (2 * b2 + 0.6 * t2));
    };
    double sum = part(to) - part(from);
    if (b4 > 1e-30) // below, b^4 log(1/b) is lost in rounding
      sum += 3 * b4 * std::log(to.beyond(b2) / from.beyond(b2));
    return height_ * radius_ * sum;
  }
  double first_moment(double begin, double end, double square) const {
    const double b2 = square / (radius_ * radius_);
    const auto part = [&](double t) {
      const double r2 = t * t + b2;
      return r2 * (0.5 + r2 * (-1.5 + 1.6 * std::sqrt(r2) - 0.5 * r2));
    };
    return height_ * radius_ * radius_ * (part(end / radius_) - part(begin / radius_));
  }
  /// (integral of phi)^2 / integral of phi^2 = 176 pi c^3/455, m^3: the volume of the cell whose average scatters alike in a field
  /// without correlations, such as the stress of many more bonds than one.
  double effective_volume() const noexcept {
    return 176 * std::numbers::pi / 455 * radius_ * radius_ * radius_;
  }
  /// The kernel of an effective volume, m^3.
  /// @throws core::InvalidInput unless it is a finite number above 0
  static Lucy of_volume(double volume) {
    core::expect_positive(volume, "effective volume of the kernel", "m^3");
    return Lucy(std::cbrt(455 * volume / (176 * std::numbers::pi)));
  }

private:
  struct Place {
    double t, r;
    Place(double along, double b2) : t(along), r(std::sqrt(along * along + b2)) {}
    double beyond(double b2) const { return t >= 0 ? t + r : b2 / (r - t); } ///< b exp(asinh(t/b))
  };

  double radius_, height_;
};

/// Gaussian, cut off where it is negligible and scaled so that its integral is 1.
///
/// phi(r) = exp(-r^2/(2 w^2)) / ((2 pi)^(3/2) w^3) for r < k w                   Goldhirsch 2010
///
/// At the cut-off of k = 5 it has fallen to 3.7e-6 of its height and leaves 1.5e-5 of its integral outside. Line integrals are in
/// closed form (error functions).
class Gaussian {
public:
  /// @param width   w, the standard deviation along an axis, m
  /// @param cutoff  k, in widths: 1 or more; the effort grows with its cube
  /// @throws core::InvalidInput for a width that is not a finite number above 0, or another cut-off
  explicit Gaussian(double width, double cutoff = 5) : width_(width), cutoff_(cutoff) {
    core::expect_positive(width, "width of the kernel", "m");
    core::expect(std::isfinite(cutoff) && cutoff >= 1, "cut-off of the kernel", cutoff,
                 "a finite number of widths, 1 or more, is expected");
    const double inside = std::erf(cutoff / std::numbers::sqrt2) -
                          std::sqrt(2 / std::numbers::pi) * cutoff * std::exp(-0.5 * cutoff * cutoff);
    height_ = 1 / (inside * std::pow(std::sqrt(2 * std::numbers::pi) * width, 3));
  }

  double reach() const noexcept { return cutoff_ * width_; }
  double density(double distance) const { return height_ * bell(distance * distance); }
  double integral(double begin, double end, double square) const {
    const double scale = 1 / (std::numbers::sqrt2 * width_);
    return height_ * bell(square) * std::sqrt(std::numbers::pi / 2) * width_ *
           (std::erf(end * scale) - std::erf(begin * scale));
  }
  double first_moment(double begin, double end, double square) const {
    return height_ * bell(square) * width_ * width_ * (bell(begin * begin) - bell(end * end));
  }
  /// (integral of phi)^2 / integral of phi^2, m^3, as for Lucy; 8 pi^(3/2) w^3 if nothing is cut off.
  double effective_volume() const {
    const double square =
        std::erf(cutoff_) - 2 / std::sqrt(std::numbers::pi) * cutoff_ * std::exp(-cutoff_ * cutoff_);
    return 1 / (height_ * height_ * square * std::pow(std::sqrt(std::numbers::pi) * width_, 3));
  }
  /// The kernel of an effective volume, m^3.
  /// @throws core::InvalidInput unless it is a finite number above 0, or for a cut-off that is not accepted
  static Gaussian of_volume(double volume, double cutoff = 5) {
    core::expect_positive(volume, "effective volume of the kernel", "m^3");
    return Gaussian(std::cbrt(volume / Gaussian(1, cutoff).effective_volume()), cutoff);
  }

private:
  double bell(double square) const { return std::exp(-0.5 * square / (width_ * width_)); }

  double width_, cutoff_, height_;
};

static_assert(SmoothingKernel<Lucy> && SmoothingKernel<Gaussian>);

} // namespace cdem::stress
