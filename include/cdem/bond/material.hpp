#pragma once

/// @file
/// Microscopic material of each phase, and the rule for bonds that join two phases.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>
#include <cdem/particles/particle_set.hpp>

#include <cmath>
#include <concepts>
#include <string>
#include <utility>
#include <vector>

namespace cdem::bond {

/// Microscopic elastic parameters of a phase, [L17] section 2.2.
struct Material {
  double youngs_modulus = 0; ///< E_mu, Pa
  double radius_ratio = 0;   ///< r_mu in ]0, 1]: beam radius over the mean radius of the two particles
  double poissons_ratio =
      0.3; ///< microscopic Poisson's ratio, sets G_mu only; the paper prints none (not in the paper)

  /// G_mu = E_mu / (2 (1 + nu_mu)), Pa. [L17] section 2.4: it has no influence on the macroscopic moduli.
  double shear_modulus() const { return youngs_modulus / (2 * (1 + poissons_ratio)); }

  /// Radius of the beam between two particles, r_mu (R_i + R_j)/2, m.
  double section_radius(double radius_first, double radius_second) const {
    return radius_ratio * 0.5 * (radius_first + radius_second);
  }

  /// @param name  how messages call this material, such as "phase 0"
  /// @throws core::InvalidInput naming the parameter and what is accepted
  void validate(const std::string& name) const {
    core::expect_positive(youngs_modulus, "E_mu of " + name, "Pa");
    core::expect(radius_ratio > 0 && radius_ratio <= 1, "r_mu of " + name, radius_ratio,
                 "a number in ]0, 1] is expected");
    core::expect(poissons_ratio > -1 && poissons_ratio <= 0.5, "microscopic Poisson's ratio of " + name,
                 poissons_ratio, "a number in ]-1, 0.5] is expected");
  }
};

/// `rule(a, b)`: the value at an interface from those of the two phases, symmetric, equal to a where a = b.
template <class R>
concept InterfaceRule = std::copy_constructible<R> && requires(const R& rule, double a, double b) {
  { rule(a, b) } -> std::same_as<double>;
};

/// sqrt(a b): the paper's rule for E_mu, [L17] section 3.2.
struct GeometricMean {
  double operator()(double a, double b) const { return std::sqrt(a * b); }
};
/// (a + b)/2: two half bonds side by side.
struct ArithmeticMean {
  double operator()(double a, double b) const { return 0.5 * (a + b); }
};
/// 2ab/(a + b): two half bonds in line.
struct HarmonicMean {
  double operator()(double a, double b) const { return 2 * a * b / (a + b); }
};
static_assert(InterfaceRule<GeometricMean> && InterfaceRule<ArithmeticMean> && InterfaceRule<HarmonicMean>);

/// The material of every pair of phases.
///
/// Within a phase its own; across two phases E_mu by the rule, [L17] section 3.2, and r_mu and nu_mu by the
/// same rule (r_mu) and by the arithmetic mean (nu_mu, which may be negative): the paper speaks of E_mu
/// alone.
/// @deviation r_mu of an interface bond is mixed by the rule; the paper does not say.
template <InterfaceRule Rule = GeometricMean>
class MaterialTable {
public:
  /// @param materials  one a phase, at least one and at most 256
  explicit MaterialTable(std::vector<Material> materials, Rule rule = {}) : materials_(std::move(materials)) {
    const std::size_t count = materials_.size();
    core::expect(count >= 1 && count <= 256, "number of materials", count,
                 "1 to 256, one a phase, is expected");
    for (std::size_t p = 0; p < count; ++p)
      materials_[p].validate("phase " + std::to_string(p));
    pairs_.reserve(count * count);
    for (const Material& a : materials_)
      for (const Material& b : materials_)
        pairs_.push_back(&a == &b ? a
                                  : Material{rule(a.youngs_modulus, b.youngs_modulus),
                                             rule(a.radius_ratio, b.radius_ratio),
                                             0.5 * (a.poissons_ratio + b.poissons_ratio)});
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      pairs_[k].validate("the interface of phases " + std::to_string(k / count) + " and " +
                         std::to_string(k % count));
  }

  /// Material of a bond between phases `a` and `b`.
  const Material& between(PhaseIndex a, PhaseIndex b) const { return pairs_[a * materials_.size() + b]; }

  /// Number of phases.
  std::size_t size() const noexcept { return materials_.size(); }

  /// @throws core::InvalidInput if a particle's phase has no material
  void validate(const particles::ParticleSet& particles) const {
    for (std::size_t i = 0; i < particles.phase.size(); ++i)
      core::expect(particles.phase[i] < size(), "phase of particle " + std::to_string(i), particles.phase[i],
                   "a phase with a material is expected, " + std::to_string(size()) + " given");
  }

private:
  std::vector<Material> materials_;
  std::vector<Material> pairs_;
};

} // namespace cdem::bond
