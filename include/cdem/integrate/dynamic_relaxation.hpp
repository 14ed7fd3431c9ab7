#pragma once

/// @file
/// Static equilibrium by dynamic relaxation: for any internal forces, non-linear ones included.

#include <cdem/integrate/critical_time_step.hpp>
#include <cdem/integrate/integrator.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace cdem::integrate {

/// Finds the equilibrium by an explicit motion of fictitious masses with kinetic damping (Cundall 1976; Barnes 1999).
///
///     v <- v + dt M^-1 r,  u <- u + dt v,  r = load + f(u) on the free degrees of freedom
///     where r.v turns negative, the kinetic energy has passed a peak: half a step back, to about there, and v = 0
///
/// Every particle gets the mass and the moment that make its own 6x6 block set the same step: in units of that
/// time no frequency of a linear body exceeds sqrt(2) (see critical_time_step()), and dt is 0.98 of the step that
/// is then surely stable. There is nothing to tune and no lowest frequency to estimate.
///
/// Where forces stiffen with displacement, diagonal_block() bounds nothing. So each step measures the curvature
/// along itself, omega^2 = v.(r_before - r_after) / (dt v.M v); a step longer than that allows (omega dt > 2) is taken
/// back and dt is shortened; it grows again by 5 % at every peak.
///
/// For linear bonds StaticMultigrid does less work from about 1,000 particles on, and the more so the larger the body:
/// docs/integration.md has the figures, and those of the methods that were tried beside this one.
class DynamicRelaxation {
public:
  struct Parameters {
    double relative_residual =
        1e-8; ///< wanted: residual over that of the prescribed motion with all else at rest
    std::uint64_t max_steps = 100000;
  };

  /// How a solution went.
  struct Report {
    std::uint64_t steps = 0; ///< explicit steps done
    std::uint64_t evaluations =
        0;                     ///< of the forces: one a step and a peak, two to begin with a guess, else one
    std::uint64_t peaks = 0;   ///< of the kinetic energy, each the end of a motion
    std::uint64_t retakes = 0; ///< steps taken back since the forces had stiffened; 0 for linear forces
    double relative_residual = 0; ///< of the displacement returned, from forces evaluated at it
    Ending ending = Ending::tolerance;
    double seconds = 0; ///< wall clock
  };

  /// @throws core::InvalidInput naming the parameter that is out of range
  DynamicRelaxation() : DynamicRelaxation(Parameters{}) {}
  explicit DynamicRelaxation(Parameters parameters) : parameters_(parameters) {
    core::expect(parameters.relative_residual > 0 && parameters.relative_residual < 1,
                 "relative_residual of the dynamic relaxation", parameters.relative_residual,
                 "a number between 0 and 1 is expected");
    core::expect(parameters.max_steps >= 1, "max_steps of the dynamic relaxation", parameters.max_steps,
                 "at least 1 is expected");
  }

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Solves for the displacement.
  ///
  /// The residual is the norm of the out-of-balance forces on the free degrees of freedom, moments divided by the
  /// length sqrt(sum tr K_rotation / sum tr K_translation) over the diagonal blocks. It is measured by its value at
  /// the prescribed motion with all else at zero; if that is zero, by its value at the initial guess.
  ///
  /// A body that nothing holds comes to rest if its loads balance; else it gains speed until max_steps. A particle
  /// without stiffness (a rattler) stays where the guess has it.
  /// Forces with a memory of the path are tried from what they remember and accept the equilibrium found: where bonds may
  /// break on the way, take the load in steps.
  /// @param problem  its constraints' rates are read at unit time: m and rad. Inertia is not used.
  /// @param motion   displacement: initial guess in, solution out. Velocity, time and step are left alone.
  /// @return         bitwise the same displacement for any number of threads
  /// @throws core::InvalidInput  for a problem that does not fit together, a guess that is not finite, or a load on
  ///                             a free degree of freedom whose diagonal stiffness is zero
  /// @throws core::NotReached    if max_steps do not suffice or the forces are not finite: says the residual and the
  ///                             likely cause; the motion then holds the last iterate
  /// @throws core::Interrupted   if the monitor asks to stop, between two steps: going on from the motion is a restart
  /// @complexity O(bonds) a step; steps grow with the body's number of particles across, see docs/integration.md. Two
  ///             fields of the body's size (three at the start) and 17 bytes a particle
  template <InternalForces Forces>
  Report solve(const Problem<Forces>& problem, particles::Motion& motion, core::ThreadPool& pool,
               const core::Monitor& monitor = {}) const {
    return Solve<Forces>(parameters_, problem, motion, pool, monitor).run();
  }

private:
  template <class Forces>
  class Solve;

