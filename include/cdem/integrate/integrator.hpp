#pragma once

/// @file
/// What an integrator needs from a body's internal forces, and what an integrator is.

#include <cdem/core/parallel.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/particles/constraints.hpp>
#include <cdem/particles/inertia.hpp>
#include <cdem/particles/motion.hpp>

#include <concepts>
#include <functional>
#include <string>

namespace cdem::integrate {

/// Knows the number of particles it acts on.
template <class F>
concept KnowsParticleCount = requires(const F& forces) {
  { forces.particle_count() } -> std::convertible_to<std::size_t>;
};

/// `forces.evaluate(displacement, force, pool)` overwrites `force` with the internal forces (N, N m).
template <class F>
concept EvaluatesForces =
    requires(const F& forces, const particles::SpatialField<>& displacement, particles::SpatialField<>& force,
             core::ThreadPool& pool) { forces.evaluate(displacement, force, pool); };

/// `forces.elastic_energy(displacement, pool)` in J, of which the internal forces are minus the gradient.
template <class F>
concept GivesElasticEnergy =
    requires(const F& forces, const particles::SpatialField<>& displacement, core::ThreadPool& pool) {
      { forces.elastic_energy(displacement, pool) } -> std::convertible_to<double>;
    };

/// `forces.diagonal_block(i)` is the 6x6 block of the stiffness that couples particle i with itself.
template <class F>
concept GivesDiagonalBlock = requires(const F& forces, ParticleIndex i) {
  { forces.diagonal_block(i) } -> std::convertible_to<Eigen::Matrix<double, 6, 6>>;
};

/// The internal forces of a body, as an integrator sees them. Models: bond::LinearForces.
template <class F>
concept InternalForces = KnowsParticleCount<F> && EvaluatesForces<F> && GivesElasticEnergy<F> && GivesDiagonalBlock<F>;

/// What is to be moved: internal forces, inertia, prescribed degrees of freedom and external loads.
///
/// It refers to its parts; they must outlive it.
template <InternalForces Forces>
struct Problem {
  const Forces& forces;
  const particles::Inertia& inertia;
  const particles::Constraints& constraints;
  const particles::SpatialField<>* load = nullptr; ///< [particles] N, N m; none when null

  /// @throws core::InvalidInput if the parts are of different sizes, a mass, moment or load is not finite, a mass or
  ///         moment is not positive, or a constraint names a particle that does not exist
  void validate() const {
    const std::size_t count = forces.particle_count();
    const std::string expected = "the number of particles, " + std::to_string(count) + ", is expected";
    core::expect(count > 0, "number of particles", count, "at least 1 is expected");
    core::expect(inertia.mass.size() == count && inertia.moment.size() == count, "number of masses",
                 inertia.mass.size(), expected);
    core::expect(!load || load->size() == count, "number of loads", load ? load->size() : 0, expected);
    for (std::size_t i = 0; i < count; ++i) {
      core::expect_positive(inertia.mass[i], "mass of particle " + std::to_string(i), "kg");
      core::expect_positive(inertia.moment[i], "moment of inertia of particle " + std::to_string(i), "kg m^2");
      if (load)
        for (int dof = 0; dof < 6; ++dof)
          core::expect_finite((*load)[i][dof], "load on particle " + std::to_string(i));
    }
    for (const auto& constraint : constraints.list())
      core::expect(constraint.particle < count, "constrained particle", constraint.particle,
                   "a number below " + std::to_string(count) + " is expected");
  }
};

/// Energies of a body, J. What came in equals what is there: work = kinetic + elastic + dissipated.
struct EnergyLedger {
  double kinetic = 0;       ///< sum of m v^2/2 + I w^2/2
  double elastic = 0;       ///< of the bonds
  double external_work = 0; ///< of the prescribed motion (reactions) and of the loads, since the start
  double dissipated = 0;    ///< by damping, since the start
  double initial = 0;       ///< kinetic and elastic at the start

  /// What is missing or too much, J: 0 for exact bookkeeping.
  double imbalance() const { return initial + external_work - kinetic - elastic - dissipated; }
};

/// Where a run stands, shown to its observer after every step.
struct Step {
  const particles::Motion& motion;
  /// [particles] N, N m: what must act on each particle from outside; the reaction on a prescribed degree of freedom
  const particles::SpatialField<>& reaction;
};

} // namespace cdem::integrate
