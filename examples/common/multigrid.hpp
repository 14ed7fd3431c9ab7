#pragma once

// integrate::StaticMultigrid behind a function, so that one source file compiles it.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/integrate/integrator.hpp>

#include <cstddef>

namespace cdem::examples {

/// What the solver says of itself.
struct MultigridReport {
  int iterations = 0;
  double relative_residual = 0;
  double seconds = 0; ///< wall clock
};

/// Solves as integrate::StaticMultigrid does.
struct Multigrid {
  double relative_residual = 1e-6;

  MultigridReport solve(const integrate::Problem<bond::LinearForces>& problem, particles::Motion& motion,
                        core::ThreadPool& pool, const core::Monitor& monitor) const;
};

} // namespace cdem::examples
