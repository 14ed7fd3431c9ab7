#pragma once

/// @file
/// What an integrator needs from a body's internal forces, and what an integrator is.

#include <cdem/core/parallel.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/particles/constraints.hpp>
#include <cdem/particles/inertia.hpp>
#include <cdem/particles/motion.hpp>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace cdem::integrate {

/// Knows the number of particles it acts on.
template <class F>
concept KnowsParticleCount = requires(const F& forces) {
  { forces.particle_count() } -> std::convertible_to<std::size_t>;
};

/// `forces.evaluate(displacement, force, pool)` overwrites `force` with the internal forces (N, N m).
template <class F>
concept EvaluatesForces = requires(const F& forces, const particles::SpatialField<>& displacement,
                                   particles::SpatialField<>& force, core::ThreadPool& pool) {
  forces.evaluate(displacement, force, pool);
};

/// `forces.elastic_energy(displacement, pool)` in J, of which the internal forces are minus the gradient.
template <class F>
concept GivesElasticEnergy = requires(const F& forces, const particles::SpatialField<>& displacement,
                                      core::ThreadPool& pool) {
  { forces.elastic_energy(displacement, pool) } -> std::convertible_to<double>;
};

/// `forces.diagonal_block(i)` is the 6x6 block of the stiffness that couples particle i with itself.
template <class F>
concept GivesDiagonalBlock = requires(const F& forces, ParticleIndex i) {
  // same_as, since Eigen's matrices of all sizes convert into each other as far as the compiler can tell
  { forces.diagonal_block(i) } -> std::same_as<Eigen::Matrix<double, 6, 6>>;
};

/// The internal forces of a body, as an integrator sees them. Models: bond::LinearForces, bond::BondForces.
template <class F>
concept InternalForces =
    KnowsParticleCount<F> && EvaluatesForces<F> && GivesElasticEnergy<F> && GivesDiagonalBlock<F>;

/// `forces.advance(displacement, force, pool)` evaluates and accepts the displacement: what the forces remember follows
/// it. Not needed; forces that have it are advanced at every accepted step.
template <class F>
concept AdvancesState = requires(F& forces, const particles::SpatialField<>& displacement,
                                 particles::SpatialField<>& force, core::ThreadPool& pool) {
  forces.advance(displacement, force, pool);
};

/// `forces.dissipated_energy()` in J, what the forces lost since the beginning. Not needed.
template <class F>
concept BooksDissipation = requires(const F& forces) {
  { forces.dissipated_energy() } -> std::convertible_to<double>;
};

/// `forces.tangent(displacement, pool)` are the linear forces of a small motion from there. Not needed where forces are
/// linear themselves.
template <class F>
concept GivesTangent = requires(const F& forces, const particles::SpatialField<>& displacement,
                                core::ThreadPool& pool) {
  forces.tangent(displacement, pool);
};

/// @throws core::InvalidInput unless `field` (called `name` in the message) has `count` entries, all finite
/// @complexity O(count)
inline void expect_finite_field(const particles::SpatialField<>& field, std::size_t count,
                                std::string_view name) {
  if (field.size() != count) [[unlikely]]
    core::reject("number of entries of the " + std::string(name), field.size(),
                 "the number of particles, " + std::to_string(count) + ", is expected");
  for (std::size_t i = 0; i < count; ++i)
    for (int dof = 0; dof < 6; ++dof)
      if (!std::isfinite(field[i][dof])) [[unlikely]]
        core::reject(std::string(name) + " of particle " + std::to_string(i) + ", degree of freedom " +
                         std::to_string(dof),
                     field[i][dof], "a finite number is expected");
}

/// What is to be moved: internal forces, inertia, prescribed degrees of freedom and external loads.
///
/// It refers to its parts; they must outlive it.
template <InternalForces Forces>
struct Problem {
  /// Forces that remember are changed by what is done with them.
  std::conditional_t<AdvancesState<Forces>, Forces&, const Forces&> forces;
  const particles::Inertia& inertia;
  const particles::Constraints& constraints;
  const particles::SpatialField<>* load = nullptr; ///< [particles] N, N m; none when null

  /// @throws core::InvalidInput if the parts are of different sizes, a load is not finite, a mass or moment is
  ///         not a finite number above zero, or a constraint names a particle that does not exist
  void validate() const {
    const std::size_t count = forces.particle_count();
    core::expect(count > 0, "number of particles", count, "at least 1 is expected");
    inertia.validate(count);
    if (load)
      expect_finite_field(*load, count, "load");
    for (const auto& constraint : constraints.list())
      if (constraint.particle >= count) [[unlikely]]
        core::reject("constrained particle", constraint.particle,
                     "a number below " + std::to_string(count) + " is expected");
  }
};

template <class Forces>
Problem(const Forces&, const particles::Inertia&, const particles::Constraints&,
        const particles::SpatialField<>* = nullptr) -> Problem<Forces>;

/// Internal forces at a displacement that an integrator accepts. @param force [particles] N, N m, overwritten
template <InternalForces Forces>
void accept(const Problem<Forces>& problem, const particles::SpatialField<>& displacement,
            particles::SpatialField<>& force, core::ThreadPool& pool) {
  if constexpr (AdvancesState<Forces>)
    problem.forces.advance(displacement, force, pool);
  else
    problem.forces.evaluate(displacement, force, pool);
}

