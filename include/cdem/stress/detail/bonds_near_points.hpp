#pragma once

/// @file
/// Around each of many points, the sum over the bonds weighted by a kernel: what spheres and coarse graining share.

#include <cdem/core/parallel.hpp>
#include <cdem/stress/detail/point_bins.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
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

/// [points] the number of centres nearer than the reach.
inline std::vector<std::uint32_t> count_near(const std::vector<Vec3>& points, double reach,
                                             const geometry::Box& box, const std::vector<Vec3>& centres,
                                             core::ThreadPool& pool) {
  const PointBins bins(box, centres.size(), reach, [&](std::size_t i) { return centres[i]; });
  std::vector<std::uint32_t> count(points.size(), 0);
  for_each_point(pool, points.size(), [&](std::size_t point) {
    bins.for_each_near(points[point], reach, [&](std::size_t i) {
      count[point] += box.minimum_image(centres[i] - points[point]).squaredNorm() < reach * reach ? 1U : 0U;
    });
  });
  return count;
}

/// Sums over the bonds, weighted by a kernel phi around each point:
///
///     stress:  f (x) d * integral over s of phi(x(s)) ds          couple stress:  integral of T(s) phi(x(s)) ds (x) d
///
/// s from 0 to 1 along the branch d, T(s) the moment transferred there. T is linear in s, so the second integral is that of
/// phi times T at the centroid of phi along the branch.
/// @tparam Kernel  reach(), integral(), first_moment(): see SmoothingKernel
/// @return         stress, couple_stress and particles; the caller sets the volumes
/// @complexity     O(bonds + points * bonds within reach); 8 bytes a bond beside the result
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

  StressField field;
  field.particles = count_near(points, reach, box, particles.position, pool);
  field.stress.assign(points.size(), Mat3::Zero());
  field.couple_stress.assign(loads.has_moments() ? points.size() : 0, Mat3::Zero());
  for_each_point(pool, points.size(), [&](std::size_t point) {
    Mat3 stress = Mat3::Zero(), couple = Mat3::Zero();
    bins.for_each_near(points[point], far, [&](std::size_t bond) {
      const Vec3& branch = network.branch[bond];
      const Vec3 middle = box.minimum_image(middle_of(bond) - points[point]);
      const double length = branch.norm(), place = middle.dot(branch) / length; // of the middle, along
      const double square = std::max(0.0, middle.squaredNorm() - place * place);
      if (square >= reach * reach)
        return;
      const double chord = std::sqrt(reach * reach - square);
      const double begin = std::max(place - 0.5 * length, -chord),
                   end = std::min(place + 0.5 * length, chord);
      if (!(end > begin))
        return;
      const double weight = kernel.integral(begin, end, square) / length;
      stress.noalias() += (weight * loads.forces[bond]) * branch.transpose();
      if (loads.has_moments()) {
        const double moment = kernel.first_moment(begin, end, square) / length;
        // Where along the branch: place + (s - 1/2) length, whose kernel-weighted mean is moment / weight.
        const Vec3 transferred = weight * loads.moments[bond] -
                                 ((moment - place * weight) / length) * branch.cross(loads.forces[bond]);
        couple.noalias() += transferred * branch.transpose();
      }
    });
    field.stress[point] = stress;
    if (loads.has_moments())
      field.couple_stress[point] = couple;
  });
  return field;
}

} // namespace cdem::stress::detail
