#include "statics.hpp"

#include <cdem/integrate/static_multigrid.hpp>

namespace cdem::examples::rve_tension {

Equilibrium solve_equilibrium(const integrate::Problem<bond::LinearForces>& problem,
                              particles::Motion& motion, core::ThreadPool& pool,
                              const core::Monitor& monitor) {
  const auto report =
      integrate::StaticMultigrid({.relative_residual = 1e-8}).solve(problem, motion, pool, monitor);
  return {report.iterations, report.relative_residual, report.work};
}

} // namespace cdem::examples::rve_tension
