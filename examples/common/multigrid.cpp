#include "common/multigrid.hpp"

#include <cdem/integrate/static_multigrid.hpp>

namespace cdem::examples {

MultigridReport Multigrid::solve(const integrate::Problem<bond::LinearForces>& problem,
                                 particles::Motion& motion, core::ThreadPool& pool,
                                 const core::Monitor& monitor) const {
  const auto report = integrate::StaticMultigrid({.relative_residual = relative_residual})
                          .solve(problem, motion, pool, monitor);
  return {report.iterations, report.relative_residual, report.setup_seconds + report.solve_seconds};
}

} // namespace cdem::examples
