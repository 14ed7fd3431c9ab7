#pragma once

/// @file
/// Normal and tangential springs between the particles' surfaces.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/material.hpp>

#include <numbers>

namespace cdem::bond {

/// A pair of springs, normal and tangential, acting half way between the centres; it resists neither twist
/// nor bend.
///
///     K_n = E_mu A / L with the beam's section A = pi (r_mu (R_i + R_j)/2)^2,   K_t = ratio K_n
///
/// With ratio = 0 only the stretch counts, and the network is one of central forces.
/// @tparam Rule  mixes two phases' parameters in a bond across an interface
template <InterfaceRule Rule = GeometricMean>
class Spring {
public:
  struct Parameters {
    std::vector<Material> materials; ///< one a phase; the microscopic Poisson's ratio is not used
    double tangential_ratio = 0;     ///< K_t / K_n, 0 or above
    Rule interface_rule = {};
  };

  /// @throws core::InvalidInput for a missing or unacceptable material, or a ratio that is negative or not
  /// finite
  explicit Spring(Parameters parameters)
      : table_(std::move(parameters.materials), parameters.interface_rule),
        tangential_ratio_(parameters.tangential_ratio) {
    core::expect_not_negative(tangential_ratio_, "tangential_ratio of the spring");
  }

  /// Stiffness of the springs between two particles. @complexity O(1)
  ChannelStiffness stiffness(const BondGeometry& bond) const {
    const Material& material = table_.between(bond.phase_first, bond.phase_second);
    const double a = section_radius(bond);
    const double normal = material.youngs_modulus * std::numbers::pi * a * a / bond.length;
    return {.normal = normal, .tangential = tangential_ratio_ * normal, .torsion = 0, .bending = 0};
  }

  /// Radius a of the section A, m.
  double section_radius(const BondGeometry& bond) const {
    return table_.between(bond.phase_first, bond.phase_second)
        .section_radius(bond.radius_first, bond.radius_second);
  }

  /// @throws core::InvalidInput if a particle's phase has no material
  void validate(const particles::ParticleSet& particles) const { table_.validate(particles); }

private:
  MaterialTable<Rule> table_;
  double tangential_ratio_;
};

static_assert(BondLaw<Spring<>>);

} // namespace cdem::bond