  Parameters parameters_;
};

/// One solution, from the problem to the report.
template <class Forces>
class DynamicRelaxation::Solve {
public:
  Solve(const Parameters& parameters, const Problem<Forces>& problem, particles::Motion& motion,
        core::ThreadPool& pool, const core::Monitor& monitor)
      : parameters_(parameters), problem_(problem), motion_(motion), pool_(pool), monitor_(monitor) {}

  Report run() {
    const auto start = Clock::now();
    last_tell_ = start;
    problem_.validate();
    expect_finite_field(motion_.displacement, problem_.forces.particle_count(), "initial displacement");
    mark_held();
    choose_masses();
    residual_.resize(motion_.size());
    velocity_.resize(motion_.size());
    reference_ = prescribe();
    const double wanted = parameters_.relative_residual * reference_;
    start_norm_ = norm_;
    while (!(norm_ <= wanted)) {
      if (report_.steps == parameters_.max_steps)
        fail("more steps may suffice");
      step();
      tell(wanted);
    }
    accept(problem_, motion_.displacement, residual_, pool_);
    report_.relative_residual = reference_ > 0 ? norm_ / reference_ : 0;
    report_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return report_;
  }

private:
  using Clock = std::chrono::steady_clock;
  using Field = particles::SpatialField<>;

  /// What the masses resist a force with: 0 where nothing is stiff, which leaves the particle at rest.
  struct Mobility {
    double linear = 0;  ///< 1/kg, in the unit of mass of a step of 1 s
    double angular = 0; ///< 1/(kg m^2)
  };

  /// Sums over the body that a step looks at.
  struct Sums {
    double power = 0;  ///< r.v, W
    double square = 0; ///< v.M v, J; or the residual squared, N^2
    Sums& operator+=(const Sums& other) {
      power += other.power;
      square += other.square;
      return *this;
    }
  };

  void mark_held() {
    held_.assign(motion_.size(), 0);
    for (const auto& constraint : problem_.constraints.list())
      held_[constraint.particle] =
          static_cast<std::uint8_t>(held_[constraint.particle] | 1U << constraint.dof);
  }
  bool is_held(std::size_t i, int dof) const { return held_[i] >> dof & 1; }

  /// Mass and moment in the ratio of the particle's mean stiffnesses, then both scaled so that M^-1 K_ii has the
  /// largest eigenvalue 1.
  void choose_masses() {
    mobility_.resize(motion_.size());
    struct Traces {
      double linear = 0, angular = 0;
      Traces& operator+=(const Traces& other) {
        linear += other.linear;
        angular += other.angular;
        return *this;
      }
    };
    const Traces traces =
        core::parallel_sum(pool_, mobility_.size(), Traces{}, [&](std::size_t begin, std::size_t end) {
          Traces sum;
          for (std::size_t i = begin; i < end; ++i) {
            const detail::Matrix6 block = problem_.forces.diagonal_block(static_cast<ParticleIndex>(i));
            if (!block.allFinite())
              throw core::NotReached("dynamic relaxation: the stiffness of particle " + std::to_string(i) +
                                     " is not finite");
            expect_resisted_load(i, block);
            mobility_[i] = mobility_of(block);
            sum += {block.topLeftCorner<3, 3>().trace(), block.bottomRightCorner<3, 3>().trace()};
          }
          return sum;
        });
    if (traces.linear > 0 && traces.angular > 0)
      length_squared_ = traces.angular / traces.linear;
  }

