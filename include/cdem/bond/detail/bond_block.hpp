#pragma once

/// @file
/// Bonds as the force kernel reads them, and the kernel on any processor.

#include <cdem/bond/bond_law.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <Eigen/Geometry> // cross product

#include <cstdint>

namespace cdem::bond::detail {

/// All that the force of one bond needs: a cache line in double precision, half of one in float.
///
/// With the half branch d = (L/2) n instead of n and L, no factor is left over in load_of():
///
///     g = u_j - u_i - (th_i + th_j) x d          F = K_t g + stretch (d.g) d
///     w = th_j - th_i                            M = B w + twist (d.w) d,       couple = d x K_t g
template <class Real>
struct alignas(8 * sizeof(Real)) BondRecord {
  Real half_branch[3];      ///< d, m
  Real tangential;          ///< K_t, N/m
  Real stretch;             ///< (K_n - K_t) / (L/2)^2, N/m^3
  Real twist;               ///< (S_n - B) / (L/2)^2, N/m
  Real bending;             ///< B = E_mu I/L, N m
  std::uint32_t second = 0; ///< the bond's second particle

  BondRecord() = default;
  BondRecord(const BondGeometry& geometry, const ChannelStiffness& stiffness, ParticleIndex second_particle)
      : second(second_particle) {
    const Vec3 d = 0.5 * geometry.length * geometry.direction;
    for (int k = 0; k < 3; ++k)
      half_branch[k] = static_cast<Real>(d[k]);
    const double square = 0.25 * geometry.length * geometry.length;
    tangential = static_cast<Real>(stiffness.tangential);
    stretch = static_cast<Real>((stiffness.normal - stiffness.tangential) / square);
    twist = static_cast<Real>((stiffness.torsion - stiffness.bending) / square);
    bending = static_cast<Real>(stiffness.bending);
  }

  /// d in double precision.
  Vec3 arm() const { return core::Vector3<Real>(half_branch).template cast<double>(); }
};
static_assert(sizeof(BondRecord<double>) == 64 && sizeof(BondRecord<float>) == 32);

/// Deformation of the bond between two moved ends, see deformation_of().
template <class Real>
BondDeformation deformation_of(const BondRecord<Real>& bond, const particles::Spatial<>& first,
                               const particles::Spatial<>& second) {
  const Vec3 twice_mean_rotation = first.angular() + second.angular();
  return {second.linear() - first.linear() - twice_mean_rotation.cross(bond.arm()),
          second.angular() - first.angular()};
}

/// What a bond does to its ends: `force` and `couple + moment` to the first, `-force` and `couple - moment` to the
/// second.
struct BondAction {
  Vec3 force, couple, moment;
};

template <class Real>
BondAction action_of(const BondRecord<Real>& bond, const particles::Spatial<>& first,
                     const particles::Spatial<>& second) {
  const auto [slip, turn] = deformation_of(bond, first, second);
  const Vec3 d = bond.arm();
  const Vec3 shear = double{bond.tangential} * slip;
  const double stretch = double{bond.stretch} * (d[0] * slip[0] + d[1] * slip[1] + d[2] * slip[2]);
  const double twist = double{bond.twist} * (d[0] * turn[0] + d[1] * turn[1] + d[2] * turn[2]);
  return {shear + stretch * d, d.cross(shear), double{bond.bending} * turn + twist * d};
}

/// A bond computed for its second end alone, because its first lies in another block.
struct IncomingBond {
  BondIndex bond;
  ParticleIndex first;
};

/// The bonds that act on one block of particles [begin, end).
///
/// A bond with both ends in the block is computed once. One that leaves the block is computed twice, by the
/// blocks of its two ends, each for its own: so no block waits for another, and sums do not depend on threads.
template <class Real>
struct BondBlock {
  const BondRecord<Real>* records; ///< of all bonds, by bond number
  const BondIndex* bonds_begin;    ///< [particles + 1] the bonds whose first end is particle i
  const IncomingBond* incoming;    ///< those whose second end alone is in the block
  std::size_t incoming_count;
  ParticleIndex begin, end;
};

/// Bonds ahead of the one computed whose second end is fetched from memory.
inline constexpr BondIndex prefetch_distance = 16;

/// Adds the bonds' forces on a block's particles. This version runs on any processor; the one of
/// bond_block_avx2.hpp does the same operations in the same order.
///
/// @param force  [block] N, N m, added to
template <class Real>
void add_forces(const BondBlock<Real>& block, const particles::Spatial<>* displacement,
                particles::Spatial<>* force) {
  const ParticleIndex size = block.end - block.begin;
  const auto act_on_second = [](particles::Spatial<>& on_second, const BondAction& action) {
    on_second.linear() -= action.force;
    on_second.angular() += action.couple - action.moment;
  };
  particles::Spatial<> elsewhere; // takes what belongs to other blocks
  for (ParticleIndex i = block.begin; i < block.end; ++i) {
    Vec3 linear = force[i - block.begin].linear(), angular = force[i - block.begin].angular();
    for (BondIndex b = block.bonds_begin[i]; b < block.bonds_begin[i + 1]; ++b) {
      const BondRecord<Real>& bond = block.records[b];
      const BondAction action = action_of(bond, displacement[i], displacement[bond.second]);
      linear += action.force;
      angular += action.couple + action.moment;
      const ParticleIndex second = bond.second - block.begin; // wraps around for a second before the block
      act_on_second(second < size ? force[second] : elsewhere, action);
    }
    force[i - block.begin].linear() = linear;
    force[i - block.begin].angular() = angular;
  }
  for (std::size_t k = 0; k < block.incoming_count; ++k) {
    const auto [b, first] = block.incoming[k];
    const BondRecord<Real>& bond = block.records[b];
    act_on_second(force[bond.second - block.begin],
                  action_of(bond, displacement[first], displacement[bond.second]));
  }
}

} // namespace cdem::bond::detail
