#pragma once

/// @file
/// The explicit integrator of the paper.

#include <cdem/integrate/critical_time_step.hpp>
#include <cdem/integrate/damping.hpp>
#include <cdem/integrate/detail/verlet_step.hpp>
#include <cdem/integrate/integrator.hpp>
#include <cdem/integrate/loading.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <concepts>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace cdem::integrate {

/// An observer that looks at nothing and lets all steps pass.
struct NoObserver {
  bool operator()(const Step&) const { return true; }
};

/// `forces.evaluate_blockwise(displacement, zero, pool, use)` hands the forces on block by block instead of writing
/// a field, and returns the sum of what `use(begin, end, force)` gave. Not needed, but saves memory and time.
template <class F>
concept EvaluatesBlockwise = requires(const F& forces, const particles::SpatialField<>& displacement,
                                      core::ThreadPool& pool,
                                      double (*use)(std::size_t, std::size_t, const particles::Spatial<>*)) {
  { forces.evaluate_blockwise(displacement, 0.0, pool, use) } -> std::same_as<double>;
};

/// Velocity Verlet for translations and rotations with Rayleigh damping, [L17] section 2.2.
///
///     v(n+1/2) = v(n) + dt/2 a(n),    u(n+1) = u(n) + dt v(n+1/2)
///     a(n+1)   = M^-1 (f(u) + load - beta K v*) - alpha v(n+1),          v(n+1) = v(n+1/2) + dt/2 a(n+1)
///     v*       = v(n+1/2) + dt/2 a(n)
///
/// Second order, with damping too, and symplectic without it: alpha is taken at v(n+1), solved for in closed
/// form; beta at its extrapolation v*, which keeps the step explicit (v(n+1/2) in its place would be of first
/// order) and shortens the stable step by Damping::step_factor(). A prescribed degree of freedom moves as
/// u = rate s(t), s = t unless a ramp is asked for: position and velocity are imposed from the first step on, and the
/// kinetic energy so given, at once or by the reactions on a ramp, is booked as external work. Undamped on a linear body it conserves E_kin + E_el - dt^2/8 F.M^-1 F
/// over the free degrees of freedom, to rounding.
class VelocityVerlet {
public:
  struct Parameters {
    double time_step = 0; ///< dt, s
    Damping damping = {};
    /// The observer sees every step whose number is a multiple of this. A step that nobody sees keeps no velocity and
    /// acceleration of its own, which saves a third of what a step moves through memory.
    std::uint64_t observe_every = 1;
    Loading loading = {}; ///< how the prescribed rates set in
  };
  struct Report {
    std::uint64_t steps = 0; ///< done in this run
    Ending ending = Ending::all_steps;
    double seconds = 0; ///< wall clock
  };

  /// @throws core::InvalidInput for a step that is not positive, or a damping or ramp that is negative
  explicit VelocityVerlet(Parameters parameters) : parameters_(parameters) {
    core::expect_positive(parameters_.time_step, "time_step", "s");
    parameters_.damping.validate();
    parameters_.loading.validate();
    core::expect(parameters_.observe_every >= 1, "observe_every", parameters_.observe_every,
                 "1 step or more is expected");
  }

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Advances `motion` by at most `steps`.
  ///
  /// @param motion    from Motion::at_rest() or an earlier run; after an exception it is that of the last
  ///                  whole step, except after a blow-up, which leaves nothing of use
  /// @param observer  bool(const Step&), called after every step, or every observe_every-th; false ends the run
  /// @throws          core::InvalidInput for a motion that does not fit, is not finite, or goes on under other
  ///                  constraints or another loading than it began with; core::Interrupted;
  ///                  core::NotReached when the run blows up, with the step and the likely cause
  /// @complexity      O(bonds) a step; no field beside those of the motion (one for forces that are not evaluated
  ///                  blockwise, two more with beta)
  template <InternalForces Forces, class Observer = NoObserver>
  Report run(const Problem<Forces>& problem, particles::Motion& motion, std::uint64_t steps,
             core::ThreadPool& pool, Observer&& observer = {}, const core::Monitor& monitor = {}) const {
    problem.validate();
    validate(problem, motion);
    const auto start = std::chrono::steady_clock::now();
    Workspace work(problem, parameters_.damping);
    if (motion.acceleration.empty())
      begin(problem, motion, work, pool);
    Report report;
    auto last_report = start;
    bool whole = true;
    while (report.steps < steps) {
      const auto now = std::chrono::steady_clock::now();
      const bool report_due = monitor.stop_requested() ||
                              (monitor.listens() && now - last_report > std::chrono::milliseconds(200));
      const bool observed = !std::is_same_v<std::remove_cvref_t<Observer>, NoObserver> &&
                            (motion.step + 1) % parameters_.observe_every == 0;
      if (whole)
        drift(problem, motion, work, pool);
      else
        std::swap(motion.displacement, motion.acceleration);
      whole = observed || report_due || report.steps + 1 == steps;
      step(problem, motion, work, pool, whole);
      ++report.steps;
      if (observed && !observer(Step{motion, work.reaction})) {
        report.ending = Ending::observer;
        break;
      }
      if (report_due || (whole && monitor.stop_requested())) {
        last_report = now;
        monitor.report({"velocity Verlet", static_cast<double>(report.steps) / static_cast<double>(steps),
                        "step " + std::to_string(motion.step)});
      }
    }
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
  }

private:
  using Field = particles::SpatialField<>;
  using Sums = detail::StepSums;

