#pragma once

/// @file
/// The whole stiffness of a periodic body from six mean strains.

#include <cdem/boundary/periodic_strain.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/homogenize/stiffness.hpp>
#include <cdem/integrate/integrator.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

namespace cdem::homogenize {

/// `solver.solve(problem, motion, pool, monitor)` finds the equilibrium of a body with these forces.
/// Models: integrate::StaticMultigrid, integrate::DynamicRelaxation, or a struct that hands on to either.
template <class S, class Forces>
concept SolvesStaticsOf = requires(const S& solver, const integrate::Problem<Forces>& problem,
                                   particles::Motion& motion, core::ThreadPool& pool,
                                   const core::Monitor& monitor) {
  solver.solve(problem, motion, pool, monitor);
};

/// What the six strains of a periodic body tell.
template <class Report>
struct PeriodicStiffness {
  Stiffness stiffness; ///< from the mean stresses
  Stiffness affine;    ///< of the affine motion, u~ = 0 (Voigt): never softer than the stiffness
  /// [6] Pa, twice the energy density at unit Voigt strain: the diagonal of C once more, with an error of second order.
  /// Never below the exact one.
  Vector6 energy = Vector6::Zero();
  double stress_asymmetry =
      0; ///< largest |antisymmetric part| of a mean stress over its norm: balance of moments
  std::array<Report, 6> reports; ///< the solver's, one a strain

  /// Largest |C_kk - energy_k| over C_kk: how well stress and energy agree.
  double energy_mismatch() const {
    return ((stiffness.voigt().diagonal() - energy).array() / energy.array()).abs().maxCoeff();
  }
};

/// Stiffness of a periodic body: six unit strains in Voigt's order, one static solution each.
///
/// C_kl = mean stress k under unit Voigt strain l (boundary::PeriodicStrain). Two checks come with it: C is symmetric
/// though its columns are of different solutions, and its diagonal is twice the energy of each.
/// @param forces  linear forces of bonds made with the periodic box
/// @param box     periodic in all directions; its volume is the body's
/// @param solver  its tolerance is on the residual over the load; symmetry is met to about that
/// @throws core::InvalidInput for a walled box; what the solver throws
/// @complexity    six static solutions; 128 bytes a particle beside what the solver holds
template <boundary::LoadedBondsUnderStrain Forces, SolvesStaticsOf<Forces> Solver>
auto periodic_stiffness(const Forces& forces, const geometry::Box& box, const Solver& solver,
                        core::ThreadPool& pool, const core::Monitor& monitor = {}) {
  boundary::PeriodicStrain::validate(box);
  const std::size_t count = forces.particle_count();
  const particles::Inertia inertia{std::vector<double>(count, 1), std::vector<double>(count, 1)}; // not used
  const particles::Constraints none;
  using Report = decltype(solver.solve(std::declval<const integrate::Problem<Forces>&>(),
                                       std::declval<particles::Motion&>(), pool, monitor));
  PeriodicStiffness<Report> found;
  Matrix6 stiffness, affine;
  for (int k = 0; k < 6; ++k) {
    const boundary::PeriodicStrain strain(strain_of_voigt(Vector6::Unit(k)));
    const particles::SpatialField<> load = strain.load(forces, pool);
    particles::Motion motion;
    motion.displacement.resize(count);
    const integrate::Problem<Forces> problem{forces, inertia, none, &load};
    found.reports[static_cast<std::size_t>(k)] = solver.solve(problem, motion, pool, monitor);
    const Mat3 stress = strain.mean_stress(forces, motion.displacement, box.volume(), pool);
    stiffness.col(k) = voigt_of_stress(stress);
    affine.col(k) = voigt_of_stress(strain.affine_stress(forces, box.volume(), pool));
    found.energy[k] = 2 * strain.energy(forces, load, motion.displacement, pool) / box.volume();
    found.stress_asymmetry =
        std::max(found.stress_asymmetry, 0.5 * (stress - stress.transpose()).norm() / stress.norm());
  }
  found.stiffness = Stiffness(stiffness);
  found.affine = Stiffness(affine);
  return found;
}

} // namespace cdem::homogenize
