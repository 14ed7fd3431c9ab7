#pragma once

/// @file
/// Love–Weber stress of the balls around chosen points.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/geometry/ball_in_box.hpp>
#include <cdem/stress/detail/bonds_near_points.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace cdem::stress {

namespace detail {
/// The kernel of a ball: 1 inside.
struct Inside {
  double radius;
  double reach() const { return radius; }
  double integral(double begin, double end, double) const { return end - begin; }
  double first_moment(double begin, double end, double) const { return 0.5 * (end * end - begin * begin); }
};
} // namespace detail

/// Love–Weber stress averaged over a ball around each of some points, the halo.
///
/// sigma = (1/V) sum over bonds of (share of the branch inside the ball) f (x) d;  V = 4/3 pi r^3
///
/// and the couple stress likewise from the moments transferred, see BondLoads. Near a wall of the body V is the volume of the ball
/// between the walls of its box, exactly; what lies beyond carries nothing. A ball at a face thus averages over less, and over one
/// side. Balls may overlap, so the sum of V sigma has no meaning and StressField::outside stays 0.
class Halo {
public:
  /// @param points  [specimens] m, inside the walls of the box
  /// @param radius  r of the balls, m
  /// @param box     the body's; its periodic directions have no walls
  /// @throws core::InvalidInput for a bad box, no point, a point that is not finite or lies outside the walls, or a radius that is
  ///         not a finite number above 0 or exceeds half a periodic edge
  Halo(std::vector<Vec3> points, double radius, const geometry::Box& box)
      : points_(std::move(points)), radius_(radius), box_(box) {
    box.validate();
    core::expect_positive(radius, "radius of the balls", "m");
    detail::expect_points(points_);
    detail::expect_one_image(box, radius, "radius of the balls");
    volume_.reserve(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      for (int k = 0; k < 3; ++k)
        if (!box.periodic[static_cast<std::size_t>(k)] &&
            !(points_[i][k] >= box.lower[k] && points_[i][k] <= box.upper[k]))
          core::reject(std::string("coordinate ") + "xyz"[k] + " of point " + std::to_string(i),
                       points_[i][k],
                       "one from " + core::to_text(box.lower[k]) + " to " + core::to_text(box.upper[k]) +
                           " m, inside the box, is expected");
      volume_.push_back(geometry::volume_in_box(points_[i], radius, box));
    }
  }

  const std::vector<Vec3>& points() const noexcept { return points_; }
  double radius() const noexcept { return radius_; }

  /// Stress in each ball, on one thread.
  ///
  /// @param particles  positions at rest
  /// @param network    bonds and branches at rest
  /// @param loads      [bonds] forces, N, on the bond's first particle; moments, N m, or none
  /// @return           [points] Pa, tension positive, not symmetrised; volumes; centres inside
  /// @throws core::InvalidInput for a bad particle or bond, a number of loads other than the bonds', a load that is not finite, or a
  ///         radius and half a branch that exceed half a periodic edge
  /// @complexity       O(bonds + points * bonds in a ball); 80 bytes a bond beside the result
  StressField estimate(const particles::ParticleSet& particles, const network::BondNetwork& network,
                       const BondLoads& loads) const {
    core::ThreadPool one_thread;
    return estimate(particles, network, loads, one_thread);
  }

  /// The same on the threads of `pool`: every ball sums for itself, so the bytes are the same for any number of threads.
  StressField estimate(const particles::ParticleSet& particles, const network::BondNetwork& network,
                       const BondLoads& loads, core::ThreadPool& pool) const {
    StressField field =
        detail::sum_near_points(points_, detail::Inside{radius_}, box_, particles, network, loads, pool);
    field.volume = volume_;
    for (auto* tensors : {&field.stress, &field.couple_stress})
      for (std::size_t i = 0; i < tensors->size(); ++i)
        (*tensors)[i] /= volume_[i];
    return field;
  }

private:
  std::vector<Vec3> points_;
  double radius_;
  geometry::Box box_;
  std::vector<double> volume_;
};

static_assert(StressEstimator<Halo> && EstimatesCoupleStress<Halo>);

} // namespace cdem::stress
