#pragma once

/// @file
/// The frequency of a vibration whose shape is known or guessed.

#include <cdem/integrate/integrator.hpp>

#include <cmath>
#include <numbers>

namespace cdem::integrate {

/// Angular frequency of a body that vibrates in a given shape, sqrt(u.K u / u.M u), Rayleigh's quotient.
///
/// Exact for the shape of a mode; for a guess of the lowest mode it is an upper bound of the lowest frequency.
/// @param shape  [particles] any length
/// @return       rad/s
/// @throws       core::InvalidInput for a shape of another size, or one without motion
template <InternalForces Forces>
double frequency_of_shape(const Problem<Forces>& problem, const particles::SpatialField<>& shape,
                          core::ThreadPool& pool) {
  core::expect(
      shape.size() == problem.forces.particle_count(), "number of particles of the shape", shape.size(),
      "the number of particles, " + std::to_string(problem.forces.particle_count()) + ", is expected");
  const double twice_kinetic = 2 * kinetic_energy(problem.inertia, shape, pool);
  core::expect_positive(twice_kinetic, "u.M u of the shape");
  return std::sqrt(2 * problem.forces.elastic_energy(shape, pool) / twice_kinetic);
}

/// Angular frequency of the first stretching vibration of a body held at both ends along an axis, by its shape
/// sin(pi s), s from 0 to 1 over the box.
///
/// The particles follow the shape exactly, as in Voigt's bound, so it is above the true one by some tens of percent.
/// Particles without a bond stay at rest: they do not vibrate with the body.
/// @return  rad/s
/// @throws  core::InvalidInput where nothing between the ends moves
/// @complexity O(bonds)
template <InternalForces Forces>
double first_axial_frequency(const Problem<Forces>& problem, const particles::ParticleSet& particles,
                             double lower, double upper, Axis axis, core::ThreadPool& pool) {
  particles::SpatialField<> shape(particles.size());
  const int k = core::index_of(axis);
  core::parallel_for(pool, shape.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (problem.forces.diagonal_block(static_cast<ParticleIndex>(i)).cwiseAbs().maxCoeff() > 0)
        shape[i][k] = std::sin(std::numbers::pi * (particles.position[i][k] - lower) / (upper - lower));
  });
  return frequency_of_shape(problem, shape, pool);
}

} // namespace cdem::integrate