/// Internal forces at a displacement on a static solver's way. @param force [particles] N, N m, overwritten
///
/// Forces that remember orientations alone follow the way, so that no rotation between two iterates is large; those that
/// lose energy on it are only tried.
template <InternalForces Forces>
void follow(const Problem<Forces>& problem, const particles::SpatialField<>& displacement,
            particles::SpatialField<>& force, core::ThreadPool& pool) {
  if constexpr (BooksDissipation<Forces>)
    problem.forces.evaluate(displacement, force, pool);
  else
    accept(problem, displacement, force, pool);
}

/// Energies of a body, J. What came in equals what is there: initial + work = kinetic + elastic + dissipated.
struct EnergyLedger {
  double kinetic = 0;       ///< sum of m v^2/2 + I w^2/2
  double elastic = 0;       ///< of the bonds
  double external_work = 0; ///< of the prescribed motion (reactions) and of the loads, since the first step
  double dissipated = 0;    ///< by damping since the first step, and by the bonds since they were made
  double initial = 0;       ///< kinetic and elastic at the first step, and lost by the bonds before it

  /// What is missing (below 0: too much), J. For velocity Verlet it falls as the square of the time step.
  double imbalance() const { return initial + external_work - kinetic - elastic - dissipated; }
};

/// Kinetic energy of a body, J. @complexity O(particles)
inline double kinetic_energy(const particles::Inertia& inertia, const particles::SpatialField<>& velocity,
                             core::ThreadPool& pool) {
  return core::parallel_sum(pool, velocity.size(), 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i)
      sum += 0.5 * (inertia.mass[i] * velocity[i].linear().squaredNorm() +
                    inertia.moment[i] * velocity[i].angular().squaredNorm());
    return sum;
  });
}

/// The ledger of a motion as it stands. @complexity O(bonds)
template <InternalForces Forces>
EnergyLedger energy_ledger(const Problem<Forces>& problem, const particles::Motion& motion,
                           core::ThreadPool& pool) {
  EnergyLedger ledger{kinetic_energy(problem.inertia, motion.velocity, pool),
                      problem.forces.elastic_energy(motion.displacement, pool), motion.energy.external_work,
                      motion.energy.dissipated, motion.energy.initial};
  if constexpr (BooksDissipation<Forces>)
    ledger.dissipated += problem.forces.dissipated_energy();
  return ledger;
}

/// Where a run stands, shown to its observer after every step.
struct Step {
  const particles::Motion& motion;
  /// [constraints] N or N m, in the order of Constraints::list(): what holds or moves each prescribed degree
  /// of freedom
  std::span<const double> reaction;
};

/// How a run ended.
enum class Ending : std::uint8_t {
  all_steps, ///< the steps asked for are done
  observer,  ///< the observer had seen enough
  tolerance, ///< a static solver met its tolerance
};

/// What holds or moves each prescribed degree of freedom of a body at rest: minus the internal force and the
/// load.
///
/// @return  [constraints] N or N m, in the order of Constraints::list()
template <InternalForces Forces>
std::vector<double> static_reactions(const Problem<Forces>& problem, const particles::Motion& motion,
                                     core::ThreadPool& pool) {
  particles::SpatialField<> force(motion.size());
  problem.forces.evaluate(motion.displacement, force, pool);
  std::vector<double> reaction;
  reaction.reserve(problem.constraints.size());
  for (const auto& constraint : problem.constraints.list())
    reaction.push_back(-force[constraint.particle][constraint.dof] -
                       (problem.load ? (*problem.load)[constraint.particle][constraint.dof] : 0));
  return reaction;
}

namespace detail {
/// The least that internal forces are; concepts try integrators on it.
struct AnyForces {
  std::size_t particle_count() const;
  void evaluate(const particles::SpatialField<>&, particles::SpatialField<>&, core::ThreadPool&) const;
  double elastic_energy(const particles::SpatialField<>&, core::ThreadPool&) const;
  Eigen::Matrix<double, 6, 6> diagonal_block(ParticleIndex) const;
};
static_assert(InternalForces<AnyForces>);

/// The least that linear forces are, whose single bonds are known; solvers of statics are tried on it.
struct AnyLinearForces : AnyForces {
  struct Stiffness {
    double normal, tangential, torsion, bending;
  };
  std::size_t bond_count() const;
  std::pair<ParticleIndex, ParticleIndex> ends(BondIndex) const;
  Vec3 direction(BondIndex) const;
  double length(BondIndex) const;
  Stiffness stiffness(BondIndex) const;
  std::span<const BondIndex> bonds_of(ParticleIndex) const;
};
} // namespace detail

/// Made from its `Parameters`, accounts for itself in a `Report`.
template <class I>
concept HasParametersAndReport = requires {
  typename I::Parameters;
  typename I::Report;
}
&&std::constructible_from<I, typename I::Parameters>;

/// `integrator.run(problem, motion, steps, pool)` advances a motion in time.
template <class I>
concept AdvancesMotion = requires(const I& integrator, const Problem<detail::AnyForces>& problem,
                                  particles::Motion& motion, std::uint64_t steps, core::ThreadPool& pool) {
  { integrator.run(problem, motion, steps, pool) } -> std::same_as<typename I::Report>;
};

/// `integrator.solve(problem, motion, pool)` finds the equilibrium at unit time, at least of linear forces.
template <class I>
concept SolvesStatics = requires(const I& integrator, const Problem<detail::AnyLinearForces>& problem,
                                 particles::Motion& motion, core::ThreadPool& pool) {
  { integrator.solve(problem, motion, pool) } -> std::same_as<typename I::Report>;
};

/// A way from forces to displacements. Models: VelocityVerlet, StaticMultigrid.
template <class I>
concept Integrator = HasParametersAndReport<I> &&(AdvancesMotion<I> || SolvesStatics<I>);

} // namespace cdem::integrate
