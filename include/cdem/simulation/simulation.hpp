#pragma once

/// @file
/// The four policies composed: packing generator, bond law, integrator, stress estimator.

#include <cdem/bond/forces_of.hpp>
#include <cdem/boundary/symmetric_tension.hpp>
#include <cdem/integrate/integrator.hpp>
#include <cdem/simulation/specimen.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <optional>
#include <type_traits>

namespace cdem::simulation {

/// A body under a tension test, from the packing to the stress, with every stage a policy.
///
/// It composes and owns no physics: each stage is a function or class that can be used without it.
/// @tparam Generator     fills the box with spheres
/// @tparam Law           how every bond resists: any BondLaw, of which bond::ForcesOf makes the forces
/// @tparam IntegratorType moves the body, or finds its equilibrium
/// @tparam Stress        turns bond forces into stresses
template <packing::PackingGenerator Generator, bond::BondLaw Law, integrate::Integrator IntegratorType,
          stress::StressEstimator Stress>
class Simulation {
public:
  using Forces = bond::ForcesOf<Law>;

  struct Parameters {
    typename Generator::Parameters packing;
    double coordination = 6.2; ///< Z, [L17] section 2.1
    typename Law::Parameters law;
    std::vector<double> density = {1000}; ///< kg/m^3, one a phase
    typename IntegratorType::Parameters integrator;
    boundary::SymmetricTension boundary = {};
    int threads = 1; ///< 0: all processors
  };

  /// Packs, bonds, assembles and sets the boundary up.
  /// @throws core::InvalidInput for parameters that a stage does not accept; core::Interrupted
  Simulation(Parameters parameters, Stress stress, const core::Monitor& monitor = {})
      : pool_(parameters.threads), packing_(Generator(parameters.packing).pack(monitor)),
        specimen_(make_specimen(packing_.particles, packing_.box, parameters.coordination, pool_)),
        forces_(Law(parameters.law), specimen_.particles, specimen_.network),
        inertia_(particles::solid_spheres(specimen_.particles, parameters.density)),
        setup_(with_tolerance(parameters.boundary, specimen_)
                   .apply(specimen_.particles, specimen_.network, specimen_.box)),
        integrator_(parameters.integrator), stress_(std::move(stress)),
        motion_(particles::Motion::at_rest(specimen_.particles.size())) {}

  /// Moves the body by `steps`, or solves for its equilibrium at unit time. What bonds remember follows.
  template <class... Observer>
  requires integrate::AdvancesMotion<IntegratorType>
  auto run(std::uint64_t steps, Observer&&... observer) {
    return integrator_.run(problem(), motion_, steps, pool_, std::forward<Observer>(observer)...);
  }
  auto solve() requires integrate::SolvesStatics<IntegratorType> {
    return integrator_.solve(problem(), motion_, pool_);
  }

  /// Stress of each specimen as the body stands, Pa, and couple stress, N/m, of an estimator that has it.
  stress::StressField stress() {
    std::vector<Vec3> forces;
    forces_.bond_forces(motion_.displacement, forces, pool_);
    if constexpr (stress::EstimatesCoupleStress<Stress>) {
      std::vector<Vec3> moments;
      forces_.bond_moments(motion_.displacement, moments, pool_);
      return stress_.estimate(specimen_.particles, specimen_.network, stress::BondLoads{forces, moments});
    } else {
      return stress_.estimate(specimen_.particles, specimen_.network, forces);
    }
  }

  /// Energies as they stand, J.
  integrate::EnergyLedger energies() { return integrate::energy_ledger(problem(), motion_, pool_); }
  /// Reactions on the prescribed degrees of freedom of a body at rest, N.
  std::vector<double> reactions() { return integrate::static_reactions(problem(), motion_, pool_); }

  integrate::Problem<Forces> problem() { return {forces_, inertia_, setup_.constraints}; }
  integrate::Problem<Forces> problem() const requires(!integrate::AdvancesState<Forces>) {
    return {forces_, inertia_, setup_.constraints};
  }
  const typename Generator::Report& packing_report() const noexcept { return packing_.report; }
  const Specimen& specimen() const noexcept { return specimen_; }
  const Forces& forces() const noexcept { return forces_; }
  Forces& forces() noexcept { return forces_; } ///< to restore what they remember
  const particles::Inertia& inertia() const noexcept { return inertia_; }
  const boundary::TensionSetup& setup() const noexcept { return setup_; }
  const particles::Motion& motion() const noexcept { return motion_; }
  particles::Motion& motion() noexcept { return motion_; }
  core::ThreadPool& pool() noexcept { return pool_; }

private:
  static boundary::SymmetricTension with_tolerance(boundary::SymmetricTension tension,
                                                   const Specimen& specimen) {
    if (tension.tolerance == 0)
      tension.tolerance = specimen.gap();
    return tension;
  }

  core::ThreadPool pool_;
  packing::Packing<typename Generator::Report> packing_;
  Specimen specimen_;
  Forces forces_;
  particles::Inertia inertia_;
  boundary::TensionSetup setup_;
  IntegratorType integrator_;
  Stress stress_;
  particles::Motion motion_;
};

} // namespace cdem::simulation
