#pragma once

/// @file
/// What velocity Verlet does to a block of particles once the forces on them are known.

#include <cdem/core/vector_registers.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <cstddef>

namespace cdem::integrate::detail {

/// Kinetic energy (J) and powers (W) of a block of particles.
struct StepSums {
  double kinetic = 0;
  double dissipated_power = 0; ///< lost to damping
  double external_power = 0;   ///< of loads and reactions
  StepSums& operator+=(const StepSums& other) {
    kinetic += other.kinetic;
    dissipated_power += other.dissipated_power;
    external_power += other.external_power;
    return *this;
  }
};

/// A block of particles in the middle of a step: forces are those at the displacement, the velocity is `advance` older.
struct BlockOfStep {
  std::size_t count;
  const particles::Spatial<>* force;
  const particles::Spatial<>* damped; ///< forces at displacement + beta v*; null without beta
  const particles::Spatial<>* load;   ///< null without
  const double *mass, *moment;
  const particles::Spatial<>* displacement;
  particles::Spatial<>* velocity; ///< out: at the displacement's time if `whole`, else half a step later
  particles::Spatial<>* next;     ///< out: the acceleration if `whole`, else the coming displacement
  particles::Spatial<>* ahead; ///< out, if not `whole`: the coming displacement + beta v*; null without beta
  double time_step, advance, alpha, beta;
  bool whole;
};

/// Velocity after the time t under an acceleration less alpha times the velocity, that taken at the end of it;
/// implicit = 1/(1 + alpha t).
inline double velocity_after(double velocity, double acceleration, double time, double implicit) {
  return (velocity + acceleration * time) * implicit;
}

/// All degrees of freedom, as if none were prescribed.
template <bool whole>
[[gnu::always_inline]] inline void step_block_inline(const BlockOfStep& b, StepSums& sums) {
  using core::Four;
  const double implicit = 1 / (1 + b.alpha * b.advance), half_step = 0.5 * b.time_step;
  Four twice_kinetic = {0, 0, 0, 0}, viscous_power = {0, 0, 0, 0}, load_power = {0, 0, 0, 0};
  for (std::size_t i = 0; i < b.count; ++i)
    for (int first = 0; first < 8; first += 4) { // translation, rotation
      const double mass = first == 0 ? b.mass[i] : b.moment[i];
      Four force, viscous = {0, 0, 0, 0}, load = {0, 0, 0, 0}, velocity;
      core::load(force, b.force[i].component + first);
      core::load(velocity, b.velocity[i].component + first);
      if (b.damped) {
        core::load(viscous, b.damped[i].component + first);
        viscous -= force;
      }
      if (b.load)
        core::load(load, b.load[i].component + first);
      const Four free_acceleration = (force + viscous + load) * (1 / mass);
      velocity = (velocity + free_acceleration * b.advance) * implicit;
      const Four acceleration = free_acceleration - b.alpha * velocity;
      twice_kinetic += mass * (velocity * velocity);
      viscous_power += viscous * velocity;
      load_power += load * velocity;
      if constexpr (whole) {
        core::store(b.velocity[i].component + first, velocity);
        core::store(b.next[i].component + first, acceleration);
      } else {
        Four displacement;
        core::load(displacement, b.displacement[i].component + first);
        const Four gain = half_step * acceleration;
        velocity += gain;
        displacement += b.time_step * velocity;
        core::store(b.velocity[i].component + first, velocity);
        core::store(b.next[i].component + first, displacement);
        if (b.ahead)
          core::store(b.ahead[i].component + first, displacement + b.beta * (velocity + gain));
      }
    }
  sums = {.kinetic = 0.5 * core::sum(twice_kinetic),
          .dissipated_power = b.alpha * core::sum(twice_kinetic) - core::sum(viscous_power),
          .external_power = core::sum(load_power)};
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] inline void step_block_avx2(const BlockOfStep& block, StepSums& sums) {
  block.whole ? step_block_inline<true>(block, sums) : step_block_inline<false>(block, sums);
}
#endif

/// One block by the best means of this processor, the same bits by any.
inline StepSums step_block(const BlockOfStep& block) {
  StepSums sums;
#if defined(__x86_64__)
  if (core::has_avx2()) {
    step_block_avx2(block, sums);
    return sums;
  }
#endif
  block.whole ? step_block_inline<true>(block, sums) : step_block_inline<false>(block, sums);
  return sums;
}

} // namespace cdem::integrate::detail
