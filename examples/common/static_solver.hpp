#pragma once

// The static multigrid, compiled on its own: it takes as long as the rest of an example, and so is built beside it.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/integrate/integrator.hpp>

namespace cdem::examples {

/// integrate::StaticMultigrid for bond::LinearForces.
struct StaticSolver {
  struct Report {
    int iterations = 0;
    double relative_residual = 0; ///< recomputed at the end
    double work = 0;              ///< in applications of K to all particles
    double seconds = 0;           ///< wall clock
  };

  double relative_residual = 1e-8;

  /// @throws as integrate::StaticMultigrid::solve()
  Report solve(const integrate::Problem<bond::LinearForces>& problem, particles::Motion& motion,
               core::ThreadPool& pool, const core::Monitor& monitor = {}) const;
};

} // namespace cdem::examples
