#pragma once

/// @file
/// Newton's method on forces that are not linear.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/integrate/integrator.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace cdem::integrate::detail {

/// Newton's method: linear solutions about the present displacement until the forces balance.
///
/// Whole steps are taken first, as rotations need (the residual rises before it falls); where they do not converge, all
/// begins anew with steps that lessen the residual.
/// @tparam LinearSolve  Report(problem, correction, relative_residual, is_residual): solves the linear problem, the
///                      first of them with is_residual = false; may throw core::NotReached with a partial correction
/// @tparam Report       of the linear solver, with newton_iterations, iterations, work, setup_seconds, solve_seconds and
///                      relative_residual
template <class Forces, class Report, class LinearSolve>
class Newton {
public:
  /// @param wanted  residual over that of the prescribed motion
  Newton(const Problem<Forces>& problem, particles::Motion& motion, core::ThreadPool& pool, double wanted,
         LinearSolve linear_solve)
      : problem_(problem), motion_(motion), pool_(pool), wanted_(wanted),
        linear_solve_(std::move(linear_solve)) {}

  Report run() {
    problem_.validate();
    expect_finite_field(motion_.displacement, problem_.forces.particle_count(), "initial displacement");
    held_.assign(motion_.size(), 0);
    for (const auto& constraint : problem_.constraints.list())
      held_[constraint.particle] =
          static_cast<std::uint8_t>(held_[constraint.particle] | 1U << constraint.dof);
    Field prescribed(motion_.size());
    for (const auto& constraint : problem_.constraints.list())
      prescribed[constraint.particle][constraint.dof] = constraint.rate;
    try_out(prescribed);
    reference_ = norm_;
    try_out(motion_.displacement);
    if (reference_ == 0)
      reference_ = norm_;
    report_.newton_iterations = 0;
    report_.relative_residual = relative();
    const Field start = motion_.displacement;
    const auto memory = remembered();
    if (!iterate(false)) {
      motion_.displacement = start;
      recall(memory);
      try_out(motion_.displacement);
      iterate(true);
    }
    accept(problem_, motion_.displacement, residual_, pool_);
    return report_;
  }

private:
  using Field = particles::SpatialField<>;

  double relative() const { return reference_ > 0 ? norm_ / reference_ : norm_ > 0 ? 1 : 0; }

  /// What forces remember of where they are, to go back to.
  auto remembered() const {
    if constexpr (requires { problem_.forces.memory(); })
      return problem_.forces.memory();
    else
      return 0;
  }
  template <class Memory>
  void recall([[maybe_unused]] const Memory& memory) {
    if constexpr (requires { problem_.forces.restore(memory); })
      problem_.forces.restore(memory);
  }

  bool converged() const { return prescribed_is_met_ && norm_ <= wanted_ * reference_; }

  /// @return  whether the equilibrium was found; with a search along each step, not to find it is an error
  bool iterate(bool search) {
    prescribed_is_met_ = gap().empty();
    for (int steps = 0; !converged(); ++steps) {
      const bool lost = steps == max_newton_iterations || !std::isfinite(norm_) ||
                        norm_ > 1e12 * (reference_ > 0 ? reference_ : 1);
      if (lost && search)
        fail("the method does not converge: take the load in smaller steps");
      if (lost)
        return false;
      step(search);
      report_.relative_residual = relative();
    }
    return true;
  }

  /// What the prescribed degrees of freedom have still to move.
  particles::Constraints gap() const {
    particles::Constraints gap;
    bool moves = false;
    for (const auto& [particle, dof, rate] : problem_.constraints.list()) {
      gap.add({particle, dof, rate - motion_.displacement[particle][dof]});
      moves |= rate != motion_.displacement[particle][dof];
    }
    return moves ? gap : particles::Constraints{};
  }

