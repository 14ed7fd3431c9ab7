#pragma once

/// @file
/// The spheres: position, radius and phase, one array each.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace cdem::particles {

/// Spheres as a structure of arrays, all of one length.
struct ParticleSet {
  std::vector<Vec3> position;    ///< [particles] centre, m
  std::vector<double> radius;    ///< [particles] m
  std::vector<PhaseIndex> phase; ///< [particles] number of the material

  std::size_t size() const noexcept { return position.size(); }

  /// Makes room for `count` particles of phase 0.
  void resize(std::size_t count) {
    position.resize(count, Vec3::Zero());
    radius.resize(count, 0);
    phase.resize(count, 0);
  }

  /// Sum of the spheres' volumes, m^3 (overlaps counted twice).
  double solid_volume() const {
    double sum = 0;
    for (const double r : radius)
      sum += r * r * r;
    return 4.0 / 3.0 * std::numbers::pi * sum;
  }

  /// Mean radius, m; 0 for an empty set.
  double mean_radius() const {
    double sum = 0;
    for (const double r : radius)
      sum += r;
    return radius.empty() ? 0 : sum / static_cast<double>(radius.size());
  }

  /// Checks what every stage relies on.
  /// @throws core::InvalidInput for an empty set, arrays of different lengths, a position that is not finite or a
  ///         radius that is not a finite positive number; the message names the first such particle
  void validate() const {
    core::expect(!position.empty(), "number of particles", position.size(), "at least 1 is expected");
    core::expect(radius.size() == position.size(), "number of radii", radius.size(),
                 "one per position (" + std::to_string(position.size()) + ") is expected");
    core::expect(phase.size() == position.size(), "number of phases", phase.size(),
                 "one per position (" + std::to_string(position.size()) + ") is expected");
    for (std::size_t i = 0; i < position.size(); ++i) {
      for (int k = 0; k < 3; ++k)
        if (!std::isfinite(position[i][k]))
          core::reject(std::string("position ") + "xyz"[k] + " of particle " + std::to_string(i),
                       position[i][k], "a finite number is expected");
      if (!(std::isfinite(radius[i]) && radius[i] > 0))
        core::reject("radius of particle " + std::to_string(i), radius[i],
                     "a finite number above 0 m is expected");
    }
  }
};

} // namespace cdem::particles