  struct Workspace {
    template <class P>
    Workspace(const P& problem, const Damping& damping) : reaction(problem.constraints.size()) {
      if (damping.beta > 0) {
        ahead.resize(problem.forces.particle_count());
        damped.resize(ahead.size());
      }
    }
    Field force;                  ///< internal forces, where they are not evaluated blockwise
    Field ahead;                  ///< displacement + beta v*
    Field damped;                 ///< internal forces there
    std::vector<double> reaction; ///< [constraints]
  };

  template <class P>
  void validate(const P& problem, const particles::Motion& motion) const {
    const std::size_t count = problem.forces.particle_count();
    expect_finite_field(motion.displacement, count, "displacement");
    expect_finite_field(motion.velocity, count, "velocity");
    if (motion.acceleration.empty())
      return;
    expect_finite_field(motion.acceleration, count, "acceleration");
    const Loading::Amplitude now = parameters_.loading.at(motion.time);
    for (const auto& [particle, dof, rate] : problem.constraints.list()) {
      const bool kept = motion.velocity[particle][dof] == rate * now.speed &&
                        motion.displacement[particle][dof] == rate * now.way;
      if (!kept) [[unlikely]]
        core::reject("rate of the constraint on particle " + std::to_string(particle) +
                         ", degree of freedom " + std::to_string(dof),
                     rate,
                     "a motion goes on under the constraints it began with: it is at " +
                         core::to_text(motion.displacement[particle][dof]) + " and moves at " +
                         core::to_text(motion.velocity[particle][dof]));
    }
  }

  /// Imposes the prescribed positions and velocities and computes the first acceleration.
  template <class P>
  void begin(const P& problem, particles::Motion& motion, Workspace& work, core::ThreadPool& pool) const {
    motion.acceleration.resize(motion.size());
    const Loading::Amplitude now = parameters_.loading.at(motion.time);
    for (const auto& constraint : problem.constraints.list())
      motion.displacement[constraint.particle][constraint.dof] = constraint.rate * now.way;
    motion.energy = {};
    motion.energy.initial = kinetic_energy(problem.inertia, motion.velocity, pool) +
                            problem.forces.elastic_energy(motion.displacement, pool);
    for (const auto& constraint : problem.constraints.list()) {
      double& velocity = motion.velocity[constraint.particle][constraint.dof];
      const double imposed = constraint.rate * now.speed;
      motion.energy.external_work +=
          0.5 * mass_of(problem.inertia, constraint) * (imposed * imposed - velocity * velocity);
      velocity = imposed;
    }
    if (parameters_.damping.beta > 0)
      core::parallel_for(pool, motion.size(), [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
          for (int c = 0; c < 8; ++c)
            work.ahead[i].component[c] = motion.displacement[i].component[c] +
                                         parameters_.damping.beta * motion.velocity[i].component[c];
      });
    accelerate(problem, motion, work, pool, {.advance = 0, .whole = true});
    if constexpr (BooksDissipation<std::remove_cvref_t<decltype(problem.forces)>>)
      motion.energy.initial += problem.forces.dissipated_energy(); // what the bonds had lost by then
  }

