#pragma once

/// @file
/// What a tension test is watched for: moduli over time, their averages, convergence, energies, mean bond forces.

#include <cdem/homogenize/running_average.hpp>
#include <cdem/homogenize/tension_gauge.hpp>
#include <cdem/integrate/integrator.hpp>

#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace cdem::homogenize {

/// One sample of the curves of figure 5, [L17] section 2.3.
struct TensionSample {
  double step = 0;                   ///< number of the step
  double time = 0;                   ///< s
  double youngs_modulus = 0;         ///< E at this step, Pa
  double youngs_modulus_average = 0; ///< over all steps so far, Pa
  double youngs_modulus_steady = 0;  ///< average over the steps from `steady_from` on, Pa; NaN before
  double poissons_ratio = 0;
  double poissons_ratio_average = 0;
  double poissons_ratio_steady = 0;
  double force_fixed = 0;  ///< N
  double force_loaded = 0; ///< N
  double kinetic = 0;      ///< J
  double elastic = 0;
  double external_work = 0;
  double dissipated = 0;
};

/// Moduli of a tension test by its different measures.
struct TensionModuli {
  double youngs_modulus = 0; ///< E_M, Pa, from the faces' motion over their own distance
  double poissons_ratio = 0; ///< nu_M, likewise
  double nominal_youngs_modulus =
      0; ///< Pa, with the side of the box as gauge length, as the paper defines it
  double interior_youngs_modulus = 0; ///< Pa, from the slope of displacement over the interior
  double interior_poissons_ratio = 0; ///< likewise
};

/// Watches a tension test step by step; an observer for integrate::VelocityVerlet::run().
///
/// Every step that it sees: E and nu from the faces, their averages over all steps so far and over those from
/// `steady_from` on, the paper's convergence rule on the first. Every `sample_every` steps: a point of the curves with its
/// energies and, once `steady_from` steps are done, the averages of what is proportional to the strain, each divided by the strain of its moment: bond forces, reactions,
/// the slopes of the interior. A static solution is a single step to be watched.
template <integrate::InternalForces Forces>
class TensionRecorder {
public:
  struct Parameters {
    std::uint64_t sample_every = 50;  ///< steps between samples
    std::uint64_t steady_from = 2500; ///< steps before the averages that leave out the first ones begin
    ConvergenceRule::Parameters convergence = {}; ///< for E and for nu
    TensionGauge::Parameters gauge = {};
  };

  /// Refers to its arguments; they must outlive it.
  TensionRecorder(const particles::ParticleSet& particles, const network::BondNetwork& network,
                  const boundary::TensionSetup& setup, const integrate::Problem<Forces>& problem,
                  core::ThreadPool& pool, Parameters parameters)
      : particles_(particles), setup_(setup), problem_(problem), pool_(pool), parameters_(parameters),
        gauge_(particles, network, setup, parameters.gauge), youngs_rule_(parameters.convergence),
        poissons_rule_(parameters.convergence) {
    core::expect(parameters_.sample_every > 0, "sample_every", parameters_.sample_every,
                 "at least 1 step is expected");
  }

  /// Watches one step; false once E and nu have both converged.
  bool operator()(const integrate::Step& step) {
    const FaceReading reading = gauge_.faces(step.motion.displacement, step.reaction);
    youngs_modulus_.add(reading.youngs_modulus());
    nominal_youngs_modulus_.add(reading.nominal_youngs_modulus());
    poissons_ratio_.add(reading.poissons_ratio());
    const std::uint64_t number = step.motion.step;
    if (number >= parameters_.steady_from) {
      youngs_modulus_steady_.add(reading.youngs_modulus());
      poissons_ratio_steady_.add(reading.poissons_ratio());
    }
    if (number % parameters_.sample_every == 0)
      sample(step, reading);
    const bool youngs = youngs_rule_.check(number, youngs_modulus_.mean());
    const bool poissons = poissons_rule_.check(number, poissons_ratio_.mean());
    return !(youngs && poissons);
  }

  /// Watches a static solution as the only step.
  void watch_equilibrium(const integrate::Step& step) {
    const FaceReading reading = gauge_.faces(step.motion.displacement, step.reaction);
    youngs_modulus_.add(reading.youngs_modulus());
    nominal_youngs_modulus_.add(reading.nominal_youngs_modulus());
    poissons_ratio_.add(reading.poissons_ratio());
    average_forces(step, reading);
  }

  /// Moduli, averaged over time.
  /// @throws core::NotReached before `steady_from` and the first sample after it
  TensionModuli moduli() const {
    expect_samples();
    const double stress_over_strain = fixed_force_.mean() / section();
    return {youngs_modulus_.mean(), poissons_ratio_.mean(), nominal_youngs_modulus_.mean(),
            stress_over_strain / interior_axial_.mean(),
            -interior_transverse_.mean() / interior_axial_.mean()};
  }

  bool converged() const { return youngs_rule_.converged() && poissons_rule_.converged(); }

  /// Curves of the run.
  const std::vector<TensionSample>& samples() const noexcept { return samples_; }

