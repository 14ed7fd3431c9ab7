#pragma once

// The static solver, compiled on its own: it takes as long as the rest of the example, and so runs beside it.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/integrate/integrator.hpp>

namespace cdem::examples::rve_tension {

/// What the static solver says of itself.
struct Equilibrium {
  int iterations = 0;           ///< outer iterations
  double relative_residual = 0; ///< recomputed at the end
  double work = 0;              ///< in applications of K to all particles
};

/// The equilibrium at unit time, by integrate::StaticMultigrid to a relative residual of 1e-8.
Equilibrium solve_equilibrium(const integrate::Problem<bond::LinearForces>& problem,
                              particles::Motion& motion, core::ThreadPool& pool,
                              const core::Monitor& monitor);

} // namespace cdem::examples::rve_tension