  /// Forces, acceleration and velocity at the displacement; `whole` as in Stage.
  template <class P>
  void step(const P& problem, particles::Motion& motion, Workspace& work, core::ThreadPool& pool,
            bool whole) const {
    const double dt = parameters_.time_step;
    motion.time += dt;
    ++motion.step;
    const particles::PathEnergy before = motion.energy;
    const double kinetic = accelerate(problem, motion, work, pool, {.advance = 0.5 * dt, .whole = whole});
    motion.energy.external_work += 0.5 * dt * (before.external_power + motion.energy.external_power);
    motion.energy.dissipated += 0.5 * dt * (before.dissipated_power + motion.energy.dissipated_power);
    const double given = std::abs(motion.energy.initial) + std::abs(motion.energy.external_work) +
                         std::abs(before.external_work);
    if (!(std::isfinite(given) && kinetic <= runaway_factor * given))
      blow_up(problem, motion, kinetic);
  }

  /// Where in a step an evaluation of forces stands. The velocity of a prescribed degree of freedom is already that at the
  /// displacement's time.
  struct Stage {
    double advance; ///< s, by which the velocity is behind the displacement
    /// Leave velocity and acceleration at the displacement's time. Else go on at once: leave the velocity of the coming
    /// half step and, in the acceleration's place, the coming displacement.
    bool whole;
  };

  /// One pass over the bonds and particles. Returns the kinetic energy.
  template <class P>
  double accelerate(const P& problem, particles::Motion& motion, Workspace& work, core::ThreadPool& pool,
                    const Stage& stage) const {
    if (parameters_.damping.beta > 0)
      problem.forces.evaluate(work.ahead, work.damped, pool);
    const BlockStep<P> use{problem,
                           motion,
                           work,
                           parameters_,
                           stage,
                           parameters_.loading.at(motion.time),
                           parameters_.loading.at(motion.time + parameters_.time_step)};
    const Sums sums = with_forces(problem, motion.displacement, work.force, pool, use);
    motion.energy.external_power = sums.external_power;
    motion.energy.dissipated_power = sums.dissipated_power;
    return sums.kinetic;
  }

  /// What accelerate() does to the particles of one block, given the forces on them.
  template <class P>
  struct BlockStep {
    const P& problem;
    particles::Motion& motion;
    Workspace& work;
    const Parameters& parameters;
    Stage stage;
    Loading::Amplitude now, coming; ///< at the displacement's time, and a step later

    Sums operator()(std::size_t begin, std::size_t end, const particles::Spatial<>* force) const {
      const bool beta = parameters.damping.beta > 0;
      Sums sums = detail::step_block({.count = end - begin,
                                      .force = force,
                                      .damped = beta ? work.damped.data() + begin : nullptr,
                                      .load = problem.load ? problem.load->data() + begin : nullptr,
                                      .mass = problem.inertia.mass.data() + begin,
                                      .moment = problem.inertia.moment.data() + begin,
                                      .displacement = motion.displacement.data() + begin,
                                      .velocity = motion.velocity.data() + begin,
                                      .next = motion.acceleration.data() + begin,
                                      .ahead = beta ? work.ahead.data() + begin : nullptr,
                                      .time_step = parameters.time_step,
                                      .advance = stage.advance,
                                      .alpha = parameters.damping.alpha,
                                      .beta = parameters.damping.beta,
                                      .whole = stage.whole});
      for (std::size_t k = first_constraint(problem, begin); k < problem.constraints.size(); ++k) {
        if (problem.constraints.list()[k].particle >= end)
          break;
        impose(k, force[problem.constraints.list()[k].particle - begin], sums);
      }
      return sums;
    }

    /// Prescribed degree of freedom `k`: what was booked for it as if it were free is replaced.
    void impose(std::size_t k, const particles::Spatial<>& force, Sums& sums) const {
      const auto& [particle, dof, rate] = problem.constraints.list()[k];
      const double alpha = parameters.damping.alpha;
      const double mass = mass_of(problem.inertia, problem.constraints.list()[k]);
      const double elastic = force[dof];
      const double viscous = parameters.damping.beta > 0 ? work.damped[particle][dof] - elastic : 0;
      const double load = problem.load ? (*problem.load)[particle][dof] : 0;
      const double velocity = rate * now.speed;
      const double acceleration = rate * now.acceleration + 0.0; // 0, not -0, of a rate below 0
      const double as_free = detail::velocity_after(velocity, (elastic + viscous + load) * (1 / mass),
                                                    stage.advance, 1 / (1 + alpha * stage.advance));
      const double gained = velocity * velocity - as_free * as_free;
      sums.kinetic += 0.5 * mass * gained;
      sums.dissipated_power += alpha * mass * gained - viscous * (velocity - as_free);
      sums.external_power += load * (velocity - as_free);
      work.reaction[k] = alpha * mass * velocity - elastic - viscous - load + mass * acceleration;
      sums.external_power += work.reaction[k] * velocity;
      motion.velocity[particle][dof] = stage.whole ? velocity : rate * coming.speed;
      motion.acceleration[particle][dof] = stage.whole ? acceleration : rate * coming.way;
      if (!stage.whole && parameters.damping.beta > 0)
        work.ahead[particle][dof] = rate * coming.way + parameters.damping.beta * (rate * coming.speed);
    }
  };

