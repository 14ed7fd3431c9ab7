#pragma once

/// @file
/// What a bond law is: from two particles at rest to the stiffness of their bond.

#include <cdem/core/types.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/particles/particle_set.hpp>

#include <Eigen/Geometry> // cross product

#include <concepts>

namespace cdem::bond {

/// A bond at rest, as a law sees it.
struct BondGeometry {
  Vec3 direction;           ///< unit vector n from the first particle to the second
  double length = 0;        ///< L, distance of the centres, m
  double radius_first = 0;  ///< R_i, m
  double radius_second = 0; ///< R_j, m
  PhaseIndex phase_first = 0;
  PhaseIndex phase_second = 0;
};

/// Geometry of bond `b`.
inline BondGeometry geometry_of(BondIndex b, const particles::ParticleSet& particles,
                                const network::BondNetwork& network) {
  const ParticleIndex i = network.first[b], j = network.second[b];
  const double length = network.branch[b].norm();
  return {network.branch[b] / length, length, particles.radius[i], particles.radius[j], particles.phase[i],
          particles.phase[j]};
}

/// The four stiffnesses of a bond whose force is linear in its ends' small motion.
///
/// They multiply the four independent deformations of a bond, see load_of(). None may be negative.
struct ChannelStiffness {
  double normal = 0;     ///< K_n, N/m: stretch along n
  double tangential = 0; ///< K_t, N/m: shear across n
  double torsion = 0;    ///< S_n, N m: twist about n
  double bending = 0;    ///< E_mu I / L, N m: difference of the ends' rotations across n
};

/// Force and moments that a bond exerts on its two ends.
struct BondLoad {
  Vec3 force;         ///< N, on the first particle; the second gets the opposite
  Vec3 moment_first;  ///< N m, on the first particle, about its centre
  Vec3 moment_second; ///< N m, on the second particle, about its centre
};

/// `law.stiffness(geometry)` gives the bond's ChannelStiffness.
template <class L>
concept GivesChannelStiffness = requires(const L& law, const BondGeometry& geometry) {
  { law.stiffness(geometry) } -> std::same_as<ChannelStiffness>;
};

/// `law.validate(particles)` throws core::InvalidInput where a particle's phase has no material.
template <class L>
concept ValidatesParticles = requires(const L& law, const particles::ParticleSet& particles) {
  law.validate(particles);
};

/// A bond law. Models: Beam, Spring.
template <class L>
concept BondLaw = std::copy_constructible<L> && GivesChannelStiffness<L> && ValidatesParticles<L>;

/// Deformation of a bond in small motion, [L17] section 2.2 in frame-free form.
///
/// With th = (th_i + th_j)/2:  slip = u_j - u_i - L th x n,  turn = th_j - th_i. Rigid motions give zero for
/// both.
struct BondDeformation {
  Vec3 slip; ///< m: stretch along n, shear across n
  Vec3 turn; ///< rad: twist along n, bend across n
};

/// Deformation from the displacement u and the rotation th of the bond's ends.
template <class Spatial>
BondDeformation deformation_of(const Vec3& direction, double length, const Spatial& first,
                               const Spatial& second) {
  const Vec3 mean_rotation = 0.5 * (first.angular() + second.angular());
  return {second.linear() - first.linear() - length * mean_rotation.cross(direction),
          second.angular() - first.angular()};
}

/// Load of a linear bond, [L17] section 2.2 in frame-free form.
///
///     F on i =  K_n g_n n + K_t g_t,  F on j = -F             g: slip
///     M      =  S_n d_n n + (E_mu I/L) d_t                    d: turn
///     M on i =  M + (L/2) n x F,      M on j = -M + (L/2) n x F
///
/// Equal to the 12x12 matrix of the Euler–Bernoulli beam when the stiffnesses are the beam's. The couple
/// (L/2) n x F balances the moment of the two opposite forces.
inline BondLoad load_of(const ChannelStiffness& stiffness, const Vec3& direction, double length,
                        const BondDeformation& deformation) {
  const auto channels = [&](double along, double across, const Vec3& v) -> Vec3 {
    return across * v + ((along - across) * direction.dot(v)) * direction;
  };
  const Vec3 force = channels(stiffness.normal, stiffness.tangential, deformation.slip);
  const Vec3 moment = channels(stiffness.torsion, stiffness.bending, deformation.turn);
  const Vec3 couple = 0.5 * length * direction.cross(force);
  return {force, moment + couple, couple - moment};
}

/// Elastic energy of a linear bond, J: half of each stiffness times its deformation squared.
inline double energy_of(const ChannelStiffness& stiffness, const Vec3& direction,
                        const BondDeformation& deformation) {
  const auto channels = [&](double along, double across, const Vec3& v) {
    const double normal = direction.dot(v);
    return 0.5 * (across * v.squaredNorm() + (along - across) * normal * normal);
  };
  return channels(stiffness.normal, stiffness.tangential, deformation.slip) +
         channels(stiffness.torsion, stiffness.bending, deformation.turn);
}

} // namespace cdem::bond
