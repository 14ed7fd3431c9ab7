#pragma once

/// @file
/// Mean strain of a periodic body: no face is pulled, no gauge length is chosen.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/core/types.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <Eigen/Geometry> // cross product

#include <cmath>
#include <concepts>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace cdem::boundary {

/// Tells of each bond what an affine motion needs: ends, direction, length, stiffness against stretch and shear, and the
/// bonds of each particle. Model: bond::LinearForces.
template <class F>
concept BondsUnderStrain = requires(const F& forces, BondIndex b, ParticleIndex i) {
  { forces.particle_count() } -> std::convertible_to<std::size_t>;
  { forces.bond_count() } -> std::convertible_to<std::size_t>;
  { forces.ends(b) } -> std::convertible_to<std::pair<ParticleIndex, ParticleIndex>>;
  { forces.direction(b) } -> std::convertible_to<Vec3>;
  { forces.length(b) } -> std::convertible_to<double>;
  { forces.stiffness(b).normal } -> std::convertible_to<double>;
  { forces.stiffness(b).tangential } -> std::convertible_to<double>;
  { *forces.bonds_of(i).begin() } -> std::convertible_to<BondIndex>;
};

/// The same, and the load that each bond takes from a displacement.
template <class F>
concept LoadedBondsUnderStrain = BondsUnderStrain<F> &&
    requires(const F& forces, BondIndex b, const particles::SpatialField<>& u, core::ThreadPool& pool) {
  { forces.load(b, u).force } -> std::convertible_to<Vec3>;
  { forces.elastic_energy(u, pool) } -> std::convertible_to<double>;
};

/// A mean strain E of a periodic body: u = E.x + u~, with u~ (and the particles' rotations) periodic.
///
/// A bond of branch b = L n, through a periodic face or not, is strained by E.b beside what u~ does:
///
///     g = u~_j - u~_i + E.b - L th x n        (th: mean rotation of its ends, [L17] section 2.2, frame-free form)
///
/// Forces being linear, E alone is a load on particles at rest: F = K_n (n.E.b) n + K_t (E.b)_t on i, -F on j, and
/// (L/2) n x F on both. load() sums these, u~ is the equilibrium under them, K u~ = load: loads are balanced, so that
/// the body need not be held (integrate::StaticMultigrid takes the free translation out). mean_stress() is then exact:
/// no face, no gauge length and no boundary layer enters, and the six strains give the whole stiffness
/// (homogenize::periodic_stiffness). The forces must be of bonds made with the periodic box.
class PeriodicStrain {
public:
  /// @param strain  E, symmetric: a rotation of the cell is no strain
  /// @throws core::InvalidInput for a component that is not finite, or an antisymmetric part above 1e-12 of E
  explicit PeriodicStrain(const Mat3& strain) : strain_(0.5 * (strain + strain.transpose())) {
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        core::expect_finite(strain(row, column), std::string("mean strain ") + "xyz"[row] + "xyz"[column]);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < row; ++column)
        core::expect(std::abs(strain(row, column) - strain(column, row)) <=
                         1e-12 * strain.cwiseAbs().maxCoeff(),
                     std::string("difference of the mean strains ") + "xyz"[row] + "xyz"[column] + " and " +
                         "xyz"[column] + "xyz"[row],
                     strain(row, column) - strain(column, row),
                     "a symmetric tensor is expected: a rotation of the cell strains nothing");
  }

  const Mat3& strain() const noexcept { return strain_; }

  /// @throws core::InvalidInput unless the box is periodic in all three directions
  static void validate(const geometry::Box& box) {
    box.validate();
    for (std::size_t k = 0; k < 3; ++k)
      core::expect(box.periodic[k], std::string("box along ") + "xyz"[k], "walled",
                   "a body that is periodic in all directions is expected under a mean strain");
  }

  /// Force of bond b on its first particle by the affine motion alone, N.
  template <BondsUnderStrain Forces>
  Vec3 affine_force(const Forces& forces, BondIndex b) const {
    const Split split = this->split(forces, b);
    return split.along + split.across;
  }

  /// What the affine motion does to the particles: the load whose equilibrium is u~.
  ///
  /// Where the bonds of a particle balance each other, as in a crystal, what rounding leaves (1e-12 of their sum) is zero.
  /// @return      [particles] N, N m; their sum is zero but for rounding
  /// @complexity  O(bonds), each bond twice; the same bits for any number of threads
  template <BondsUnderStrain Forces>
  particles::SpatialField<> load(const Forces& forces, core::ThreadPool& pool) const {
    particles::SpatialField<> load(forces.particle_count());
    core::parallel_for(pool, load.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        load[i] = load_of_particle(forces, static_cast<ParticleIndex>(i));
    });
    return load;
  }

  /// Forces on the first particle of every bond, affine and fluctuation together, what a stress estimator reads.
  /// @param fluctuation  [particles] u~, m, rad
  /// @param forces_out   [bonds] N, overwritten
  template <LoadedBondsUnderStrain Forces>
  void bond_forces(const Forces& forces, const particles::SpatialField<>& fluctuation,
                   std::vector<Vec3>& forces_out, core::ThreadPool& pool) const {
    forces_out.resize(forces.bond_count());
    core::parallel_for(pool, forces_out.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        forces_out[b] = total_force(forces, b, fluctuation);
    });
  }

  /// Mean stress of the cell.
  ///
  /// sigma = (1/V) sum over all bonds of F (x) b                     Love 1927, Weber 1966; [L17] section 2.5
  /// @param volume  V of the whole box, m^3
  /// @return        Pa, tension positive, not symmetrised: symmetric as far as moments are balanced
  /// @complexity    O(bonds)
  template <LoadedBondsUnderStrain Forces>
  Mat3 mean_stress(const Forces& forces, const particles::SpatialField<>& fluctuation, double volume,
                   core::ThreadPool& pool) const {
    return sum_over_bonds(forces, pool, [&](BondIndex b) { return total_force(forces, b, fluctuation); }) /
           volume;
  }

  /// Mean stress of the affine motion alone, u~ = 0 (the Voigt estimate): its energy bounds the true one from above.
  template <BondsUnderStrain Forces>
  Mat3 affine_stress(const Forces& forces, double volume, core::ThreadPool& pool) const {
    return sum_over_bonds(forces, pool, [&](BondIndex b) { return affine_force(forces, b); }) / volume;
  }

  /// Elastic energy of the strained cell, J: of the affine motion, minus the work of its load on u~, plus that of u~.
  ///
  /// Its error is of second order in that of u~, that of mean_stress() of first: each checks the other.
  /// @param load  [particles] as load() gave it
  template <LoadedBondsUnderStrain Forces>
  double energy(const Forces& forces, const particles::SpatialField<>& load,
                const particles::SpatialField<>& fluctuation, core::ThreadPool& pool) const {
    const double affine = 0.5 * affine_stress(forces, 1, pool).cwiseProduct(strain_).sum();
    const double work = core::parallel_sum(pool, load.size(), 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i)
        sum +=
            load[i].linear().dot(fluctuation[i].linear()) + load[i].angular().dot(fluctuation[i].angular());
      return sum;
    });
    return affine - work + forces.elastic_energy(fluctuation, pool);
  }

