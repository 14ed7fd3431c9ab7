#pragma once

/// @file
/// Continuous fields of a body of particles: stress, couple stress, density, momentum.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/particles/inertia.hpp>
#include <cdem/particles/spatial_field.hpp>
#include <cdem/stress/detail/bonds_near_points.hpp>
#include <cdem/stress/kernels.hpp>
#include <cdem/stress/stress_estimator.hpp>
#include <cdem/stress/tessellation/hexahedra.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace cdem::stress {

/// Density and motion of a body at points, coarse-grained.
struct CoarseMotion {
  std::vector<double> density;      ///< [points] rho, kg/m^3
  std::vector<Vec3> momentum;       ///< [points] p, kg/(m^2 s)
  std::vector<Vec3> velocity;       ///< [points] p/rho, m/s; 0 where nothing is near
  std::vector<Mat3> kinetic_stress; ///< [points] Pa, tension positive, so never positive on its diagonal
};

/// Coarse graining: the stress, at any point, that balances the momentum of the smeared particles exactly.
///
///     sigma(r) = sum over bonds of f (x) d * integral from 0 to 1 of phi(r - x(s)) ds                 Goldhirsch 2010
///     mu(r)    = sum over bonds of (integral of T(s) phi(r - x(s)) ds) (x) d
///
/// x(s) runs along the branch d, phi is the kernel, T(s) the moment that the bond transfers (BondLoads). Both integrals are exact.
/// With b and m the external forces and moments of the particles smeared by the same kernel (see spread()), in a body at rest
///
///     div sigma + b = 0          div mu + e:sigma + m = 0,  (e:sigma)_x = sigma_zy - sigma_yz, and so on
///
/// at every point, div taken over the columns; in a moving body div(sigma + kinetic stress) + b is the density times the material
/// acceleration. The kernel does not know of the body's surface: nearer to it than the reach, stress and density fade out together.
/// @tparam Kernel  phi, a SmoothingKernel
template <SmoothingKernel Kernel = Lucy>
class CoarseGraining {
public:
  /// At any points.
  ///
  /// @param points  [points] m; inside the body or not
  /// @param box     the body's: fields are periodic where it is
  /// @throws core::InvalidInput for a bad box, no point, a point that is not finite, or a kernel that reaches farther than half a
  ///         periodic edge
  CoarseGraining(std::vector<Vec3> points, Kernel kernel, const geometry::Box& box)
      : points_(std::move(points)), kernel_(std::move(kernel)), box_(box) {
    box.validate();
    detail::expect_points(points_);
    detail::expect_one_image(box, kernel_.reach(), "reach of the kernel");
    volume_ = 1 / kernel_.density(0);
  }

  /// At the centres of a grid's cells. The volumes are the cells', so that the sum of V sigma tends to the moment of the forces (less
  /// what is smeared out of the box) as the grid is refined.
  CoarseGraining(const tessellation::Hexahedra& grid, Kernel kernel)
      : CoarseGraining(centres_of(grid), std::move(kernel), grid.box()) {
    volume_ = grid.volume(0);
  }

  const std::vector<Vec3>& points() const noexcept { return points_; }
  const Kernel& kernel() const noexcept { return kernel_; }

  /// Stress at each point, on one thread.
  ///
  /// @param particles  positions at rest
  /// @param network    bonds and branches at rest
  /// @param loads      [bonds] forces, N, on the bond's first particle; moments, N m, or none
  /// @return           [points] Pa, tension positive, not symmetrised; volume: the grid's cell, or 1/phi(0) of points; centres within
  ///                   reach
  /// @throws core::InvalidInput for a bad particle or bond, a number of loads other than the bonds', a load that is not finite, or a
  ///         reach and half a branch that exceed half a periodic edge
  /// @complexity       O(bonds + points * bonds within reach); 80 bytes a bond beside the result
  StressField estimate(const particles::ParticleSet& particles, const network::BondNetwork& network,
                       const BondLoads& loads) const {
    core::ThreadPool one_thread;
    return estimate(particles, network, loads, one_thread);
  }

  /// The same on the threads of `pool`: every point sums for itself, so the bytes are the same for any number of threads.
  StressField estimate(const particles::ParticleSet& particles, const network::BondNetwork& network,
                       const BondLoads& loads, core::ThreadPool& pool) const {
    StressField field = detail::sum_near_points(points_, kernel_, box_, particles, network, loads, pool);
    field.volume.assign(points_.size(), volume_);
    return field;
  }

