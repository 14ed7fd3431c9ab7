#pragma once

/// @file
/// Static equilibrium of a linear bonded body, solved by conjugate gradients with a multigrid of rigid groups.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/integrate/detail/multigrid_cycle.hpp>
#include <cdem/integrate/detail/multigrid_support.hpp>
#include <cdem/integrate/detail/newton.hpp>
#include <cdem/integrate/integrator.hpp>

#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace cdem::integrate {

/// Forces that StaticMultigrid can solve for. Models: bond::LinearForces.
template <class F>
concept LinearForcesOfBonds = InternalForces<F> && LinearBonds<F>;

/// Solves K u = load on the free degrees of freedom, the prescribed ones being at `rate` (m or rad).
///
/// Flexible conjugate gradients in double precision on the matrix-free operator, preconditioned by one cycle of an
/// aggregation multigrid in single precision. Its coarse unknowns are the six rigid-body motions of small connected
/// groups of particles, then of groups of groups. A bond seen from two groups is a spring between their rigid motions at
/// its middle; the bonds within a group are not strained. So every level is again a network of links, each with a
/// branch and a stiffness, the Galerkin product is a sum over links, and rigid motions cost no energy on any level,
/// rounding included. docs/static_multigrid.md explains the method and its measured cost.
class StaticMultigrid {
public:
  struct Parameters {
    double relative_residual =
        1e-8; ///< wanted: residual over that of the prescribed motion with all else at rest
    int max_iterations = 1000;
    int group_size = 20;     ///< particles to a group, 2 to 1000
    int smoothing_steps = 2; ///< on the particles before and after each coarse correction, 1 to 16
  };

  /// One level of the hierarchy, the particles first.
  struct LevelReport {
    std::size_t nodes = 0;
    std::size_t links =
        0; ///< stored: those between two blocks count twice; on the coarsest, entries of the factor
    std::size_t bytes = 0;
    double applications = 0; ///< of the level's operator, smoothing included
  };

  /// How a solution went.
  struct Report {
    int iterations = 0;
    double relative_residual = 0;    ///< recomputed from the displacement returned
    std::vector<double> history;     ///< [iterations + 1] relative residual as the iteration saw it
    std::vector<LevelReport> levels; ///< the particles first
    double operator_complexity = 0;  ///< bytes of all the levels' links over those of the first
    /// Work in applications of the operator on the particles: every application in the outer iteration and in the
    /// smoother counts one, one on a coarser level counts the bytes it moves over those moved on the first.
    double work = 0;
    double setup_seconds = 0;
    double solve_seconds = 0;
    std::size_t bytes = 0;              ///< held by the solver at its peak, the problem's own not counted
    std::size_t rattlers = 0;           ///< free particles without a bond that resists: left at rest
    std::size_t floating_clusters = 0;  ///< connected parts that nothing holds or loads: left at rest
    std::size_t floating_particles = 0; ///< their particles
    std::size_t loose_clusters =
        0; ///< parts that move under constraints or loads and are not held in every rigid motion
    /// Motions without energy that must exist: rotations that no bond resists, and by Maxwell's count the other free
    /// unknowns less the bonds' independent resistances. 0 for beams; a lower bound for springs.
    std::size_t floppy_modes_at_least = 0;
    /// Linear problems solved; 1 where the forces are linear themselves. The levels and sizes above are the last one's,
    /// iterations, work and seconds the sums of all.
    int newton_iterations = 1;
  };

  /// @throws core::InvalidInput naming the parameter that is out of range
  StaticMultigrid() : StaticMultigrid(Parameters{}) {}
  explicit StaticMultigrid(Parameters parameters) : parameters_(parameters) {
    core::expect(std::isfinite(parameters.relative_residual) && parameters.relative_residual > 0 &&
                     parameters.relative_residual < 1,
                 "relative_residual of the static multigrid", parameters.relative_residual,
                 "a number between 0 and 1 is expected");
    core::expect(parameters.max_iterations >= 1, "max_iterations of the static multigrid",
                 parameters.max_iterations, "at least 1 is expected");
    core::expect(parameters.group_size >= 2 && parameters.group_size <= 1000,
                 "group_size of the static multigrid", parameters.group_size, "2 to 1000 is expected");
    core::expect(parameters.smoothing_steps >= 1 && parameters.smoothing_steps <= 16,
                 "smoothing_steps of the static multigrid", parameters.smoothing_steps,
                 "1 to 16 is expected");
  }

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Solves for the displacement.
  ///
  /// @param problem  its constraints' rates are read at unit time: m and rad. Inertia is not used.
  /// @param motion   displacement: initial guess in, solution out; particles that nothing holds or loads are at zero.
  ///                 Velocity, time and step are left alone.
  /// @return         bitwise the same displacement for any number of threads
  /// @throws core::InvalidInput  for a problem that does not fit together, a body that is not held (names the free rigid
  ///                             motions), a load on a cluster that is free to move, a moment that nothing resists
  /// @throws core::NotReached    if the residual is not reached; the motion then holds the last iterate
  /// @throws core::Interrupted   if the monitor asks to stop, between two iterations
  /// @complexity O(bonds) in time and memory
  template <LinearForcesOfBonds Forces>
  Report solve(const Problem<Forces>& problem, particles::Motion& motion, core::ThreadPool& pool,
               const core::Monitor& monitor = {}) const {
    return Solve<Forces>(parameters_, problem, motion, pool, monitor).run();
  }