private:
  /// The affine force in its two parts: no moment may come of the one along the bond, not even by rounding.
  struct Split {
    Vec3 direction, along, across;
    double length;
  };

  template <class Forces>
  Split split(const Forces& forces, BondIndex b) const {
    const Vec3 n = forces.direction(b);
    const double length = forces.length(b);
    const auto stiffness = forces.stiffness(b);
    const Vec3 g = length * (strain_ * n);
    const double stretch = n.dot(g);
    return {n, (stiffness.normal * stretch) * n, stiffness.tangential * (g - stretch * n), length};
  }

  template <class Forces>
  particles::Spatial<> load_of_particle(const Forces& forces, ParticleIndex i) const {
    constexpr double rounding = 1e-12;
    particles::Spatial<> load;
    double force_size = 0, moment_size = 0;
    for (const BondIndex b : forces.bonds_of(i)) {
      const Split split = this->split(forces, b);
      const Vec3 force = split.along + split.across;
      const Vec3 moment = (0.5 * split.length) * split.direction.cross(split.across);
      const auto [first, second] = forces.ends(b);
      load.linear() += first == i ? force : Vec3(-force);
      load.angular() += moment;
      force_size += force.norm();
      moment_size += moment.norm();
    }
    if (load.linear().norm() <= rounding * force_size)
      load.linear().setZero();
    if (load.angular().norm() <= rounding * moment_size)
      load.angular().setZero();
    return load;
  }

  template <class Forces>
  Vec3 total_force(const Forces& forces, BondIndex b, const particles::SpatialField<>& fluctuation) const {
    return affine_force(forces, b) + forces.load(b, fluctuation).force;
  }

  /// sum of F (x) b, N m
  template <class Forces, class Force>
  static Mat3 sum_over_bonds(const Forces& forces, core::ThreadPool& pool, const Force& force) {
    return core::parallel_sum(pool, forces.bond_count(), Mat3(Mat3::Zero()),
                              [&](std::size_t begin, std::size_t end) {
                                Mat3 sum = Mat3::Zero();
                                for (std::size_t b = begin; b < end; ++b)
                                  sum += force(b) * (forces.length(b) * forces.direction(b)).transpose();
                                return sum;
                              });
  }

  Mat3 strain_;
};

} // namespace cdem::boundary