  /// A quantity of the particles smeared: sum over particles of q phi(r - x). Of masses it is the density, of m v the momentum, of
  /// external forces the body force b.
  ///
  /// @param positions  [particles] m
  /// @param values     [particles] double, Vec3 or Mat3
  /// @return           [points] value a m^3
  /// @throws core::InvalidInput for different numbers, or a position that is not finite
  template <class Value>
  std::vector<Value> spread(const std::vector<Vec3>& positions, const std::vector<Value>& values,
                            core::ThreadPool& pool) const {
    core::expect(values.size() == positions.size(), "number of values", values.size(),
                 "one per particle (" + std::to_string(positions.size()) + ") is expected");
    const detail::NearPoints near = near_points(positions);
    std::vector<Value> result(points_.size(), zero<Value>());
    detail::for_each_point(pool, points_.size(), [&](std::size_t point) {
      for_each_weight(near, point,
                      [&](std::size_t i, double weight) { result[point] += weight * values[i]; });
    });
    return result;
  }

  /// Density, momentum, velocity and kinetic stress at each point.
  ///
  ///     rho = sum of m phi    p = sum of m v phi    V = p/rho    sigma_k = -sum of m (v - V) (x) (v - V) phi    Goldhirsch 2010
  ///
  /// @param velocity  [particles] m/s; the angular part is not read
  /// @throws core::InvalidInput for particles, masses or velocities that do not fit together
  CoarseMotion motion(const particles::ParticleSet& particles, const particles::Inertia& inertia,
                      const particles::SpatialField<>& velocity, core::ThreadPool& pool) const {
    particles.validate();
    inertia.validate(particles.size());
    core::expect(velocity.size() == particles.size(), "number of velocities", velocity.size(),
                 "one per particle (" + std::to_string(particles.size()) + ") is expected");
    const detail::NearPoints near = near_points(particles.position);
    const std::size_t count = points_.size();
    CoarseMotion motion{std::vector<double>(count, 0), std::vector<Vec3>(count, Vec3::Zero()),
                        std::vector<Vec3>(count, Vec3::Zero()), std::vector<Mat3>(count, Mat3::Zero())};
    detail::for_each_point(pool, count, [&](std::size_t point) {
      const auto for_each_mass = [&](auto&& use) {
        for_each_weight(near, point, [&](std::size_t i, double weight) {
          use(weight * inertia.mass[i], Vec3(velocity[i].linear()));
        });
      };
      for_each_mass([&](double mass, const Vec3& v) {
        motion.density[point] += mass;
        motion.momentum[point] += mass * v;
      });
      if (motion.density[point] == 0)
        return;
      const Vec3 mean = motion.momentum[point] / motion.density[point];
      motion.velocity[point] = mean;
      for_each_mass([&](double mass, const Vec3& v) {
        motion.kinetic_stress[point].noalias() -= (mass * (v - mean)) * (v - mean).transpose();
      });
    });
    return motion;
  }

private:
  static std::vector<Vec3> centres_of(const tessellation::Hexahedra& grid) {
    std::vector<Vec3> centres;
    centres.reserve(grid.cell_count());
    for (std::size_t cell = 0; cell < grid.cell_count(); ++cell)
      centres.push_back(grid.centre(cell));
    return centres;
  }

  template <class Value>
  static Value zero() {
    if constexpr (std::is_arithmetic_v<Value>)
      return 0;
    else
      return Value::Zero();
  }

  detail::NearPoints near_points(const std::vector<Vec3>& positions) const {
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (!positions[i].allFinite())
        core::reject("position of particle " + std::to_string(i), detail::text_of(positions[i]),
                     "a finite point is expected");
    return {box_, positions, kernel_.reach()};
  }

  /// Calls use(i, phi) for every particle within reach of a point.
  template <class Use>
  void for_each_weight(const detail::NearPoints& near, std::size_t point, Use&& use) const {
    near.for_each(points_[point],
                  [&](std::size_t i, double square) { use(i, kernel_.density(std::sqrt(square))); });
  }

  std::vector<Vec3> points_;
  Kernel kernel_;
  geometry::Box box_;
  double volume_ = 0;
};

static_assert(StressEstimator<CoarseGraining<>> && EstimatesCoupleStress<CoarseGraining<>>);
static_assert(StressEstimator<CoarseGraining<Gaussian>>);

} // namespace cdem::stress
