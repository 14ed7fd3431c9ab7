#pragma once

/// @file
/// Random radii and a random, loose arrangement of spheres.

#include <cdem/core/random.hpp>
#include <cdem/packing/detail/cell_grid.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace cdem::packing::detail {

/// Draws of a normal variable of mean 1 and standard deviation `cov`, those outside [lower, upper] rejected.
inline std::vector<double> truncated_normal(std::size_t count, double cov, double lower, double upper,
                                            core::Random& random) {
  std::vector<double> values(count, 1.0);
  if (cov > 0)
    for (double& value : values)
      do
        value = 1 + cov * random.normal();
      while (value < lower || value > upper);
  return values;
}

/// Volume of spheres of these radii.
inline double volume_of_spheres(const std::vector<double>& radii) {
  return 4.0 / 3.0 * std::numbers::pi *
         std::accumulate(radii.begin(), radii.end(), 0.0,
                         [](double sum, double radius) { return sum + radius * radius * radius; });
}

/// Places spheres one after another, the largest first, uniformly where they overlap none of those before (random
/// sequential addition) and no wall.
///
/// @param radii   [spheres] for the unit cube
/// @return        [spheres] centres, or nothing if a sphere found no room in 10,000 trials
/// @complexity    O(spheres) at densities below 0.25
inline std::vector<Vec3> add_sequentially(const std::vector<double>& radii, bool periodic,
                                          core::Random& random) {
  constexpr int trials = 10000;
  const double largest = *std::max_element(radii.begin(), radii.end());
  std::vector<ParticleIndex> order(radii.size());
  std::iota(order.begin(), order.end(), ParticleIndex{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](ParticleIndex a, ParticleIndex b) { return radii[a] > radii[b]; });

  CellGrid grid(radii.size(), std::cbrt(1.0 / static_cast<double>(radii.size())), periodic);
  std::vector<Vec3> centres(radii.size());
  for (const ParticleIndex i : order) {
    const double margin = periodic ? 0 : radii[i];
    bool placed = false;
    for (int trial = 0; trial < trials && !placed; ++trial) {
      for (int k = 0; k < 3; ++k)
        centres[i][k] = random.uniform(margin, 1 - margin);
      placed = grid.visit_near(centres[i], radii[i] + largest, [&](ParticleIndex j) {
        Vec3 d = centres[j] - centres[i];
        if (periodic)
          d = nearest_image(d);
        const double reach = radii[i] + radii[j];
        return d.squaredNorm() > reach * reach;
      });
    }
    if (!placed)
      return {};
    grid.insert(i, centres[i]);
  }
  return centres;
}

} // namespace cdem::packing::detail