  /// One linear problem and a step along its solution, with `search` one that lessens the residual.
  void step(bool search) {
    const auto tangent = problem_.forces.tangent(motion_.displacement, pool_);
    particles::Constraints constraints = gap();
    if (constraints.empty())
      for (const auto& [particle, dof, rate] : problem_.constraints.list())
        constraints.add({particle, dof, 0.0});
    // down to the residual wanted in the end: forces that are linear after all are then solved in one step
    const double relative_residual =
        std::clamp(0.3 * wanted_ * reference_ / norm_, norm_ > reference_ ? 1e-6 : 1e-12, 1e-3);
    particles::Motion correction = particles::Motion::at_rest(motion_.size());
    const Problem linear_problem{tangent, problem_.inertia, constraints, &residual_};
    try {
      add(linear_solve_(linear_problem, correction, relative_residual, report_.newton_iterations > 0));
    } catch (const core::NotReached&) {
      // rounding, or a tangent that is not positive: what was found before is a direction all the same
    }
    ++report_.newton_iterations;

    const double before = norm_;
    const Field start = motion_.displacement;
    for (double length = 1; length > 1e-3; length *= 0.5) {
      for (std::size_t i = 0; i < start.size(); ++i)
        for (int c = 0; c < 8; ++c)
          motion_.displacement[i].component[c] =
              start[i].component[c] + length * correction.displacement[i].component[c];
      for (const auto& [particle, dof, rate] : problem_.constraints.list())
        motion_.displacement[particle][dof] = rate; // no rounding
      try_out(motion_.displacement);
      const bool was_met = std::exchange(prescribed_is_met_, true);
      if (!search || !was_met || norm_ < (1 - 1e-4 * length) * before || converged())
        return;
    }
    motion_.displacement = start;
    try_out(motion_.displacement);
    fail("no step along Newton's direction lessens the residual: does the load exceed what the body bears, "
         "or do bonds "
         "soften? Dynamic relaxation, or smaller steps of the load, may do");
  }

  /// residual_ = load + internal forces; norm_ that of the free degrees of freedom.
  void try_out(const Field& displacement) {
    follow(problem_, displacement, residual_, pool_);
    norm_ =
        std::sqrt(core::parallel_sum(pool_, residual_.size(), 0.0, [&](std::size_t begin, std::size_t end) {
          double sum = 0;
          for (std::size_t i = begin; i < end; ++i)
            for (int d = 0; d < 6; ++d) {
              if (problem_.load)
                residual_[i][d] += (*problem_.load)[i][d];
              if (!(held_[i] >> d & 1))
                sum += (d < 3 ? 1 : 1 / length_squared()) * residual_[i][d] * residual_[i][d];
            }
          return sum;
        }));
  }

  /// Moments count by the mean length of a bond.
  double length_squared() const {
    if (length_squared_ == 0) {
      double sum = 0;
      for (BondIndex b = 0; b < problem_.forces.bond_count(); ++b)
        sum += problem_.forces.length(b);
      const double mean = sum > 0 ? sum / static_cast<double>(problem_.forces.bond_count()) : 1;
      length_squared_ = mean * mean;
    }
    return length_squared_;
  }

  void add(const Report& linear) {
    const Report before = report_;
    report_ = linear;
    report_.newton_iterations = before.newton_iterations;
    report_.iterations += before.iterations;
    report_.work += before.work;
    report_.setup_seconds += before.setup_seconds;
    report_.solve_seconds += before.solve_seconds;
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw core::NotReached("Newton's method: relative residual " + core::to_text(relative()) + " after " +
                           std::to_string(report_.newton_iterations) + " Newton steps, " +
                           core::to_text(wanted_) + " was asked for. Likely cause: " + cause);
  }

  static constexpr int max_newton_iterations = 50;

  const Problem<Forces>& problem_;
  particles::Motion& motion_;
  core::ThreadPool& pool_;
  double wanted_;
  LinearSolve linear_solve_;
  Report report_;
  std::vector<std::uint8_t> held_; ///< [particles] bit d: degree of freedom d is prescribed
  Field residual_;
  double norm_ = 0, reference_ = 0;
  bool prescribed_is_met_ = false;
  mutable double length_squared_ = 0;
};

} // namespace cdem::integrate::detail
