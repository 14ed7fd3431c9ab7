#pragma once

/// @file
/// Around each of many points, the sum over the bonds weighted by a kernel: what spheres and coarse graining share.

#include <cdem/core/parallel.hpp>
#include <cdem/stress/detail/point_bins.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace cdem::stress::detail {

inline constexpr std::size_t points_per_block = 64;

/// Calls body(point) for every point, in blocks.
template <class Body>
void for_each_point(core::ThreadPool& pool, std::size_t count, Body&& body) {
  pool.for_each_block((count + points_per_block - 1) / points_per_block, [&](std::size_t block) {
    const std::size_t end = std::min(count, (block + 1) * points_per_block);
    for (std::size_t point = block * points_per_block; point < end; ++point)
      body(point);
  });
}

inline void expect_points(const std::vector<Vec3>& points) {
  core::expect(!points.empty(), "number of points", points.size(), "1 or more is expected");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      core::reject("point " + std::to_string(i), text_of(points[i]), "a finite point is expected");
}

/// Nothing may meet two images of itself.
inline void expect_one_image(const geometry::Box& box, double reach, const char* what) {
  for (std::size_t k = 0; k < 3; ++k)
    if (const double edge = box.size()[static_cast<Eigen::Index>(k)]; box.periodic[k])
      core::expect(2 * reach <= edge, what, reach,
                   "at most half the periodic edge along " + std::string(1, "xyz"[k]) + ", " +
                       core::to_text(edge / 2) + " m, is expected");
}

/// Checks the bonds; the length of the longest, m.
inline double checked_longest_branch(const network::BondNetwork& network, const BondLoads& loads,
                                     core::ThreadPool& pool) {
  std::vector<double> longest((network.size() + core::block_size - 1) / core::block_size, 0);
  core::parallel_for(pool, network.size(), [&](std::size_t begin, std::size_t end) {
    double& most = longest[begin / core::block_size];
    for (std::size_t bond = begin; bond < end; ++bond) {
      expect_sound(network, loads, bond);
      most = std::max(most, network.branch[bond].squaredNorm());
    }
  });
  return longest.empty() ? 0 : std::sqrt(*std::max_element(longest.begin(), longest.end()));
}

/// Points that hold something, in the order of their bins, to be met by distance.
class NearPoints {
public:
  NearPoints(const geometry::Box& box, const std::vector<Vec3>& positions, double reach)
      : box_(box), reach_(reach),
        bins_(box, positions.size(), reach, [&](std::size_t i) { return positions[i]; }) {
    sorted_.reserve(positions.size());
    for (const std::uint64_t i : bins_.order())
      sorted_.push_back(positions[i]);
  }

  /// Calls use(i, squared distance) for every point nearer than the reach.
  template <class Use>
  void for_each(const Vec3& place, Use&& use) const {
    bins_.for_each_stretch(place, reach_, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t k = begin; k < end; ++k)
        if (const double square = box_.minimum_image(sorted_[k] - place).squaredNorm();
            square < reach_ * reach_)
          use(static_cast<std::size_t>(bins_.order()[k]), square);
    });
  }

private:
  geometry::Box box_;
  double reach_;
  PointBins bins_;
  std::vector<Vec3> sorted_;
};

/// A branch as the search meets it: one cache line.
struct BondLine {
  Vec3 middle;
  Vec3 direction; ///< of length 1
  double length;
  std::uint64_t bond;
};

/// Sums over the bonds, weighted by a kernel phi around each point:
///
///     stress:  f (x) d * integral over s of phi(x(s)) ds          couple stress:  integral of T(s) phi(x(s)) ds (x) d
///
/// s from 0 to 1 along the branch d, T(s) the moment transferred there. T is linear in s, so the second integral is that of
/// phi times T at the centroid of phi along the branch.
/// @tparam Kernel  reach(), integral(), first_moment(): see SmoothingKernel
/// @return         stress, couple_stress and particles; the caller sets the volumes
/// @complexity     O(bonds + points * bonds within reach); 80 bytes a bond beside the result
template <class Kernel>
StressField sum_near_points(const std::vector<Vec3>& points, const Kernel& kernel, const geometry::Box& box,
                            const particles::ParticleSet& particles, const network::BondNetwork& network,
                            const BondLoads& loads, core::ThreadPool& pool) {
  particles.validate();
  expect_matching_sizes(particles, network, loads);
  const double reach = kernel.reach();
  const double far = reach + 0.5 * checked_longest_branch(network, loads, pool);
  expect_one_image(box, far, "radius and half the longest branch");
  const auto middle_of = [&](std::size_t bond) -> Vec3 {
    return particles.position[network.first[bond]] + 0.5 * network.branch[bond];
  };
  const PointBins bins(box, network.size(), far, middle_of);
  std::vector<BondLine> lines(network.size());
  core::parallel_for(pool, lines.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint64_t bond = bins.order()[k];
      const double length = network.branch[bond].norm();
      lines[k] = {middle_of(bond), network.branch[bond] / length, length, bond};
    }
  });
  const NearPoints centres(box, particles.position, reach);

  StressField field;
  field.particles.assign(points.size(), 0);
  field.stress.assign(points.size(), Mat3::Zero());
  field.couple_stress.assign(loads.has_moments() ? points.size() : 0, Mat3::Zero());
  for_each_point(pool, points.size(), [&](std::size_t point) {
    Mat3 stress = Mat3::Zero(), couple = Mat3::Zero();
    const auto add = [&](const BondLine& line) {
      const Vec3 middle = box.minimum_image(line.middle - points[point]);
      const double place = middle.dot(line.direction); // of the middle, along the branch
      const double square = std::max(0.0, middle.squaredNorm() - place * place);
      if (square >= reach * reach || std::abs(place) >= reach + 0.5 * line.length)
        return;
      const double chord = std::sqrt(reach * reach - square);
      const double begin = std::max(place - 0.5 * line.length, -chord);
      const double end = std::min(place + 0.5 * line.length, chord);
      if (!(end > begin))
        return;
      const double integral = kernel.integral(begin, end, square);
      const Vec3& force = loads.forces[line.bond];
      stress.noalias() += (integral * force) * line.direction.transpose();
      if (loads.has_moments()) {
        // Where along the branch, s - 1/2 = (t - place) / length; d x f = length * direction x f.
        const double lever = kernel.first_moment(begin, end, square) - place * integral;
        const Vec3 transferred = integral * loads.moments[line.bond] - lever * line.direction.cross(force);
        couple.noalias() += transferred * line.direction.transpose();
      }
    };
    bins.for_each_stretch(points[point], far, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t k = begin; k < end; ++k)
        add(lines[k]);
    });
    centres.for_each(points[point], [&](std::size_t, double) { ++field.particles[point]; });
    field.stress[point] = stress;
    if (loads.has_moments())
      field.couple_stress[point] = couple;
  });
  return field;
}

} // namespace cdem::stress::detail