  /// Solves for the equilibrium of forces that are not linear, by Newton's method.
  ///
  /// Each step is a linear solution with the forces' tangent; the residual is measured as for linear forces. Whole steps
  /// are taken first, as rotations need (the residual rises before it falls); where they do not converge, all begins
  /// anew with steps that lessen the residual. Forces with
  /// a memory of the path are tried from what they remember and accept the equilibrium found: take the load in steps
  /// where the path matters.
  /// @param problem, motion, pool  as above
  /// @throws as above; core::NotReached also if no step along Newton's direction lessens the residual: a load beyond what
  ///         the body bears, or bonds that soften
  template <InternalForces Forces>
  requires(!LinearForcesOfBonds<Forces> && GivesTangent<Forces>) Report
      solve(const Problem<Forces>& problem, particles::Motion& motion, core::ThreadPool& pool,
            const core::Monitor& monitor = {})
  const {
    const auto linear_solve = [&](const auto& linear, particles::Motion& correction, double relative_residual,
                                  bool is_residual) {
      Parameters parameters = parameters_;
      parameters.relative_residual = relative_residual;
      using Tangent = std::remove_cvref_t<decltype(linear.forces)>;
      return Solve<Tangent>(parameters, linear, correction, pool, monitor, is_residual).run();
    };
    return detail::Newton<Forces, Report, decltype(linear_solve)>(problem, motion, pool,
                                                                  parameters_.relative_residual, linear_solve)
        .run();
  }

private:
  template <class Forces>
  class Solve;

  Parameters parameters_;
};

/// One solution, from the problem to the report.
template <class Forces>
class StaticMultigrid::Solve {
public:
  /// @param is_residual  the load is what an iteration left: what is of it on parts that nothing holds is rounding
  Solve(const Parameters& parameters, const Problem<Forces>& problem, particles::Motion& motion,
        core::ThreadPool& pool, const core::Monitor& monitor, bool is_residual = false)
      : parameters_(parameters), problem_(problem), motion_(motion), pool_(pool), monitor_(monitor),
        is_residual_(is_residual) {}

  Report run() {
    const auto start = Clock::now();
    problem_.validate();
    core::expect(
        motion_.size() == problem_.forces.particle_count(), "number of displacements", motion_.size(),
        "the number of particles, " + std::to_string(problem_.forces.particle_count()) + ", is expected");
    monitor_.report({"static multigrid", 0, "set-up"});
    auto bonds = std::make_unique<const detail::Bonds<Forces>>(problem_.forces, pool_);
    units_ = bonds->units();
    support_ = detail::find_support(problem_, *bonds, is_residual_ ? nullptr : problem_.load);
    expect_resisted_loads(*bonds);
    count_floppy_modes();
    report_.rattlers = support_.rattlers;
    report_.floating_clusters = support_.floating_clusters;
    report_.floating_particles = support_.floating_particles;
    report_.loose_clusters = support_.loose_clusters;

    const std::size_t particles = problem_.forces.particle_count();
    residual_.resize(particles);
    image_.resize(particles);
    const double reference = residual_at_prescribed_motion();
    if (reference == 0 || std::all_of(support_.held.begin(), support_.held.end(),
                                      [](detail::HeldMask held) { return held == detail::all_held; })) {
      report_.setup_seconds = seconds_since(start);
      return report_; // the prescribed motion is the solution
    }
    direction_.resize(particles);
    detail::Hierarchy::Parameters parameters;
    parameters.group_size = static_cast<std::uint32_t>(parameters_.group_size);
    parameters.cycle.smoothing_steps = parameters_.smoothing_steps;
    if (report_.floppy_modes_at_least > 0 || support_.loose_clusters > 0 || !support_.drifting.empty() ||
        has_free_channels_)
      parameters.shift = 1e-6;
    detail::Hierarchy hierarchy(detail::BondGraph<Forces>(*bonds, support_.held), parameters, pool_);
    bonds.reset();
    report_.setup_seconds = seconds_since(start);

    const auto solve_start = Clock::now();
    iterate(hierarchy, reference);
    remove_drift(motion_.displacement);
    report_.solve_seconds = seconds_since(solve_start);
    account(hierarchy);
    return report_;
  }

private:
  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  void expect_resisted_loads(const detail::Bonds<Forces>& bonds) const {
    if (!problem_.load || is_residual_)
      return;
    for (std::uint32_t i = 0; i < support_.held.size(); ++i) {
      const auto& load = (*problem_.load)[i];
      if (load.linear().isZero(0) && load.angular().isZero(0))
        continue;
      const detail::Matrix6 block = bonds.stiffness_of_particle(i);
      for (int d = 0; d < 6; ++d)
        core::expect(load[d] == 0 || support_.held[i] >> d & 1 || block(d, d) > 0,
                     (d < 3 ? "force on particle " : "moment on particle ") + std::to_string(i) + " along " +
                         "xyz"[d % 3],
                     load[d], "no bond of the particle resists it: 0 is expected");
    }
  }

