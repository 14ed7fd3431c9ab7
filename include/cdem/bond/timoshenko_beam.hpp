#pragma once

/// @file
/// The cohesive beam with shear deformation.

#include <cdem/bond/beam.hpp>

namespace cdem::bond {

/// Cohesive beam of circular section that deforms in shear too: Beam with another tangential stiffness.
///
///     Phi   = 12 E I/(kappa G A L^2) = (7 + 6 nu) (a/L)^2
///     K_t   = 12 E I/(L^3 (1 + Phi)),  K_n, S_n and bending as Beam
///     kappa = 6 (1 + nu)/(7 + 6 nu)                          circular section, Cowper (1966)
///
/// The 12x12 matrix of Timoshenko's beam (Przemieniecki 1968), to rounding. At a/L = 0.27 (touching spheres, r_mu =
/// 0.545) and nu = 0.3, K_t is 0.61 of Beam's.                                                    (not in the paper)
/// @tparam Rule  mixes two phases' parameters in a bond across an interface
template <InterfaceRule Rule = GeometricMean>
class TimoshenkoBeam {
public:
  using Parameters = typename Beam<Rule>::Parameters;

  /// @throws core::InvalidInput for a missing or unacceptable material
  explicit TimoshenkoBeam(Parameters parameters) : beam_(std::move(parameters)) {}

  /// Stiffness of a beam between two particles. @complexity O(1)
  ChannelStiffness stiffness(const BondGeometry& bond) const {
    const double slenderness = section_radius(bond) / bond.length;
    ChannelStiffness stiffness = beam_.stiffness(bond);
    stiffness.tangential /= 1 + (7 + 6 * beam_.material(bond).poissons_ratio) * slenderness * slenderness;
    return stiffness;
  }

  /// Radius of the beam, m.
  double section_radius(const BondGeometry& bond) const { return beam_.section_radius(bond); }

  /// @throws core::InvalidInput if a particle's phase has no material
  void validate(const particles::ParticleSet& particles) const { beam_.validate(particles); }

private:
  Beam<Rule> beam_;
};

static_assert(BondLaw<TimoshenkoBeam<>>);

} // namespace cdem::bond
