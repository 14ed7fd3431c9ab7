#pragma once

/// @file
/// One pass over all near pairs of a packing: distances, gaps, contacts.

#include <cdem/core/parallel.hpp>
#include <cdem/packing/detail/pair_cells.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace cdem::packing::detail {

/// What is counted.
struct PairCounts {
  double distance_class = 0;        ///< width of a class of distances, m; class c is centred on c widths
  std::size_t distance_classes = 0; ///< the first is half as wide
  std::vector<double> gap;          ///< ascending gaps, m: pairs with at most that gap between their surfaces
  double contact_tolerance = 0;     ///< gaps up to this part of the sum of the radii are contacts
};

struct PairStatistics {
  std::vector<std::uint64_t> distance; ///< [distance_classes] pairs
  std::vector<std::uint64_t> within;   ///< [gaps] pairs with at most that gap
  std::vector<std::array<ParticleIndex, 2>> contacts;
  double largest_overlap = 0; ///< over the sum of the radii

  void join(PairStatistics&& other) {
    for (std::size_t c = 0; c < distance.size(); ++c)
      distance[c] += other.distance[c];
    for (std::size_t g = 0; g < within.size(); ++g)
      within[g] += other.within[g];
    contacts.insert(contacts.end(), other.contacts.begin(), other.contacts.end());
    largest_overlap = std::max(largest_overlap, other.largest_overlap);
  }
};

/// Blocks of work of the passes over a whole packing: few, since each holds counts of its own, and the same for any number
/// of threads.
inline constexpr std::size_t quality_blocks = 64;

/// Counts all pairs within `reach` (m), which covers the gaps and contacts asked for.
/// @complexity O(pairs within reach), shared by the threads
inline PairStatistics count_pairs(const particles::ParticleSet& spheres, const geometry::Box& box,
                                  double reach, const PairCounts& counts, core::ThreadPool& pool) {
  const PairCells cells(spheres, box, reach);
  std::vector<double> radius(spheres.size());
  for (std::size_t i = 0; i < radius.size(); ++i)
    radius[i] = spheres.radius[cells.number(i)];
  const double per_class = 1 / counts.distance_class;
  const double widest = counts.gap.empty() ? 0 : counts.gap.back();
  const std::size_t rows = cells.rows(), blocks = std::min(rows, quality_blocks);
  std::vector<PairStatistics> part(blocks);
  pool.for_each_block(blocks, [&](std::size_t block) {
    PairStatistics& own = part[block];
    own.distance.assign(counts.distance_classes + 1, 0); // the last holds what is farther
    own.within.assign(counts.gap.size() + 1, 0); // pairs by the first gap that holds them; the last: none
    cells.visit_pairs(rows * block / blocks, rows * (block + 1) / blocks,
                      [&](ParticleIndex i, ParticleIndex j, double squared) {
                        const double distance = std::sqrt(squared), sum = radius[i] + radius[j],
                                     gap = distance - sum;
                        const auto c = static_cast<std::size_t>(distance * per_class + 0.5);
                        ++own.distance[std::min(c, counts.distance_classes)];
                        if (gap > std::max(widest, counts.contact_tolerance * sum))
                          return;
                        const auto first = std::lower_bound(counts.gap.begin(), counts.gap.end(), gap);
                        ++own.within[static_cast<std::size_t>(first - counts.gap.begin())];
                        if (gap <= counts.contact_tolerance * sum)
                          own.contacts.push_back({cells.number(i), cells.number(j)});
                        own.largest_overlap = std::max(own.largest_overlap, -gap / sum);
                      });
  });
  PairStatistics all = std::move(part.front());
  for (std::size_t block = 1; block < blocks; ++block)
    all.join(std::move(part[block]));
  all.distance.pop_back();
  all.within.pop_back();
  for (std::size_t g = 1; g < all.within.size(); ++g)
    all.within[g] += all.within[g - 1];
  return all;
}

/// Integral of 4 pi s^2 c(s) from 0 to r, m^6, with c(s) the volume of the box in which a point and another at distance s,
/// averaged over directions, both lie inside: the box's where it is periodic, less near walls.
///
/// c(s) = mean over unit vectors u of prod_k (L_k - s |u_k| [walled]), a polynomial with the means of |u_k|,
/// |u_k u_l|, |u_x u_y u_z| = 1/2, 2/(3 pi), 1/(4 pi)             exact for r up to the shortest walled edge
inline double pair_volume(const geometry::Box& box, double r) {
  const Vec3 edge = box.size();
  constexpr std::array<double, 4> mean{1, 0.5, 2 / (3 * std::numbers::pi), 0.25 / std::numbers::pi};
  double integral = 0;
  for (unsigned subset = 0; subset < 8; ++subset) { // the axes that contribute s |u_k|
    double factor = 1;
    int power = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const bool chosen = (subset >> k & 1U) != 0;
      if (chosen && box.periodic[k])
        factor = 0;
      factor *= chosen ? -1 : edge[static_cast<Eigen::Index>(k)];
      power += chosen;
    }
    integral += factor * mean[static_cast<std::size_t>(power)] * std::pow(r, 3 + power) / (3 + power);
  }
  return 4 * std::numbers::pi * integral;
}

/// What holds a packing: contacts of each sphere, and the spheres that are held by none.
struct Skeleton {
  std::vector<std::uint32_t> contacts; ///< [spheres] of each, walls included, rattlers too
  std::uint32_t rattlers = 0;          ///< spheres with fewer than four contacts, taken out again and again
  double contact_number = 0;           ///< mean contacts of the others among themselves and with walls
};

/// Takes rattlers out of the contacts until every sphere left has four.
/// @param walls  [spheres] contacts with walls
/// @complexity   O(spheres + contacts)
inline Skeleton skeleton(std::size_t spheres, const std::vector<std::array<ParticleIndex, 2>>& pairs,
                         const std::vector<std::uint32_t>& walls) {
  std::vector<std::size_t> start(spheres + 1, 0);
  for (const auto& pair : pairs)
    for (const ParticleIndex i : pair)
      ++start[i + std::size_t{1}];
  for (std::size_t i = 1; i < start.size(); ++i)
    start[i] += start[i - 1];
  std::vector<ParticleIndex> partner(2 * pairs.size());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (const auto& [i, j] : pairs) {
    partner[next[i]++] = j;
    partner[next[j]++] = i;
  }

  Skeleton result;
  result.contacts.resize(spheres);
  for (std::size_t i = 0; i < spheres; ++i)
    result.contacts[i] = static_cast<std::uint32_t>(start[i + 1] - start[i]) + walls[i];
  std::vector<std::uint32_t> left = result.contacts;
  std::vector<char> loose(spheres, 0);
  std::vector<ParticleIndex> waiting;
  for (ParticleIndex i = 0; i < spheres; ++i)
    if (left[i] < 4) {
      loose[i] = 1;
      waiting.push_back(i);
    }
  while (!waiting.empty()) {
    const ParticleIndex i = waiting.back();
    waiting.pop_back();
    ++result.rattlers;
    for (std::size_t k = start[i]; k < start[i + 1]; ++k)
      if (const ParticleIndex j = partner[k]; !loose[j] && --left[j] < 4) {
        loose[j] = 1;
        waiting.push_back(j);
      }
  }
  double sum = 0;
  for (std::size_t i = 0; i < spheres; ++i)
    sum += loose[i] ? 0 : left[i];
  if (result.rattlers < spheres)
    result.contact_number = sum / static_cast<double>(spheres - result.rattlers);
  return result;
}

} // namespace cdem::packing::detail