  void count_floppy_modes() {
    std::vector<bool> turns_freely(support_.held.size(), true);
    std::size_t resistances = 0;
    for (BondIndex b = 0; b < problem_.forces.bond_count(); ++b) {
      const auto& k = problem_.forces.stiffness(b);
      const auto [i, j] = problem_.forces.ends(b);
      if (k.tangential > 0 || k.torsion > 0 || k.bending > 0)
        turns_freely[i] = turns_freely[j] = false;
      if (support_.held[i] != detail::all_held || support_.held[j] != detail::all_held)
        resistances += (k.normal > 0 ? 1U : 0U) + (k.tangential > 0 ? 2U : 0U) + (k.torsion > 0 ? 1U : 0U) +
                       (k.bending > 0 ? 2U : 0U);
      has_free_channels_ |=
          detail::is_stiff(k) && !(k.normal > 0 && k.tangential > 0 && k.torsion > 0 && k.bending > 0);
    }
    std::size_t unresisted = 0, unknowns = 0;
    for (std::size_t i = 0; i < support_.held.size(); ++i)
      for (int d = 0; d < 6; ++d)
        if (!(support_.held[i] >> d & 1))
          ++(d >= 3 && turns_freely[i] ? unresisted : unknowns);
    report_.floppy_modes_at_least = unresisted + (unknowns > resistances ? unknowns - resistances : 0);
  }

  /// Puts the prescribed values into the displacement; returns the norm of the residual with all else at zero, and leaves
  /// in residual_ that of the initial guess.
  double residual_at_prescribed_motion() {
    auto& displacement = motion_.displacement;
    bool guessed = false;
    for (std::uint32_t i = 0; i < displacement.size(); ++i)
      for (int d = 0; d < 6; ++d) {
        if (!std::isfinite(displacement[i][d]))
          core::reject("initial displacement of particle " + std::to_string(i), displacement[i][d],
                       "a finite number is expected");
        if (support_.held[i] >> d & 1)
          displacement[i][d] = 0;
        else
          guessed |= displacement[i][d] != 0;
      }
    for (const auto& constraint : problem_.constraints.list())
      displacement[constraint.particle][constraint.dof] = constraint.rate;
    if (!guessed)
      return find_residual(displacement);
    particles::SpatialField<> prescribed(displacement.size());
    for (const auto& constraint : problem_.constraints.list())
      prescribed[constraint.particle][constraint.dof] = constraint.rate;
    const double reference = find_residual(prescribed);
    if (reference == 0)
      displacement = prescribed;
    find_residual(displacement);
    return reference;
  }

