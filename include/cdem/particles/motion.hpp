#pragma once

/// @file
/// The state of a moving body.

#include <cdem/particles/spatial_field.hpp>

#include <cstdint>

namespace cdem::particles {

/// Displacement and velocity of every particle, at a time.
struct Motion {
  SpatialField<> displacement; ///< [particles] m, rad, from the rest position
  SpatialField<> velocity;     ///< [particles] m/s, rad/s
  double time = 0;             ///< s
  std::uint64_t step = 0;      ///< steps done so far

  /// At rest.
  static Motion at_rest(std::size_t particles) {
    return {SpatialField<>(particles), SpatialField<>(particles), 0, 0};
  }
  std::size_t size() const noexcept { return displacement.size(); }
};

} // namespace cdem::particles
