#pragma once

/// @file
/// The explicit integrator of the paper.

#include <cdem/integrate/critical_time_step.hpp>
#include <cdem/integrate/damping.hpp>
#include <cdem/integrate/integrator.hpp>

#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace cdem::integrate {

/// An observer that looks at nothing and lets all steps pass.
struct NoObserver {
  bool operator()(const Step&) const { return true; }
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
/// u = rate t from the first step on: position and velocity are imposed at once, and the kinetic energy so
/// given is booked as external work. Undamped on a linear body it conserves E_kin + E_el - dt^2/8 F.M^-1 F
/// over the free degrees of freedom, to rounding.
class VelocityVerlet {
public:
  struct Parameters {
    double time_step = 0; ///< dt, s
    Damping damping = {};
  };
  struct Report {
    std::uint64_t steps = 0; ///< done in this run
    Ending ending = Ending::all_steps;
    double seconds = 0; ///< wall clock
  };

  /// @throws core::InvalidInput for a step that is not positive or a damping that is negative
  explicit VelocityVerlet(Parameters parameters) : parameters_(parameters) {
    core::expect_positive(parameters_.time_step, "time_step", "s");
    parameters_.damping.validate();
  }

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Advances `motion` by at most `steps`.
  ///
  /// @param motion    from Motion::at_rest() or an earlier run; after an exception it is that of the last
  /// whole step,
  ///                  except after a blow-up, which leaves nothing of use
  /// @param observer  bool(const Step&), called after every step; false ends the run
  /// @throws          core::InvalidInput for a motion that does not fit, is not finite, or goes on under other
  ///                  constraints than it began with; core::Interrupted;
  ///                  core::NotReached when the run blows up, with the step and the likely cause
  /// @complexity      O(bonds) a step; two fields of the body's size (three with beta), allocated once
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
    while (report.steps < steps) {
      step(problem, motion, work, pool);
      ++report.steps;
      if (!observer(Step{motion, work.reaction})) {
        report.ending = Ending::observer;
        break;
      }
      const auto now = std::chrono::steady_clock::now();
      if (monitor.stop_requested() ||
          (monitor.listens() && now - last_report > std::chrono::milliseconds(200))) {
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

  struct Workspace {
    template <class P>
    Workspace(const P& problem, const Damping& damping)
        : force(problem.forces.particle_count()), reaction(problem.constraints.size()) {
      if (damping.beta > 0) {
        ahead.resize(force.size());
        damped.resize(force.size());
      }
    }
    Field force;                  ///< internal forces at the displacement
    Field ahead;                  ///< displacement + beta v*
    Field damped;                 ///< internal forces there
    std::vector<double> reaction; ///< [constraints]
  };

  /// Kinetic energy and power lost to damping, summed in block order.
  struct Sums {
    double kinetic = 0;
    double dissipated_power = 0;
    double load_power = 0;
    Sums& operator+=(const Sums& other) {
      kinetic += other.kinetic;
      dissipated_power += other.dissipated_power;
      load_power += other.load_power;
      return *this;
    }
  };

  template <class P>
  static void validate(const P& problem, const particles::Motion& motion) {
    const std::size_t count = problem.forces.particle_count();
    expect_finite_field(motion.displacement, count, "displacement");
    expect_finite_field(motion.velocity, count, "velocity");
    if (motion.acceleration.empty())
      return;
    expect_finite_field(motion.acceleration, count, "acceleration");
    for (const auto& [particle, dof, rate] : problem.constraints.list()) {
      const bool kept =
          motion.velocity[particle][dof] == rate && motion.displacement[particle][dof] == rate * motion.time;
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
    for (const auto& constraint : problem.constraints.list())
      motion.displacement[constraint.particle][constraint.dof] = constraint.rate * motion.time;
    motion.energy = {};
    motion.energy.initial = kinetic_energy(problem.inertia, motion.velocity, pool) +
                            problem.forces.elastic_energy(motion.displacement, pool);
    for (const auto& constraint : problem.constraints.list()) {
      double& velocity = motion.velocity[constraint.particle][constraint.dof];
      motion.energy.external_work += 0.5 * mass_of(problem.inertia, constraint) *
                                     (constraint.rate * constraint.rate - velocity * velocity);
      velocity = constraint.rate;
    }
    accelerate(problem, motion, work, pool, 0);
  }

  template <class P>
  void step(const P& problem, particles::Motion& motion, Workspace& work, core::ThreadPool& pool) const {
    const double dt = parameters_.time_step;
    motion.time += dt;
    ++motion.step;
    core::parallel_for(pool, motion.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (int c = 0; c < 8; ++c) {
          motion.velocity[i].component[c] += 0.5 * dt * motion.acceleration[i].component[c];
          motion.displacement[i].component[c] += dt * motion.velocity[i].component[c];
        }
    });
    for (const auto& constraint : problem.constraints.list()) {
      motion.velocity[constraint.particle][constraint.dof] = constraint.rate;
      motion.displacement[constraint.particle][constraint.dof] = constraint.rate * motion.time;
    }
    const particles::PathEnergy before = motion.energy;
    const double kinetic = accelerate(problem, motion, work, pool, 0.5 * dt);
    motion.energy.external_work += 0.5 * dt * (before.external_power + motion.energy.external_power);
    motion.energy.dissipated += 0.5 * dt * (before.dissipated_power + motion.energy.dissipated_power);
    const double given = std::abs(motion.energy.initial) + std::abs(motion.energy.external_work) +
                         std::abs(before.external_work);
    if (!(std::isfinite(given) && kinetic <= runaway_factor * given))
      blow_up(problem, motion, kinetic);
  }

  /// Acceleration at the displacement; completes the velocity, which lacks `advance` seconds of it. Returns
  /// the kinetic energy.
  template <class P>
  double accelerate(const P& problem, particles::Motion& motion, Workspace& work, core::ThreadPool& pool,
                    double advance) const {
    const double alpha = parameters_.damping.alpha, beta = parameters_.damping.beta;
    problem.forces.evaluate(motion.displacement, work.force, pool);
    if (beta > 0) {
      core::parallel_for(pool, motion.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          for (int c = 0; c < 8; ++c)
            work.ahead[i].component[c] =
                motion.displacement[i].component[c] +
                beta * (motion.velocity[i].component[c] + advance * motion.acceleration[i].component[c]);
      });
      problem.forces.evaluate(work.ahead, work.damped, pool);
    }
    const double implicit = 1 / (1 + alpha * advance);
    const auto sum = [&](std::size_t begin, std::size_t end) {
      Sums sums;
      for (std::size_t i = begin; i < end; ++i) {
        const double inverse[2] = {1 / problem.inertia.mass[i], 1 / problem.inertia.moment[i]};
        const double mass[2] = {problem.inertia.mass[i], problem.inertia.moment[i]};
        for (int c = 0; c < 8; ++c) {
          const double elastic = work.force[i].component[c];
          const double viscous = beta > 0 ? work.damped[i].component[c] - elastic : 0;
          const double load = problem.load ? (*problem.load)[i].component[c] : 0;
          const double free_acceleration = (elastic + viscous + load) * inverse[c / 4];
          double& velocity = motion.velocity[i].component[c];
          velocity = (velocity + advance * free_acceleration) * implicit;
          motion.acceleration[i].component[c] = free_acceleration - alpha * velocity;
          const double momentum = mass[c / 4] * velocity;
          sums.kinetic += 0.5 * momentum * velocity;
          sums.dissipated_power += alpha * momentum * velocity - viscous * velocity;
          sums.load_power += load * velocity;
        }
      }
      return sums;
    };
    Sums sums = core::parallel_sum(pool, motion.size(), Sums{}, sum);
    double reaction_power = 0;
    for (std::size_t k = 0; k < work.reaction.size(); ++k) {
      const auto& constraint = problem.constraints.list()[k];
      const double mass = mass_of(problem.inertia, constraint);
      double& velocity = motion.velocity[constraint.particle][constraint.dof];
      double& acceleration = motion.acceleration[constraint.particle][constraint.dof];
      const double elastic = work.force[constraint.particle][constraint.dof];
      const double viscous = beta > 0 ? work.damped[constraint.particle][constraint.dof] - elastic : 0;
      const double load = problem.load ? (*problem.load)[constraint.particle][constraint.dof] : 0;
      // what the loop above booked for this degree of freedom as if it were free is replaced
      const double wrong = velocity, right = constraint.rate;
      sums.kinetic += 0.5 * mass * (right * right - wrong * wrong);
      sums.dissipated_power += alpha * mass * (right * right - wrong * wrong) - viscous * (right - wrong);
      sums.load_power += load * (right - wrong);
      velocity = right;
      acceleration = 0;
      work.reaction[k] = alpha * mass * right - elastic - viscous - load;
      reaction_power += work.reaction[k] * right;
    }
    motion.energy.external_power = reaction_power + sums.load_power;
    motion.energy.dissipated_power = sums.dissipated_power;
    return sums.kinetic;
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
