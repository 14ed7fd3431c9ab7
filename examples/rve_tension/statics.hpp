#pragma once

// The solvers of statics, compiled on their own: they take as long as the rest of the example, and so run beside it.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/integrate/integrator.hpp>

#include <cstdint>

namespace cdem::examples::rve_tension {

/// What a solver of statics says of itself.
struct Equilibrium {
  std::uint64_t iterations = 0; ///< outer iterations of the multigrid, steps of the relaxation
  double relative_residual = 0; ///< recomputed at the end
  double work = 0;              ///< in applications of K to all particles
  double seconds = 0;           ///< wall clock
};

/// The equilibrium at unit time, by integrate::StaticMultigrid.
/// @param relative_residual  wanted
Equilibrium solve_by_multigrid(const integrate::Problem<bond::LinearForces>& problem,
                               particles::Motion& motion, core::ThreadPool& pool,
                               const core::Monitor& monitor, double relative_residual = 1e-8);

/// The same by integrate::DynamicRelaxation.
Equilibrium solve_by_relaxation(const integrate::Problem<bond::LinearForces>& problem,
                                particles::Motion& motion, core::ThreadPool& pool,
                                const core::Monitor& monitor, double relative_residual = 1e-8);

} // namespace cdem::examples::rve_tension
