#pragma once

/// @file
/// Bonds as the force kernel reads them: four side by side.

#include <cdem/bond/bond_law.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <Eigen/Geometry> // cross product

#include <algorithm>
#include <cstdint>

namespace cdem::bond::detail {

/// All that the force of one bond needs, in the terms in which it is stored.
///
/// With the half branch d = (L/2) n instead of n and L, no factor is left over:
///
///     g = u_j - u_i - (th_i + th_j) x d          F = K_t g + stretch (d.g) d
///     w = th_j - th_i                            M = B w + twist (d.w) d,       couple = d x K_t g
struct BondRecord {
  Vec3 half_branch;    ///< d, m
  double tangential;   ///< K_t, N/m
  double stretch;      ///< (K_n - K_t) / (L/2)^2, N/m^3
  double twist;        ///< (S_n - B) / (L/2)^2, N/m
  double bending;      ///< B = E_mu I/L, N m
  ParticleIndex first; ///< the bond's ends
  ParticleIndex second;

  /// Of a law's stiffness.
  static BondRecord of(const BondGeometry& geometry, const ChannelStiffness& k, ParticleIndex first,
                       ParticleIndex second) {
    const double square = 0.25 * geometry.length * geometry.length;
    return {0.5 * geometry.length * geometry.direction,
            k.tangential,
            (k.normal - k.tangential) / square,
            (k.torsion - k.bending) / square,
            k.bending,
            first,
            second};
  }

  /// The law's stiffness back, to rounding: what is left of a stiffness of 0 beside a large one may be below 0.
  ChannelStiffness stiffness() const {
    const double square = half_branch.squaredNorm();
    return {.normal = std::max(0.0, tangential + stretch * square),
            .tangential = tangential,
            .torsion = std::max(0.0, bending + twist * square),
            .bending = bending};
  }

  /// The same bond with its ends exchanged: it gives both the same loads, to the last bit.
  BondRecord turned() const { return {-half_branch, tangential, stretch, twist, bending, second, first}; }

  /// Deformation of the bond between two moved ends.
  BondDeformation deformation(const particles::Spatial<>& u_first,
                              const particles::Spatial<>& u_second) const {
    const Vec3 twice_mean_rotation = u_first.angular() + u_second.angular();
    return {u_second.linear() - u_first.linear() - twice_mean_rotation.cross(half_branch),
            u_second.angular() - u_first.angular()};
  }

  /// Force and moments on the two ends.
  BondLoad load(const particles::Spatial<>& u_first, const particles::Spatial<>& u_second) const {
    const auto [slip, turn] = deformation(u_first, u_second);
    const Vec3 shear = tangential * slip;
    const Vec3 couple = half_branch.cross(shear);
    const Vec3 moment = bending * turn + twist * half_branch.dot(turn) * half_branch;
    return {shear + stretch * half_branch.dot(slip) * half_branch, couple + moment, couple - moment};
  }
};

/// Four bonds side by side, a lane each, so that one instruction computes with all of them.
///
/// @tparam StiffnessReal  what the stiffnesses are stored in: 256 bytes in double, 192 in float. The geometry is in
///                        double, which keeps forces of rigid motions at rounding errors.
template <class StiffnessReal>
struct alignas(64) BondGroup {
  static constexpr std::size_t lanes = 4;

  double half_branch[3][lanes];
  StiffnessReal tangential[lanes], stretch[lanes], twist[lanes], bending[lanes];
  ParticleIndex first[lanes], second[lanes];

  void set(std::size_t lane, const BondRecord& bond) {
    for (int k = 0; k < 3; ++k)
      half_branch[k][lane] = bond.half_branch[k];
    tangential[lane] = static_cast<StiffnessReal>(bond.tangential);
    stretch[lane] = static_cast<StiffnessReal>(bond.stretch);
    twist[lane] = static_cast<StiffnessReal>(bond.twist);
    bending[lane] = static_cast<StiffnessReal>(bond.bending);
    first[lane] = bond.first;
    second[lane] = bond.second;
  }

  BondRecord get(std::size_t lane) const {
    return {{half_branch[0][lane], half_branch[1][lane], half_branch[2][lane]},
            double{tangential[lane]},
            double{stretch[lane]},
            double{twist[lane]},
            double{bending[lane]},
            first[lane],
            second[lane]};
  }
};
static_assert(sizeof(BondGroup<double>) == 256 && sizeof(BondGroup<float>) == 192);

} // namespace cdem::bond::detail