  /// Sum of use(begin, end, force) over blocks of particles, in block order.
  template <class Forces, class Use>
  static Sums with_forces(const Problem<Forces>& problem, const Field& displacement, Field& force,
                          core::ThreadPool& pool, const Use& use) {
    if constexpr (EvaluatesBlockwise<Forces>) {
      return problem.forces.evaluate_blockwise(displacement, Sums{}, pool, use);
    } else {
      force.resize(displacement.size());
      accept(problem, displacement, force, pool);
      return core::parallel_sum(pool, displacement.size(), Sums{}, [&](std::size_t begin, std::size_t end) {
        return use(begin, end, force.data() + begin);
      });
    }
  }

  /// From a whole step on: the velocity of the coming half step and the coming displacement.
  template <class P>
  void drift(const P& problem, particles::Motion& motion, Workspace& work, core::ThreadPool& pool) const {
    const double dt = parameters_.time_step, beta = parameters_.damping.beta;
    core::parallel_for(pool, motion.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (int c = 0; c < 8; ++c) {
          const double gain = 0.5 * dt * motion.acceleration[i].component[c];
          double &u = motion.displacement[i].component[c], &v = motion.velocity[i].component[c];
          v += gain;
          u += dt * v;
          if (beta > 0)
            work.ahead[i].component[c] = u + beta * (v + gain);
        }
    });
    const Loading::Amplitude coming = parameters_.loading.at(motion.time + dt);
    for (const auto& [particle, dof, rate] : problem.constraints.list()) {
      motion.displacement[particle][dof] = rate * coming.way;
      motion.velocity[particle][dof] = rate * coming.speed;
      if (beta > 0)
        work.ahead[particle][dof] =
            motion.displacement[particle][dof] + beta * motion.velocity[particle][dof];
    }
  }

  /// Number in the list of the first constraint on particle `begin` or a later one.
  template <class P>
  static std::size_t first_constraint(const P& problem, std::size_t begin) {
    const auto& list = problem.constraints.list();
    return static_cast<std::size_t>(
        std::lower_bound(list.begin(), list.end(), begin,
                         [](const particles::Constraint& constraint, std::size_t particle) {
                           return constraint.particle < particle;
                         }) -
        list.begin());
  }

  static double mass_of(const particles::Inertia& inertia, const particles::Constraint& constraint) {
    return constraint.dof < 3 ? inertia.mass[constraint.particle] : inertia.moment[constraint.particle];
  }

  template <class P>
  [[noreturn]] void blow_up(const P& problem, const particles::Motion& motion, double kinetic) const {
    const CriticalTimeStep critical = critical_time_step(problem.forces, problem.inertia);
    const double stable = critical.time_step * parameters_.damping.step_factor(critical.angular_frequency);
    std::string cause;
    if (parameters_.time_step > stable)
      cause = "time_step = " + core::to_text(parameters_.time_step) +
              " s is above the step that is surely stable, " + core::to_text(stable) +
              " s (set by particle " + std::to_string(critical.particle) +
              "): take a smaller step, or scale the density";
    else
      cause = "time_step = " + core::to_text(parameters_.time_step) +
              " s is below the step that is stable for a linear body, " + core::to_text(stable) +
              " s: look at the load or at a bond law whose stiffness grows";
    throw core::NotReached("velocity Verlet blew up at step " + std::to_string(motion.step) +
                           " (t = " + core::to_text(motion.time) + " s): the kinetic energy is " +
                           core::to_text(kinetic) + " J, the energy given to the body " +
                           core::to_text(motion.energy.initial + motion.energy.external_work) +
                           " J. Likely cause: " + cause);
  }

  /// A stable run's kinetic energy stays below the energy given to it, but for the overshoot near the limit.
  static constexpr double runaway_factor = 1e6;

  Parameters parameters_;
};

static_assert(Integrator<VelocityVerlet>);

} // namespace cdem::integrate
