#pragma once

/// @file
/// When a bond breaks: stress criteria of the beam.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/phase_pairs.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>
#include <string>

namespace cdem::bond {

/// `criterion.prepare(geometry, law)` computes once what it needs of a bond under the law.
template <class C, class Law>
concept PreparesFailure = requires(const C& criterion, const BondGeometry& bond, const Law& law) {
  criterion.prepare(bond, law);
};

/// `criterion.exertion(prepared, load)` is the load over what the bond bears: 1 and above breaks it.
template <class C, class Law>
concept ReportsFailure = PreparesFailure<C, Law> &&
    requires(const C& criterion, const BondGeometry& bond, const Law& law, const ChannelLoad<>& load) {
  { criterion.exertion(criterion.prepare(bond, law), load) } -> std::same_as<double>;
};

/// Decides when a bond under `Law` breaks. Models: AxialStress, BendingStress, CombinedStress.
template <class C, class Law = Beam<>>
concept FailureCriterion = std::copy_constructible<C> && ReportsFailure<C, Law>;

namespace detail {

inline constexpr double never = std::numeric_limits<double>::infinity();

/// Circular section of radius a.
struct Section {
  double area;    ///< A = pi a^2, m^2
  double modulus; ///< I/a = pi a^3/4, m^3
  explicit Section(double a) : area(std::numbers::pi * a * a), modulus(0.25 * area * a) {}
};

/// The larger of the bending moments at the two ends, M + (L/2) n x F and M - (L/2) n x F across n, N m.
inline double larger_end_moment(const ChannelLoad<>& load, double half_length) {
  const double t = -half_length * load.tangential.b, b = half_length * load.tangential.t;
  return std::sqrt(load.bending.squared() + t * t + b * b +
                   2 * std::abs(load.bending.t * t + load.bending.b * b));
}

inline void expect_strength(const PhasePairs& strength, const std::string& name) {
  strength.validate(
      name, [](double value) { return value > 0; }, "a number above 0 Pa is expected (infinity: never)");
}

} // namespace detail

/// Breaks by the mean stress along the bond.
///
///     sigma = N/A,  A = pi a^2:  sigma >= tensile_strength or -sigma >= compressive_strength
struct AxialStress {
  PhasePairs tensile_strength = {.otherwise = detail::never};     ///< Pa
  PhasePairs compressive_strength = {.otherwise = detail::never}; ///< Pa

  struct Prepared {
    double tension, compression; ///< 1/N, inverse of the forces that break
  };
  template <GivesSectionRadius Law>
  Prepared prepare(const BondGeometry& bond, const Law& law) const {
    const double area = detail::Section(law.section_radius(bond)).area;
    return {1 / (area * tensile_strength.between(bond.phase_first, bond.phase_second)),
            1 / (area * compressive_strength.between(bond.phase_first, bond.phase_second))};
  }
  [[gnu::always_inline]] double exertion(const Prepared& bond, const ChannelLoad<>& load) const {
    return load.normal * (load.normal > 0 ? bond.tension : -bond.compression);
  }
  /// @throws core::InvalidInput for a strength that is not above 0
  void validate() const {
    detail::expect_strength(tensile_strength, "tensile strength");
    detail::expect_strength(compressive_strength, "compressive strength");
  }
};

/// Breaks by the bending stress at the surface of the beam, at the worse of its ends.
///
///     sigma = M a/I,  M = max |M +- (L/2) n x F| across n:  sigma >= strength
struct BendingStress {
  PhasePairs strength = {.otherwise = detail::never}; ///< Pa

  struct Prepared {
    double half_length; ///< m
    double bending;     ///< 1/(N m), inverse of the moment that breaks
  };
  template <GivesSectionRadius Law>
  Prepared prepare(const BondGeometry& bond, const Law& law) const {
    const double modulus = detail::Section(law.section_radius(bond)).modulus;
    return {0.5 * bond.length, 1 / (modulus * strength.between(bond.phase_first, bond.phase_second))};
  }
  [[gnu::always_inline]] double exertion(const Prepared& bond, const ChannelLoad<>& load) const {
    return bond.bending * detail::larger_end_moment(load, bond.half_length);
  }
  /// @throws core::InvalidInput for a strength that is not above 0
  void validate() const { detail::expect_strength(strength, "bending strength"); }
};

/// Breaks by the largest stress of the beam: tension and compression at its surface with bending, and shear.
///
///     sigma = +-N/A + M a/I,  tau = |F_t|/A + |M_n| a/(2 I)                      Potyondy and Cundall (2004)
///
/// M as in BendingStress. The mean shear stress of the section is counted, not the 4/3 of it in the middle.
struct CombinedStress {
  PhasePairs tensile_strength = {.otherwise = detail::never};     ///< Pa
  PhasePairs compressive_strength = {.otherwise = detail::never}; ///< Pa
  PhasePairs shear_strength = {.otherwise = detail::never};       ///< Pa

  struct Prepared {
    double half_length;                 ///< m
    double area, modulus;               ///< 1/A, a/I
    double tension, compression, shear; ///< 1/Pa, inverse strengths
  };
  template <GivesSectionRadius Law>
  Prepared prepare(const BondGeometry& bond, const Law& law) const {
    const detail::Section section(law.section_radius(bond));
    const auto inverse = [&](const PhasePairs& strength) {
      return 1 / strength.between(bond.phase_first, bond.phase_second);
    };
    return {0.5 * bond.length,
            1 / section.area,
            1 / section.modulus,
            inverse(tensile_strength),
            inverse(compressive_strength),
            inverse(shear_strength)};
  }
  [[gnu::always_inline]] double exertion(const Prepared& bond, const ChannelLoad<>& load) const {
    const double axial = load.normal * bond.area;
    const double bending = detail::larger_end_moment(load, bond.half_length) * bond.modulus;
    const double shear =
        std::sqrt(load.tangential.squared()) * bond.area + 0.5 * std::abs(load.torsion) * bond.modulus;
    return std::max(
        {(bending + axial) * bond.tension, (bending - axial) * bond.compression, shear * bond.shear});
  }
  /// @throws core::InvalidInput for a strength that is not above 0
  void validate() const {
    detail::expect_strength(tensile_strength, "tensile strength");
    detail::expect_strength(compressive_strength, "compressive strength");
    detail::expect_strength(shear_strength, "shear strength");
  }
};

static_assert(FailureCriterion<AxialStress>);
static_assert(FailureCriterion<BendingStress>);
static_assert(FailureCriterion<CombinedStress>);

} // namespace cdem::bond
