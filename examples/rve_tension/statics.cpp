#include "statics.hpp"

#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/static_multigrid.hpp>

namespace cdem::examples::rve_tension {

Equilibrium solve_by_multigrid(const integrate::Problem<bond::LinearForces>& problem,
                               particles::Motion& motion, core::ThreadPool& pool,
                               const core::Monitor& monitor, double relative_residual) {
  const auto report = integrate::StaticMultigrid({.relative_residual = relative_residual})
                          .solve(problem, motion, pool, monitor);
  return {static_cast<std::uint64_t>(report.iterations), report.relative_residual, report.work,
          report.setup_seconds + report.solve_seconds};
}

Equilibrium solve_by_relaxation(const integrate::Problem<bond::LinearForces>& problem,
                                particles::Motion& motion, core::ThreadPool& pool,
                                const core::Monitor& monitor, double relative_residual) {
  const auto report = integrate::DynamicRelaxation({.relative_residual = relative_residual})
                          .solve(problem, motion, pool, monitor);
  return {report.steps, report.relative_residual, static_cast<double>(report.evaluations), report.seconds};
}

} // namespace cdem::examples::rve_tension
