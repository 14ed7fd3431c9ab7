#pragma once

/// @file
/// Mass and moment of inertia of the particles, with explicit density scaling.

#include <cdem/particles/particle_set.hpp>

#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace cdem::particles {

/// Mass and moment of inertia of each particle.
struct Inertia {
  std::vector<double> mass;   ///< [particles] kg
  std::vector<double> moment; ///< [particles] kg m^2, the same about every axis

  std::size_t size() const noexcept { return mass.size(); }

  /// @throws core::InvalidInput unless there is a mass and a moment, each a finite number above zero, for
  ///         each of `particles`; names the first that is not
  void validate(std::size_t particles) const {
    const auto expect_count = [&](std::size_t count, const char* name) {
      core::expect(count == particles, name, count,
                   "the number of particles, " + std::to_string(particles) + ", is expected");
    };
    expect_count(mass.size(), "number of masses");
    expect_count(moment.size(), "number of moments of inertia");
    const auto acceptable = [](double value) { return std::isfinite(value) && value > 0; };
    for (std::size_t i = 0; i < particles; ++i) { // names are written for the bad one only
      if (!acceptable(mass[i])) [[unlikely]]
        core::expect_positive(mass[i], "mass of particle " + std::to_string(i), "kg");
      if (!acceptable(moment[i])) [[unlikely]]
        core::expect_positive(moment[i], "moment of inertia of particle " + std::to_string(i), "kg m^2");
    }
  }

  /// Multiplies every mass and moment: density scaling. A time step grows with the square root of the factor,
  /// the static solution does not change.
  void scale(double factor) {
    core::expect_positive(factor, "density scaling factor");
    for (double& m : mass)
      m *= factor;
    for (double& m : moment)
      m *= factor;
  }
};

/// Inertia of solid spheres: m = rho 4/3 pi R^3, I = 2/5 m R^2.
///
/// @param density  [phases] kg/m^3, one a phase used by the particles
/// @throws core::InvalidInput for a density that is not positive, or a phase without one
inline Inertia solid_spheres(const ParticleSet& particles, std::span<const double> density) {
  particles.validate();
  for (std::size_t p = 0; p < density.size(); ++p)
    core::expect_positive(density[p], "density of phase " + std::to_string(p), "kg/m^3");
  Inertia inertia;
  inertia.mass.resize(particles.size());
  inertia.moment.resize(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::size_t phase = particles.phase[i];
    core::expect(phase < density.size(), "phase of particle " + std::to_string(i), phase,
                 "a phase with a density is expected, " + std::to_string(density.size()) + " given");
    const double r = particles.radius[i];
    inertia.mass[i] = density[phase] * 4.0 / 3.0 * std::numbers::pi * r * r * r;
    inertia.moment[i] = 0.4 * inertia.mass[i] * r * r;
  }
  return inertia;
}

} // namespace cdem::particles
