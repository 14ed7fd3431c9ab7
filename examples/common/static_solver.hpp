#pragma once

// The solvers of statics, compiled on their own: they take as long as the rest of an example, and so are built beside it.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/integrate/integrator.hpp>

#include <cstdint>

namespace cdem::examples {

/// The equilibrium of bond::LinearForces at unit time.
struct StaticSolver {
  enum class Method : std::uint8_t {
    multigrid,  ///< integrate::StaticMultigrid
    relaxation, ///< integrate::DynamicRelaxation
  };

  /// What the solver says of itself.
  struct Report {
    std::uint64_t iterations = 0; ///< outer iterations of the multigrid, steps of the relaxation
    double relative_residual = 0; ///< recomputed at the end
    double work = 0;              ///< in applications of K to all particles
    double seconds = 0;           ///< wall clock
  };

  double relative_residual = 1e-8; ///< wanted
  Method method = Method::multigrid;

  /// @throws as the solver of that method does
  Report solve(const integrate::Problem<bond::LinearForces>& problem, particles::Motion& motion,
               core::ThreadPool& pool, const core::Monitor& monitor = {}) const;
};

} // namespace cdem::examples
