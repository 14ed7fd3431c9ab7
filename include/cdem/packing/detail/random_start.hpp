#pragma once

/// @file
/// Random radii and a random, loose arrangement of spheres.

#include <cdem/core/error.hpp>
#include <cdem/core/random.hpp>
#include <cdem/packing/detail/cell_grid.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
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

/// Checks the law of the radii that generators share: their number, CoV and cuts.
/// @throws core::InvalidInput naming the value that is out of its range
template <class Parameters>
void expect_size_law(const Parameters& p) {
  core::expect(p.particles >= 1 && p.particles <= 100000000, "number of particles", p.particles,
               "1 to 100000000 is expected");
  core::expect(p.cov >= 0 && p.cov <= 0.5, "CoV of the radii", p.cov, "0 to 0.5 is expected");
  core::expect(p.truncation >= 1 && p.truncation <= 6, "truncation", p.truncation,
               "1 to 6 standard deviations is expected");
  core::expect(p.smallest_radius >= 0.01 && p.smallest_radius <= 0.9, "smallest radius over the mean",
               p.smallest_radius, "0.01 to 0.9 is expected");
}

/// Radii of that law, at a mean diameter of 1.
template <class Parameters>
std::vector<double> draw_sizes(const Parameters& p, core::Random& random) {
  const double half_width = p.truncation * p.cov;
  std::vector<double> sizes = truncated_normal(
      p.particles, p.cov, std::max(1 - half_width, p.smallest_radius), 1 + half_width, random);
  const double mean = std::accumulate(sizes.begin(), sizes.end(), 0.0) / static_cast<double>(sizes.size());
  for (double& size : sizes)
    size /= 2 * mean;
  return sizes;
}

/// @param diameter  of the largest sphere, over the side of the cube
/// @throws core::InvalidInput unless the spheres are small enough for the box: periodic images may not see each other
template <class Parameters>
void expect_room(const Parameters& p, double diameter, bool periodic) {
  const double limit = periodic ? 0.45 : 1;
  core::expect(diameter < limit, "number of particles", p.particles,
               "more are expected: the largest sphere's diameter would be " + core::to_text(diameter) +
                   " of the side, and below " + core::to_text(limit) + " is needed");
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
