#pragma once

/// @file
/// The state of a moving body.

#include <cdem/particles/spatial_field.hpp>

#include <cstdint>

namespace cdem::particles {

/// Energies that depend on the path of a body and so belong to its state, J, with their rates, W.
struct PathEnergy {
  double initial = 0;          ///< kinetic and elastic energy at the first step
  double external_work = 0;    ///< done by reactions and loads since then
  double dissipated = 0;       ///< by damping since then
  double external_power = 0;   ///< of the reactions at the last step
  double dissipated_power = 0; ///< of the damping at the last step
};

/// Everything a run needs to go on from where it stands, bit by bit.
struct Motion {
  SpatialField<> displacement; ///< [particles] m, rad, from the rest position
  SpatialField<> velocity;     ///< [particles] m/s, rad/s
  SpatialField<> acceleration; ///< [particles] m/s^2, rad/s^2; empty before the first step
  PathEnergy energy;
  double time = 0;        ///< s
  std::uint64_t step = 0; ///< steps done so far

  /// Undeformed and at rest.
  static Motion at_rest(std::size_t particles) {
    Motion motion;
    motion.displacement.resize(particles);
    motion.velocity.resize(particles);
    return motion;
  }
  std::size_t size() const noexcept { return displacement.size(); }
};

} // namespace cdem::particles
