#pragma once

/// @file
/// The cohesive Euler–Bernoulli beam of the paper.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/material.hpp>

#include <numbers>

namespace cdem::bond {

/// Cohesive beam of circular section, Euler–Bernoulli with bending–shear coupling, [L17] section 2.2.
///
///     a   = r_mu (R_i + R_j)/2         radius of the beam, m
///     A   = pi a^2,  I = pi a^4/4      area m^2, second moment m^4 (polar: 2 I)
///     K_n = E_mu A / L,  K_t = 12 E_mu I / L^3,  S_n = 2 G_mu I / L,  bending E_mu I / L
///
/// With load_of() these are the standard 12x12 matrix of the beam, to rounding.
/// @tparam Rule  mixes two phases' parameters in a bond across an interface
template <InterfaceRule Rule = GeometricMean>
class Beam {
public:
  struct Parameters {
    std::vector<Material> materials; ///< one a phase
    Rule interface_rule = {};
  };

  /// @throws core::InvalidInput for a missing or unacceptable material
  explicit Beam(Parameters parameters) : table_(std::move(parameters.materials), parameters.interface_rule) {}

  /// Stiffness of a beam between two particles. @complexity O(1)
  ChannelStiffness stiffness(const BondGeometry& bond) const {
    const Material& material = this->material(bond);
    const double a = section_radius(bond);
    const double area = std::numbers::pi * a * a;
    const double second_moment = 0.25 * area * a * a;
    const double bending = material.youngs_modulus * second_moment / bond.length;
    return {.normal = material.youngs_modulus * area / bond.length,
            .tangential = 12 * bending / (bond.length * bond.length),
            .torsion = 2 * material.shear_modulus() * second_moment / bond.length,
            .bending = bending};
  }

  /// Material of a bond: that of its phase, or mixed across an interface.
  const Material& material(const BondGeometry& bond) const {
    return table_.between(bond.phase_first, bond.phase_second);
  }
  /// Radius a of the beam, m.
  double section_radius(const BondGeometry& bond) const {
    return material(bond).section_radius(bond.radius_first, bond.radius_second);
  }

  /// @throws core::InvalidInput if a particle's phase has no material
  void validate(const particles::ParticleSet& particles) const { table_.validate(particles); }

private:
  MaterialTable<Rule> table_;
};

static_assert(BondLaw<Beam<>>);
static_assert(BondLaw<Beam<HarmonicMean>>);

} // namespace cdem::bond
