#include "static_solver.hpp"

#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/static_multigrid.hpp>

namespace cdem::examples {

StaticSolver::Report StaticSolver::solve(const integrate::Problem<bond::LinearForces>& problem,
                                         particles::Motion& motion, core::ThreadPool& pool,
                                         const core::Monitor& monitor) const {
  if (method == Method::relaxation) {
    const auto report = integrate::DynamicRelaxation({.relative_residual = relative_residual})
                            .solve(problem, motion, pool, monitor);
    return {report.steps, report.relative_residual, static_cast<double>(report.evaluations), report.seconds};
  }
  const auto report = integrate::StaticMultigrid({.relative_residual = relative_residual})
                          .solve(problem, motion, pool, monitor);
  return {static_cast<std::uint64_t>(report.iterations), report.relative_residual, report.work,
          report.setup_seconds + report.solve_seconds};
}

} // namespace cdem::examples