  static Mobility mobility_of(const detail::Matrix6& block) {
    const double linear = block.topLeftCorner<3, 3>().trace(),
                 angular = block.bottomRightCorner<3, 3>().trace();
    Mobility mobility{linear > 0 ? 1 / linear : 0, angular > 0 ? 1 / angular : 0};
    Eigen::Matrix<double, 6, 1> scale;
    scale << Vec3::Constant(std::sqrt(mobility.linear)), Vec3::Constant(std::sqrt(mobility.angular));
    const double largest =
        detail::largest_eigenvalue(detail::Matrix6(scale.asDiagonal() * block * scale.asDiagonal()));
    if (largest > 0)
      mobility = {mobility.linear / largest, mobility.angular / largest};
    return mobility;
  }

  void expect_resisted_load(std::size_t i, const detail::Matrix6& block) const {
    if (!problem_.load)
      return;
    for (int dof = 0; dof < 6; ++dof) {
      const double load = (*problem_.load)[i][dof];
      if (load != 0 && !is_held(i, dof) && !(block(dof, dof) > 0)) [[unlikely]]
        core::reject((dof < 3 ? "force on particle " : "moment on particle ") + std::to_string(i) +
                         " along " + "xyz"[dof % 3],
                     load, "no bond of the particle resists it: 0 is expected");
    }
  }

  /// Puts the prescribed values into the displacement and finds its residual; returns what residuals are measured by.
  double prescribe() {
    Field prescribed(motion_.size());
    for (const auto& constraint : problem_.constraints.list()) {
      prescribed[constraint.particle][constraint.dof] = constraint.rate;
      motion_.displacement[constraint.particle][constraint.dof] = constraint.rate;
    }
    const bool guessed = !std::equal(
        prescribed.begin(), prescribed.end(), motion_.displacement.begin(),
        [](const auto& a, const auto& b) { return a.linear() == b.linear() && a.angular() == b.angular(); });
    balance(prescribed);
    const double reference = norm_;
    if (guessed)
      balance(motion_.displacement);
    if (!std::isfinite(reference) || !std::isfinite(norm_))
      throw core::NotReached("dynamic relaxation: the forces at the initial displacement are not finite");
    return reference > 0 ? reference : norm_;
  }

  void step() {
    const double dt = safety * std::sqrt(2 / stiffening_);
    const Sums before = advance(motion_begins_ ? 0.5 * dt : dt, dt); // v is that of half a step later
    if (before.square == 0)
      fail("what is out of balance are forces on degrees of freedom whose diagonal stiffness is zero");
    const double after = balance(motion_.displacement);
    ++report_.steps;
    ++steps_since_peak_;
    motion_begins_ = false;
    const double curvature = (before.power - after) / (dt * before.square); // omega^2 along the step
    if (!(curvature * dt * dt <= stable_curvature)) {
      retake(dt, curvature);
    } else if (after < 0) {
      move_back(0.5 * dt);
      stiffening_ = std::max(1.0, 0.9 * stiffening_);
      ++report_.peaks;
      steps_since_peak_ = 0;
    }
  }

  /// v += gain M^-1 r, u += dt v; returns r.v and v.M v.
  Sums advance(double gain, double dt) {
    return core::parallel_sum(pool_, motion_.size(), Sums{}, [&](std::size_t begin, std::size_t end) {
      Sums sum;
      for (std::size_t i = begin; i < end; ++i) {
        const Mobility mobility = mobility_[i];
        auto v = velocity_[i].linear(), w = velocity_[i].angular();
        v += gain * mobility.linear * residual_[i].linear();
        w += gain * mobility.angular * residual_[i].angular();
        motion_.displacement[i].linear() += dt * v;
        motion_.displacement[i].angular() += dt * w;
        sum.power += residual_[i].linear().dot(v) + residual_[i].angular().dot(w);
        sum.square += (mobility.linear > 0 ? v.squaredNorm() / mobility.linear : 0) +
                      (mobility.angular > 0 ? w.squaredNorm() / mobility.angular : 0);
      }
      return sum;
    });
  }

