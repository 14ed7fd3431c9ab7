#pragma once

/// @file
/// Explicit density scaling to a wanted time step.

#include <cdem/integrate/critical_time_step.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace cdem::integrate {

/// How the density is scaled.
enum class DensityScaling : std::uint8_t {
  /// One factor for all particles: keeps the shape of the vibrations, all frequencies are divided by one number.
  uniform,
  /// A factor for each particle, so that all set the same time step: waves cross the body in the fewest steps. Small
  /// particles, which otherwise set the step, become as dense as needed. The static solution is the same.
  per_particle
};

/// What density scaling did.
struct DensityScalingReport {
  double smallest_factor = 1; ///< on the density of a particle that has bonds
  double largest_factor = 1;
  double mass_factor = 1; ///< on the mass of all particles that have bonds, and on that of each that has none
};

/// Scales the density so that `safety` times the critical time step is `time_step`.
///
/// rho_i -> rho_i (dt / (D_t dt_i))^2,  dt_i = 2/sqrt(2 lambda_i) of critical_time_step()
///
/// The paper's printed steps (2.15e-5 s for alumina) need densities many orders above the real ones: it scales the
/// mass without saying so, [L17] section 2.3.
/// A particle without a bond sets no step. It gets the body's mean factor, so that it weighs among the others as before.
/// @param time_step  dt wanted, s
/// @param safety     D_t in ]0, 1[, [L17] section 2.3: 0.5
/// @throws           core::InvalidInput for a step or safety that is not accepted, or a body without a bond
/// @complexity       O(bonds)
template <InternalForces Forces>
DensityScalingReport scale_density(const Forces& forces, particles::Inertia& inertia, double time_step,
                                   double safety, DensityScaling scaling, core::ThreadPool& pool) {
  core::expect_positive(time_step, "wanted time step", "s");
  core::expect(safety > 0 && safety < 1, "safety D_t of the time step", safety,
               "a number in ]0, 1[ is expected");
  const std::size_t count = forces.particle_count();
  inertia.validate(count);
  std::vector<double> eigenvalue(count);
  core::parallel_for(pool, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      eigenvalue[i] =
          detail::largest_eigenvalue(detail::scaled_block(forces, inertia, static_cast<ParticleIndex>(i)));
  });
  double largest = 0;
  for (const double value : eigenvalue)
    largest = std::max(largest, value);
  core::expect(largest > 0, "largest stiffness of a particle", largest,
               "a body with at least one bond is expected to scale its density");
  const double target =
      2 * (safety / time_step) * (safety / time_step); // eigenvalue of a particle with step dt / D_t

  DensityScalingReport report{std::numeric_limits<double>::infinity(), 0, 0};
  const auto scale = [&](std::size_t i, double factor) {
    inertia.mass[i] *= factor;
    inertia.moment[i] *= factor;
  };
  double mass_before = 0, mass_after = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (eigenvalue[i] == 0)
      continue;
    const double factor = (scaling == DensityScaling::per_particle ? eigenvalue[i] : largest) / target;
    mass_before += inertia.mass[i];
    scale(i, factor);
    mass_after += inertia.mass[i];
    report.smallest_factor = std::min(report.smallest_factor, factor);
    report.largest_factor = std::max(report.largest_factor, factor);
  }
  report.mass_factor = mass_after / mass_before;
  for (std::size_t i = 0; i < count; ++i)
    if (eigenvalue[i] == 0)
      scale(i, report.mass_factor);
  return report;
}

} // namespace cdem::integrate