  /// residual_ = load + internal forces on the free degrees of freedom; returns its norm.
  double find_residual(const particles::SpatialField<>& displacement) {
    problem_.forces.evaluate(displacement, residual_, pool_);
    applications_ += 1;
    core::parallel_for(pool_, residual_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (int d = 0; d < 6; ++d)
          residual_[i][d] =
              support_.held[i] >> d & 1 ? 0 : residual_[i][d] + (problem_.load ? (*problem_.load)[i][d] : 0);
    });
    remove_drift(residual_);
    return norm_of_residual();
  }

  /// Force squared plus moment over the mean length of a bond squared, N^2.
  double squared(const particles::Spatial<>& load) const {
    return load.linear().squaredNorm() + load.angular().squaredNorm() / (units_.length * units_.length);
  }

  void iterate(detail::Hierarchy& hierarchy, double reference) {
    const double wanted = parameters_.relative_residual * reference;
    double norm = norm_of_residual(), true_norm = norm;
    report_.history.push_back(norm / reference);
    while (!(true_norm <= wanted)) {
      double curvature = 0; // p.Kp; 0 starts a new sequence of directions
      pass_residual(hierarchy, norm);
      double scale = norm;
      while (norm > wanted) {
        if (report_.iterations == parameters_.max_iterations) {
          move_along(pending_);
          fail(norm / reference);
        }
        ++report_.iterations;
        hierarchy.precondition(pool_);
        const double work = find_direction(hierarchy, scale, curvature);
        problem_.forces.evaluate(direction_, image_, pool_);
        applications_ += 1;
        curvature = -sum_over_particles([&](std::size_t i) { return inner(direction_[i], image_[i]); });
        if (!(curvature > 0 && std::isfinite(curvature)))
          break;
        scale = norm;
        norm = step(hierarchy, work / curvature, scale);
        report_.history.push_back(norm / reference);
        tell(norm, wanted, reference);
      }
      move_along(pending_);
      const double before = true_norm;
      norm = true_norm = find_residual(motion_.displacement);
      if (!(true_norm <= wanted) && !(true_norm < 0.5 * before))
        fail(true_norm / reference); // rounding, or a load outside what the network resists
    }
    report_.relative_residual = true_norm / reference;
  }

  static double inner(const particles::Spatial<>& a, const particles::Spatial<>& b) {
    return a.linear().dot(b.linear()) + a.angular().dot(b.angular());
  }

  template <class Term>
  double sum_over_particles(Term&& term) {
    return core::parallel_sum(pool_, residual_.size(), 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i)
        sum += term(i);
      return sum;
    });
  }

  double norm_of_residual() {
    return std::sqrt(sum_over_particles([&](std::size_t i) { return squared(residual_[i]); }));
  }

  /// The residual over `scale` in the multigrid's units, in single precision.
  void pass_residual(detail::Hierarchy& hierarchy, double scale) {
    core::parallel_for(pool_, residual_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        pass_residual(hierarchy, i, scale);
    });
  }
  void pass_residual(detail::Hierarchy& hierarchy, std::size_t i, double scale) {
    const std::uint32_t place = hierarchy.place()[i];
    if (place == detail::none)
      return;
    hierarchy.rhs()[place].linear() = (residual_[i].linear() / scale).template cast<float>();
    hierarchy.rhs()[place].angular() =
        (residual_[i].angular() / (scale * units_.length)).template cast<float>();
  }

  /// direction_ = z + beta direction_, z the preconditioned residual, K-orthogonal to the direction before; returns r.z.
  /// Before it changes, the step along the last direction that is still pending is taken.
  double find_direction(const detail::Hierarchy& hierarchy, double scale, double curvature) {
    const double to_linear = scale / units_.stiffness, to_angular = to_linear / units_.length;
    struct Sums {
      double residual = 0, image = 0;
      Sums& operator+=(const Sums& other) {
        residual += other.residual;
        image += other.image;
        return *this;
      }
    };
    const auto preconditioned = [&](std::size_t i) {
      particles::Spatial<> z;
      if (const std::uint32_t place = hierarchy.place()[i]; place != detail::none) {
        z.linear() = to_linear * hierarchy.result()[place].linear().template cast<double>();
        z.angular() = to_angular * hierarchy.result()[place].angular().template cast<double>();
      }
      return z;
    };
    const Sums sums =
        core::parallel_sum(pool_, residual_.size(), Sums{}, [&](std::size_t begin, std::size_t end) {
          Sums sum;
          for (std::size_t i = begin; i < end; ++i) {
            const particles::Spatial<> z = preconditioned(i);
            sum.residual += inner(z, residual_[i]);
            sum.image -= inner(z, image_[i]);
          }
          return sum;
        });
    const double beta = curvature > 0 ? -sums.image / curvature : 0, length = std::exchange(pending_, 0);
    core::parallel_for(pool_, residual_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const particles::Spatial<> z = preconditioned(i);
        auto& direction = direction_[i];
        for (int c = 0; c < 8; ++c) {
          motion_.displacement[i].component[c] += length * direction.component[c];
          direction.component[c] = z.component[c] + beta * direction.component[c];
        }
      }
    });
    remove_drift(direction_);
    return sums.residual;
  }

  /// Takes a step along the direction.
  void move_along(double length) {
    pending_ = 0;
    core::parallel_for(pool_, residual_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (int c = 0; c < 8; ++c)
          motion_.displacement[i].component[c] += length * direction_[i].component[c];
    });
  }

  /// Takes a step along the direction, the displacement's share of it later; returns the norm of the new residual and
  /// passes it on.
  double step(detail::Hierarchy& hierarchy, double length, double scale) {
    pending_ = length;
    const bool drifts = !support_.drifting.empty();
    const double norm = std::sqrt(sum_over_particles([&](std::size_t i) {
      if (support_.held[i] == 0)
        for (int c = 0; c < 8; ++c)
          residual_[i].component[c] += length * image_[i].component[c];
      else
        for (int d = 0; d < 6; ++d)
          if (!(support_.held[i] >> d & 1))
            residual_[i][d] += length * image_[i][d];
      if (!drifts)
        pass_residual(hierarchy, i, scale);
      return squared(residual_[i]);
    }));
    if (drifts) {
      remove_drift(residual_);
      pass_residual(hierarchy, scale);
    }
    return norm;
  }

  /// Takes the mean force or translation out of a periodic body that nothing holds. Neither residual nor direction may keep
  /// any: what the levels make of rounding there grows from step to step, until it drowns all else.
  void remove_drift(particles::SpatialField<>& field) {
    const auto& drifting = support_.drifting;
    if (drifting.empty())
      return;
    const Vec3 sum = core::parallel_sum(pool_, drifting.size(), Vec3(Vec3::Zero()),
                                        [&](std::size_t begin, std::size_t end) {
                                          Vec3 part = Vec3::Zero();
                                          for (std::size_t k = begin; k < end; ++k)
                                            part += field[drifting[k]].linear();
                                          return part;
                                        });
    const Vec3 mean = sum / static_cast<double>(drifting.size());
    core::parallel_for(pool_, drifting.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        field[drifting[k]].linear() -= mean;
    });
  }

  void tell(double norm, double wanted, double reference) const {
    const double start = report_.history.front() * reference;
    const double fraction = start > wanted ? std::log(start / norm) / std::log(start / wanted) : 1;
    monitor_.report({"static multigrid", std::clamp(fraction, 0.0, 1.0),
                     monitor_.listens() ? "iteration " + std::to_string(report_.iterations) +
                                              ", relative residual " + core::to_text(norm / reference)
                                        : std::string()});
  }

  [[noreturn]] void fail(double relative_residual) const {
    throw core::NotReached("static multigrid: relative residual " + core::to_text(relative_residual) +
                           " after " + std::to_string(report_.iterations) + " iterations, " +
                           core::to_text(parameters_.relative_residual) + " was asked for" +
                           (has_free_channels_
                                ? "; the network has bonds that resist only some motions: does a load "
                                  "push on a motion without stiffness?"
                                : ""));
  }

  void account(const detail::Hierarchy& hierarchy) {
    const auto sizes = hierarchy.sizes();
    const auto moved = [](const detail::Hierarchy::Size& size) { return static_cast<double>(size.bytes); };
    double links = 0;
    report_.work = applications_;
    for (const auto& size : sizes) {
      report_.levels.push_back({size.nodes, size.links, size.bytes, size.applications});
      report_.work += size.applications * moved(size) / moved(sizes[0]);
      report_.bytes += size.bytes;
      links += moved(size);
    }
    report_.operator_complexity = links / moved(sizes[0]);
    report_.bytes += (residual_.size() + image_.size() + direction_.size()) * sizeof(residual_[0]) +
                     hierarchy.place().size() * sizeof(std::uint32_t) + support_.held.size();
  }

  const Parameters& parameters_;
  const Problem<Forces>& problem_;
  particles::Motion& motion_;
  core::ThreadPool& pool_;
  const core::Monitor& monitor_;
  bool is_residual_;
  Report report_;
  detail::Units units_;
  detail::Support support_;
  particles::SpatialField<> residual_, direction_,
      image_;          ///< [particles]; image: internal forces of the direction
  double pending_ = 0; ///< step along the direction that the displacement has still to take
  double applications_ = 0;
  bool has_free_channels_ = false; ///< some bond resists stretch, shear, twist and bend not all
};

static_assert(Integrator<StaticMultigrid>);

} // namespace cdem::integrate
