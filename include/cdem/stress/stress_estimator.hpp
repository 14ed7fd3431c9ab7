#pragma once

/// @file
/// What a stress estimator is, and the field it returns.

#include <cdem/network/bond_network.hpp>
#include <cdem/particles/particle_set.hpp>
#include <cdem/stress/bond_loads.hpp>

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

namespace cdem::stress {

/// Stress of each specimen: a cell of a tessellation, a sphere around a point, the surroundings of a point.
struct StressField {
  std::vector<Mat3> stress;             ///< [specimens] Pa, tension positive, row = force, column = branch
  std::vector<double> volume;           ///< [specimens] m^3
  std::vector<std::uint32_t> particles; ///< [specimens] number of centres inside
  /// Of tessellations: sum of f (x) d over what lies in no specimen, N m, lost to the stresses. Spheres and kernels, which
  /// overlap, leave it 0.
  Mat3 outside = Mat3::Zero();
  std::vector<Mat3> couple_stress; ///< [specimens] N/m, row = moment, column = branch; empty without moments
  Mat3 outside_couple = Mat3::Zero(); ///< likewise of the moments, N m^2

  std::size_t size() const noexcept { return stress.size(); }
};

/// `estimator.estimate(particles, network, forces)` with forces [bonds] in N on each bond's first particle.
template <class E>
concept EstimatesStress = requires(const E& estimator, const particles::ParticleSet& particles,
                                   const network::BondNetwork& network, std::span<const Vec3> forces) {
  { estimator.estimate(particles, network, forces) } -> std::same_as<StressField>;
};

/// `estimator.estimate(particles, network, loads)` with the bonds' moments beside the forces.
template <class E>
concept EstimatesCoupleStress = requires(const E& estimator, const particles::ParticleSet& particles,
                                         const network::BondNetwork& network, const BondLoads& loads) {
  { estimator.estimate(particles, network, loads) } -> std::same_as<StressField>;
};

/// A way to turn bond forces into stresses. Models: LoveWeber, Halo, CoarseGraining, which also estimate couple stress;
/// an estimator of one's own need not.
template <class E>
concept StressEstimator = EstimatesStress<E>;

} // namespace cdem::stress