  /// Mean forces of the bonds at face strain `strain`, on each bond's first particle.
  /// @return  [bonds] N
  std::vector<Vec3> bond_forces(double strain) const {
    expect_samples();
    std::vector<Vec3> forces(bond_forces_);
    for (Vec3& force : forces)
      force *= strain;
    return forces;
  }
  /// Mean resultant on the fixed face at face strain `strain`, N.
  double force_fixed(double strain) const { return strain * fixed_force_.mean(); }
  /// Mean resultant on the loaded face at face strain `strain`, N.
  double force_loaded(double strain) const { return strain * loaded_force_.mean(); }
  /// Mean of sum of F (x) x over the reactions at face strain `strain`, axial component, N m: what the specimens' sum
  /// of V sigma must equal.
  double moment_of_reactions(double strain) const { return strain * moment_.mean(); }
  /// Cross section of the box, m^2.
  double section() const {
    const Vec3 size = setup_.box.size();
    return size.prod() / size[core::index_of(setup_.axis)];
  }
  /// Axial strain by the faces, as it stands.
  double strain(const particles::Motion& motion) const {
    const std::vector<double> none(setup_.constraints.size(), 0.0);
    return gauge_.faces(motion.displacement, none).axial_strain;
  }

  /// Shows everything that a run needs to go on, by name, to `visit(name, RunningAverage& | ConvergenceRule& |
  /// std::vector<Vec3>& | std::vector<TensionSample>&)`: to be written to a checkpoint or filled from one.
  template <class Visitor>
  void visit_state(Visitor&& visit) {
    visit("youngs_modulus", youngs_modulus_);
    visit("nominal_youngs_modulus", nominal_youngs_modulus_);
    visit("poissons_ratio", poissons_ratio_);
    visit("youngs_modulus_steady", youngs_modulus_steady_);
    visit("poissons_ratio_steady", poissons_ratio_steady_);
    visit("interior_axial", interior_axial_);
    visit("interior_transverse", interior_transverse_);
    visit("fixed_force", fixed_force_);
    visit("loaded_force", loaded_force_);
    visit("moment", moment_);
    visit("youngs_rule", youngs_rule_);
    visit("poissons_rule", poissons_rule_);
    visit("bond_forces", bond_forces_);
    visit("samples", samples_);
  }

private:
  void expect_samples() const {
    if (fixed_force_.count() == 0)
      throw core::NotReached("the tension test ended before its averages began, at step " +
                             std::to_string(parameters_.steady_from) + ": let it run longer");
  }

  void sample(const integrate::Step& step, const FaceReading& reading) {
    const integrate::EnergyLedger energy = integrate::energy_ledger(problem_, step.motion, pool_);
    const auto known = [](const RunningAverage& average) {
      return average.count() > 0 ? average.mean() : std::numeric_limits<double>::quiet_NaN();
    };
    samples_.push_back({static_cast<double>(step.motion.step), step.motion.time, reading.youngs_modulus(),
                        youngs_modulus_.mean(), known(youngs_modulus_steady_), reading.poissons_ratio(),
                        poissons_ratio_.mean(), known(poissons_ratio_steady_), reading.force_fixed,
                        reading.force_loaded, energy.kinetic, energy.elastic, energy.external_work,
                        energy.dissipated});
    if (step.motion.step >= parameters_.steady_from)
      average_forces(step, reading);
  }

  void average_forces(const integrate::Step& step, const FaceReading& reading) {
    const double strain = reading.axial_strain;
    fixed_force_.add(reading.force_fixed / strain);
    loaded_force_.add(reading.force_loaded / strain);
    const InteriorReading interior = gauge_.interior(step.motion.displacement);
    interior_axial_.add(interior.axial_strain / strain);
    interior_transverse_.add(interior.transverse_strain / strain);
    const int axis = core::index_of(setup_.axis);
    double moment = 0;
    for (std::size_t k = 0; k < setup_.constraints.size(); ++k) {
      const auto& constraint = setup_.constraints.list()[k];
      if (constraint.dof == axis)
        moment += step.reaction[k] * particles_.position[constraint.particle][axis];
    }
    moment_.add(moment / strain);
    problem_.forces.bond_forces(step.motion.displacement, scratch_, pool_);
    if (bond_forces_.empty())
      bond_forces_.assign(scratch_.size(), Vec3::Zero());
    const double part = 1 / static_cast<double>(fixed_force_.count());
    core::parallel_for(pool_, scratch_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        bond_forces_[b] += part * (scratch_[b] / strain - bond_forces_[b]);
    });
  }

  const particles::ParticleSet& particles_;
  const boundary::TensionSetup& setup_;
  integrate::Problem<Forces> problem_;
  core::ThreadPool& pool_;
  Parameters parameters_;
  TensionGauge gauge_;
  RunningAverage youngs_modulus_, nominal_youngs_modulus_, poissons_ratio_;
  RunningAverage youngs_modulus_steady_, poissons_ratio_steady_;
  RunningAverage interior_axial_, interior_transverse_, fixed_force_, loaded_force_,
      moment_; ///< over the strain
  ConvergenceRule youngs_rule_, poissons_rule_;
  std::vector<Vec3> bond_forces_; ///< [bonds] mean of force over strain, N
  std::vector<Vec3> scratch_;
  std::vector<TensionSample> samples_;
};

} // namespace cdem::homogenize
