#pragma once

/// @file
/// What a stress estimator is, and the field it returns.

#include <cdem/network/bond_network.hpp>
#include <cdem/particles/particle_set.hpp>

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

namespace cdem::stress {

/// Stress of each specimen (cell of a tessellation, or sphere around a point).
struct StressField {
  std::vector<Mat3> stress;             ///< [specimens] Pa, tension positive, row = force, column = branch
  std::vector<double> volume;           ///< [specimens] m^3
  std::vector<std::uint32_t> particles; ///< [specimens] number of centres inside
  Mat3 outside = Mat3::Zero(); ///< sum of f (x) d over what lies in no specimen, N m: lost to the stresses

  std::size_t size() const noexcept { return stress.size(); }
};

/// `estimator.estimate(particles, network, forces)` with forces [bonds] in N on each bond's first particle.
template <class E>
concept EstimatesStress = requires(const E& estimator, const particles::ParticleSet& particles,
                                   const network::BondNetwork& network, std::span<const Vec3> forces) {
  { estimator.estimate(particles, network, forces) } -> std::same_as<StressField>;
};

/// A way to turn bond forces into stresses. Models: LoveWeber.
template <class E>
concept StressEstimator = EstimatesStress<E>;

} // namespace cdem::stress
