#pragma once

/// @file
/// How large an explicit time step may be: a guaranteed bound, and the limit itself.

#include <cdem/core/random.hpp>
#include <cdem/integrate/integrator.hpp>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <limits>
#include <string>

namespace cdem::integrate {

/// The time step under which an undamped explicit run is stable, and the particle that sets it.
struct CriticalTimeStep {
  double time_step = 0;         ///< s
  double angular_frequency = 0; ///< rad/s, at least the body's largest; time_step = 2 / angular_frequency
  ParticleIndex particle = 0;   ///< the one whose block gives it
};

namespace detail {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// M_i^-1/2 K_ii M_i^-1/2 of one particle.
/// @throws core::NotReached if it is not finite
template <InternalForces Forces>
Matrix6 scaled_block(const Forces& forces, const particles::Inertia& inertia, ParticleIndex i) {
  Eigen::Matrix<double, 6, 1> scale;
  scale.head<3>().setConstant(1 / std::sqrt(inertia.mass[i]));
  scale.tail<3>().setConstant(1 / std::sqrt(inertia.moment[i]));
  const Matrix6 block = scale.asDiagonal() * Matrix6(forces.diagonal_block(i)) * scale.asDiagonal();
  if (!block.allFinite())
    throw core::NotReached("the critical time step cannot be found: the stiffness of particle " +
                           std::to_string(i) + " over its mass is not finite");
  return block;
}

/// Largest eigenvalue of a symmetric matrix, not negative where the matrix is zero or positive.
///
/// In two steps, as Eigen's own solver in one also compiles the eigenvectors, which takes seconds a program.
template <class Matrix>
double largest_eigenvalue(const Matrix& symmetric) {
  const double scale = symmetric.cwiseAbs().maxCoeff();
  if (scale == 0)
    return 0;
  const Eigen::Tridiagonalization<Matrix> tridiagonal(Matrix(symmetric / scale));
  Eigen::SelfAdjointEigenSolver<Matrix> solver;
  solver.computeFromTridiagonal(tridiagonal.diagonal(), tridiagonal.subDiagonal(), Eigen::EigenvaluesOnly);
  return scale * solver.eigenvalues()[symmetric.rows() - 1];
}

} // namespace detail

/// A guaranteed lower bound of the stable time step, from one 6x6 block a particle.
///
///     dt_crit = min over particles of 2 / sqrt(2 lambda_i),   lambda_i: largest eigenvalue of M_i^-1 K_ii
///
/// Guaranteed, because the energy of a bond is not negative, so that its coupling of two ends is at most the
/// mean of what it does to each alone: x.K x <= 2 sum over particles of x_i.K_ii x_i, hence omega_max^2 <= 2
/// max lambda_i. omega_i = sqrt(lambda_i) is the frequency of particle i among neighbours that are held.
/// Never far from the limit either: one particle alone is a trial motion, omega_max^2 >= max lambda_i, so that
/// the limit 2 / largest_frequency() of a free body lies between the bound and sqrt(2) times it. Equal to the
/// limit for a ring of equal springs moving in turn; 24 to 29 % below it in random networks of 216 particles
/// (beams of r_mu 0.1 to 1, springs, contrasts to 100), measured by the unit test.
/// @deviation [L17] section 2.3 takes the minimum over bonds of a dt_crit it does not define; this one is
/// over particles.
/// @return      time_step is infinite where nothing is bonded
/// @throws      core::InvalidInput for inertia that does not fit the body or is not positive; core::NotReached
///              if a block is not finite
/// @complexity  O(bonds); the eigenvalue problem is solved for the few particles whose row sums exceed the
/// maximum so far
template <InternalForces Forces>
CriticalTimeStep critical_time_step(const Forces& forces, const particles::Inertia& inertia) {
  inertia.validate(forces.particle_count());
  double largest = 0;
  ParticleIndex where = 0;
  for (std::size_t i = 0; i < forces.particle_count(); ++i) {
    const detail::Matrix6 block = detail::scaled_block(forces, inertia, static_cast<ParticleIndex>(i));
    if (block.cwiseAbs().rowwise().sum().maxCoeff() <= largest) // a row sum bounds the eigenvalues
      continue;
    const double eigenvalue = detail::largest_eigenvalue(block);
    if (eigenvalue > largest) {
      largest = eigenvalue;
      where = static_cast<ParticleIndex>(i);
    }
  }
  if (largest == 0)
    return {std::numeric_limits<double>::infinity(), 0, 0};
  const double omega = std::sqrt(2 * largest);
  return {2 / omega, omega, where};
}

/// The largest angular frequency of the body, sqrt of the largest eigenvalue of M^-1 K, by power iteration.
///
/// Approaches it from below; the stability limit of undamped velocity Verlet is 2 over it.
/// @param tolerance   relative change of the eigenvalue in one iteration at which to stop
/// @return            rad/s
/// @throws            core::InvalidInput for a bad problem, a tolerance that is not positive or no iteration;
///                    core::NotReached if `iterations` do not suffice or the forces are not finite
/// @complexity        one application of the forces an iteration; hundreds of iterations
template <InternalForces Forces>
double largest_frequency(const Problem<Forces>& problem, core::ThreadPool& pool, double tolerance = 1e-9,
                         int iterations = 20000) {
  problem.validate();
  core::expect_positive(tolerance, "tolerance of the power iteration");
  core::expect(iterations > 0, "iterations of the power iteration", iterations, "1 or more is expected");
  const std::size_t count = problem.forces.particle_count();
  particles::SpatialField<> vector(count), force(count);
  core::Random random(1);
  for (auto& entry : vector)
    for (int dof = 0; dof < 6; ++dof)
      entry[dof] = random.uniform(-1, 1);
  const auto mass = [&](std::size_t i, int dof) {
    return dof < 3 ? problem.inertia.mass[i] : problem.inertia.moment[i];
  };
  // vector holds x = M^1/2 u with |x| = 1; one iteration is x <- M^-1/2 K M^-1/2 x, its length the eigenvalue
  double previous = 0;
  for (int iteration = 0; iteration <= iterations; ++iteration) {
    for (const auto& constraint : problem.constraints.list())
      vector[constraint.particle][constraint.dof] = 0;
    double norm = 0;
    for (const auto& entry : vector)
      norm += entry.linear().squaredNorm() + entry.angular().squaredNorm();
    norm = std::sqrt(norm);
    if (!std::isfinite(norm))
      throw core::NotReached("the power iteration for the largest frequency met forces that are not finite");
    if (iteration > 1 && std::abs(norm - previous) <= tolerance * norm)
      return std::sqrt(norm);
    if (norm == 0) // nothing is bonded, or nothing is free
      return 0;
    previous = norm;
    for (std::size_t i = 0; i < count; ++i)
      for (int dof = 0; dof < 6; ++dof)
        vector[i][dof] /= norm * std::sqrt(mass(i, dof));
    problem.forces.evaluate(vector, force, pool);
    for (std::size_t i = 0; i < count; ++i)
      for (int dof = 0; dof < 6; ++dof)
        vector[i][dof] = -force[i][dof] / std::sqrt(mass(i, dof));
  }
  throw core::NotReached("the power iteration for the largest frequency did not converge to " +
                         core::to_text(tolerance) + " in " + std::to_string(iterations) + " iterations");
}

} // namespace cdem::integrate