  /// The residual at a displacement and its norm; returns r.v.
  double balance(const Field& displacement) {
    follow(problem_, displacement, residual_, pool_);
    ++report_.evaluations;
    const Sums sums =
        core::parallel_sum(pool_, residual_.size(), Sums{}, [&](std::size_t begin, std::size_t end) {
          Sums sum;
          for (std::size_t i = begin; i < end; ++i) {
            auto& r = residual_[i];
            if (problem_.load) {
              r.linear() += (*problem_.load)[i].linear();
              r.angular() += (*problem_.load)[i].angular();
            }
            if (held_[i] != 0)
              for (int dof = 0; dof < 6; ++dof)
                if (is_held(i, dof))
                  r[dof] = 0;
            sum.power += r.linear().dot(velocity_[i].linear()) + r.angular().dot(velocity_[i].angular());
            sum.square += r.linear().squaredNorm() + r.angular().squaredNorm() / length_squared_;
          }
          return sum;
        });
    norm_ = std::sqrt(sums.square);
    return sums.power;
  }

  /// u -= time v, then at rest.
  void move_back(double time) {
    core::parallel_for(pool_, motion_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        motion_.displacement[i].linear() -= time * velocity_[i].linear();
        motion_.displacement[i].angular() -= time * velocity_[i].angular();
        velocity_[i] = {};
      }
    });
    motion_begins_ = true;
    balance(motion_.displacement);
    if (!std::isfinite(norm_))
      fail("the forces are not finite");
  }

  /// Undoes a step that was too long for the forces it met, and shortens the coming ones.
  void retake(double dt, double curvature) {
    move_back(dt);
    ++report_.retakes;
    stiffening_ = std::isfinite(curvature) ? std::max(0.5 * curvature, 1.1 * stiffening_) : 16 * stiffening_;
    if (!(stiffening_ < 1e12))
      fail("the forces jump, or are not finite nearby");
  }

  void tell(double wanted) {
    const auto now = Clock::now();
    if (!monitor_.stop_requested() &&
        !(monitor_.listens() && now - last_tell_ > std::chrono::milliseconds(200)))
      return;
    last_tell_ = now;
    const double fraction =
        norm_ > wanted ? std::log(start_norm_ / norm_) / std::log(start_norm_ / wanted) : 1;
    monitor_.report({"dynamic relaxation", std::clamp(fraction, 0.0, 1.0),
                     "step " + std::to_string(report_.steps) + ", relative residual " +
                         core::to_text(norm_ / reference_)});
  }

  [[noreturn]] void fail(const std::string& cause) const {
    // a held body of n particles across passes a peak every few times n steps
    const bool runs_away = 2 * steps_since_peak_ >= report_.steps && report_.steps >= 1000;
    throw core::NotReached("dynamic relaxation: relative residual " + core::to_text(norm_ / reference_) +
                           " after " + std::to_string(report_.steps) + " steps, " +
                           core::to_text(parameters_.relative_residual) + " was asked for. Likely cause: " +
                           (runs_away ? "the body has been gaining speed for the last " +
                                            std::to_string(steps_since_peak_) +
                                            " steps: it, or a part of it, is not held against its load"
                                      : cause));
  }

  /// Of the step that is surely stable: at the whole of it the fastest mode of a chain of equal springs neither
  /// grows nor decays.
  static constexpr double safety = 0.98;
  static constexpr double stable_curvature =
      4 * (1 + 1e-9); ///< (omega dt)^2 of the leapfrog's limit, and rounding

  const Parameters& parameters_;
  const Problem<Forces>& problem_;
  particles::Motion& motion_;
  core::ThreadPool& pool_;
  const core::Monitor& monitor_;
  Report report_;
  std::vector<std::uint8_t> held_; ///< [particles] bit d: degree of freedom d is prescribed
  std::vector<Mobility> mobility_; ///< [particles]
  Field residual_, velocity_;      ///< [particles] N, N m; zero where held
  double length_squared_ = 1;      ///< m^2, by which moments squared are divided
  double reference_ = 0;           ///< N
  double start_norm_ = 0;          ///< residual of the initial guess, N
  double norm_ = 0;                ///< residual of the displacement, N
  double stiffening_ = 1;          ///< omega^2 that steps must follow, over that of the diagonal blocks
  bool motion_begins_ = true;
  std::uint64_t steps_since_peak_ = 0;
  Clock::time_point last_tell_;
};

static_assert(Integrator<DynamicRelaxation>);

} // namespace cdem::integrate
