#pragma once

/// @file
/// Which particles of a packing are bonded: those closer than a given distance, or as many as give a wanted
/// coordination number.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/core/types.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/network/kd_tree.hpp>
#include <cdem/network/neighbour_search.hpp>
#include <cdem/particles/particle_set.hpp>
#include <cdem/particles/space_filling_order.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace cdem::network {

/// Length D by which eps is multiplied in eq. 1, m: the side of a cube, the cube root of the volume of
/// another box.
inline double characteristic_length(const geometry::Box& box) {
  return std::cbrt(box.volume());
}

namespace detail {

/// Two particles and the gap between their surfaces.
struct Pair {
  double gap; ///< |branch| - R_first - R_second, m; negative where they overlap
  ParticleIndex first;
  ParticleIndex second;
};

/// The order in which bonds are chosen: smallest gap first, equal gaps by the particles' numbers.
inline bool closer(const Pair& a, const Pair& b) {
  return std::tie(a.gap, a.first, a.second) < std::tie(b.gap, b.first, b.second);
}

inline double largest_radius(const particles::ParticleSet& particles) {
  return *std::max_element(particles.radius.begin(), particles.radius.end());
}

/// Largest centre distance at which two particles are sure to meet through one periodic image only, m: half
/// of the smallest periodic edge (less a millionth, far above rounding); infinite if no direction is
/// periodic.
inline double largest_single_image_distance(const geometry::Box& box) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k)
    if (box.periodic[static_cast<std::size_t>(k)])
      smallest = std::min(smallest, box.upper[k] - box.lower[k]);
  return smallest / 2 * (1 - 1e-6);
}

/// @throws core::InvalidInput if two particles that far apart could be bonded through two periodic images
inline void expect_one_image(const geometry::Box& box, double largest_distance) {
  for (int k = 0; k < 3; ++k)
    if (box.periodic[static_cast<std::size_t>(k)])
      core::expect(
          largest_distance <= largest_single_image_distance(box),
          std::string("edge of the periodic box along ") + "xyz"[k], box.upper[k] - box.lower[k],
          "more than " + core::to_text(2 * largest_distance) +
              " m (two largest diameters and twice eps*D) is expected, so that two particles are bonded "
              "through one image at most");
}

/// The particles along a space-filling curve and a search among them: a query then finds the tree's nodes and points
/// that the query before has brought into the cache, which makes the search several times faster.
template <NeighbourSearch Search>
class SortedSearch {
public:
  SortedSearch(const particles::ParticleSet& particles, const geometry::Box& box)
      : box_(box), number_(particles::space_filling_order(particles, box)),
        sorted_(particles::reorder(particles, number_)), search_(sorted_.position, box) {}

  /// Every pair of particles whose surfaces are at most `largest_gap` (m) apart, each once, in an order that does not
  /// depend on the number of threads.
  ///
  /// The larger sphere of a pair finds the smaller one (of two equal ones, the first along the curve). So each
  /// particle looks no farther than its own diameter and the gap, which in a wide size distribution is far nearer
  /// than its radius and the largest.
  std::vector<Pair> pairs_within(double largest_gap, core::ThreadPool& pool) const {
    std::vector<std::vector<Pair>> found((sorted_.size() + core::block_size - 1) / core::block_size);
    core::parallel_for(pool, sorted_.size(), [&](std::size_t begin, std::size_t end) {
      std::vector<Pair>& pairs = found[begin / core::block_size];
      for (std::size_t index = begin; index < end; ++index) {
        const auto i = static_cast<ParticleIndex>(index);
        const double radius = sorted_.radius[i];
        search_.for_each_within(sorted_.position[i], 2 * radius + largest_gap, [&](ParticleIndex j) {
          const bool i_finds_j = sorted_.radius[j] < radius || (sorted_.radius[j] == radius && i < j);
          if (!i_finds_j)
            return;
          const Pair pair = pair_of(i, j);
          if (pair.gap <= largest_gap)
            pairs.push_back(pair);
        });
      }
    });
    return joined(std::move(found));
  }

private:
  /// @throws core::InvalidInput if the centres coincide: such a bond has no direction
  Pair pair_of(ParticleIndex i, ParticleIndex j) const {
    const auto [first, second] = std::minmax(number_[i], number_[j]);
    const double distance = box_.minimum_image(sorted_.position[j] - sorted_.position[i]).norm();
    if (!(distance > 0))
      core::reject("distance between the centres of particles " + std::to_string(first) + " and " +
                       std::to_string(second),
                   distance, "a length above 0 m is expected");
    return {distance - (sorted_.radius[i] + sorted_.radius[j]), first, second};
  }

  static std::vector<Pair> joined(std::vector<std::vector<Pair>> parts) {
    std::size_t count = 0;
    for (const auto& part : parts)
      count += part.size();
    std::vector<Pair> all;
    all.reserve(count);
    for (auto& part : parts) {
      all.insert(all.end(), part.begin(), part.end());
      std::vector<Pair>().swap(part); // no second copy of the whole
    }
    return all;
  }

  geometry::Box box_;
  std::vector<ParticleIndex> number_; ///< of each particle along the curve in the set given
  particles::ParticleSet sorted_;
  Search search_;
};

/// The network of these pairs, sorted by (first, second): a counting sort by `first`, then each particle's
/// few.
inline BondNetwork assemble(const particles::ParticleSet& particles, const geometry::Box& box,
                            const std::vector<Pair>& pairs, core::ThreadPool& pool) {
  std::vector<BondIndex> next(particles.size() + 1, 0); // where the next bond of each particle goes
  for (const Pair& pair : pairs)
    ++next[pair.first + std::size_t{1}];
  for (std::size_t i = 1; i < next.size(); ++i)
    next[i] += next[i - 1];

  BondNetwork network;
  network.particle_count = particles.size();
  network.first.resize(pairs.size());
  network.second.resize(pairs.size());
  network.branch.resize(pairs.size());
  for (const Pair& pair : pairs)
    network.second[next[pair.first]++] = pair.second;

  // Now next[i] is the end of the bonds of particle i, and next[i - 1] their beginning.
  core::parallel_for(pool, particles.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BondIndex row = i == 0 ? 0 : next[i - 1];
      const auto at = [&](BondIndex bond) {
        return network.second.begin() + static_cast<std::ptrdiff_t>(bond);
      };
      std::sort(at(row), at(next[i]));
      for (BondIndex bond = row; bond < next[i]; ++bond) {
        network.first[bond] = static_cast<ParticleIndex>(i);
        network.branch[bond] =
            box.minimum_image(particles.position[network.second[bond]] - particles.position[i]);
      }
    }
  });
  return network;
}

} // namespace detail

/// Bonds between particles that are close enough.
///
/// |x_j - x_i| <= R_i + R_j + eps D, compared as |x_j - x_i| - (R_i + R_j) <= eps D           [L17] eq. 1
/// @tparam Search    how neighbours are found; it does not change the result
/// @param particles  centres inside or outside the box; a periodic direction wraps them
/// @param box        bonds cross its periodic faces, through the nearest image; D is the side of a cube, the
///                   cube root of the volume of another box. Box::without_periodicity() gives a body cut out of a
///                   packing.
/// @param eps        dimensionless, finite; negative asks for overlap
/// @param pool       the network is the same to the last bit for any number of threads
/// @return           sorted by (first, second); empty if no pair is close enough
/// @throws           core::InvalidInput for particles or a box that are not valid, eps not finite, two bonded
///                   particles with one centre, or a periodic edge not above 2 (2 R_max + eps D)
/// @complexity       O(particles log particles + bonds); beside the result, 32 bytes a bond and about 120 a particle
template <NeighbourSearch Search = KdTree>
BondNetwork bonds_within(const particles::ParticleSet& particles, const geometry::Box& box, double eps,
                         core::ThreadPool& pool) {
  particles.validate();
  box.validate();
  core::expect_finite(eps, "eps");
  const double largest_gap = eps * characteristic_length(box);
  detail::expect_one_image(box, 2 * detail::largest_radius(particles) + largest_gap);
  const detail::SortedSearch<Search> search(particles, box);
  return detail::assemble(particles, box, search.pairs_within(largest_gap, pool), pool);
}

/// The same on the calling thread alone.
template <NeighbourSearch Search = KdTree>
BondNetwork bonds_within(const particles::ParticleSet& particles, const geometry::Box& box, double eps) {
  core::ThreadPool one_thread(1);
  return bonds_within<Search>(particles, box, eps, one_thread);
}

/// A network with the coordination number asked for, and the eps that makes it.
struct CoordinationResult {
  BondNetwork network;
  double eps = 0; ///< smallest eps of eq. 1 that makes every bond; negative if overlapping pairs suffice
  double coordination = 0; ///< 2 bonds / particles: what was asked for, to within one bond
  std::uint64_t ties = 0;  ///< pairs just as close as the last bond and left out (lattices); 0:
                           ///< bonds_within(eps) gives the same network
};

/// Bonds between the closest particles, as many as give the coordination number Z = 2 bonds / particles.
///
/// The k = round(Z particles / 2) pairs with the smallest surface gaps are bonded, equal gaps by (first,
/// second); eps = (k-th gap) / D                                                  [L17] section 2.1, Z = 6.2
/// @param coordination  Z, above 0
/// @param pool          the network is the same to the last bit for any number of threads
/// @throws              core::InvalidInput for particles or a box that are not valid, fewer than two
///                      particles, Z not finite, not above 0, below that of a single bond, or above what the particles or the
///                      periodic box allow (see bonds_within())
/// @complexity          O(particles log particles + bonds), as bonds_within(), once for each doubling of the
///                      gap above a twentieth of the mean diameter; a dense packing at Z = 6.2 needs none
template <NeighbourSearch Search = KdTree>
CoordinationResult bonds_at_coordination(const particles::ParticleSet& particles, const geometry::Box& box,
                                         double coordination, core::ThreadPool& pool) {
  particles.validate();
  box.validate();
  core::expect_positive(coordination, "coordination number Z");
  const auto count = static_cast<double>(particles.size());
  core::expect(particles.size() >= 2, "number of particles", particles.size(), "at least 2 are expected");
  core::expect(coordination <= count - 1, "coordination number Z", coordination,
               "at most " + core::to_text(count - 1) + " is possible among " +
                   core::to_text(particles.size()) + " particles");
  const auto wanted = static_cast<std::size_t>(std::round(coordination * count / 2));
  core::expect(wanted > 0, "coordination number Z", coordination,
               "at least " + core::to_text(1 / count) + " (rounded to one bond) is expected among " +
                   core::to_text(particles.size()) + " particles");

  const double largest_diameter = 2 * detail::largest_radius(particles);
  detail::expect_one_image(box, largest_diameter);
  const double gap_limit = detail::largest_single_image_distance(box) - largest_diameter;
  const detail::SortedSearch<Search> search(particles, box);
  std::vector<detail::Pair> pairs;
  for (double gap = 0.05 * 2 * particles.mean_radius();; gap *= 2) {
    gap = std::min(gap, gap_limit);
    pairs = search.pairs_within(gap, pool);
    if (pairs.size() >= wanted)
      break;
    core::expect(
        gap < gap_limit, "coordination number Z", coordination,
        "at most " + core::to_text(2 * static_cast<double>(pairs.size()) / count) +
            " is possible with no particle bonded to another through two images of the periodic box");
  }

  const auto last = pairs.begin() + static_cast<std::ptrdiff_t>(wanted - 1);
  std::nth_element(pairs.begin(), last, pairs.end(), detail::closer);
  const double side = characteristic_length(box);
  CoordinationResult result;
  result.eps = last->gap / side;
  while (result.eps * side < last->gap) // the division may have rounded down
    result.eps = std::nextafter(result.eps, std::numeric_limits<double>::infinity());
  result.ties = static_cast<std::uint64_t>(std::count_if(
      std::next(last), pairs.end(), [&](const detail::Pair& pair) { return pair.gap <= result.eps * side; }));
  pairs.erase(std::next(last), pairs.end());
  result.network = detail::assemble(particles, box, pairs, pool);
  result.coordination = result.network.coordination();
  return result;
}

/// The same on the calling thread alone.
template <NeighbourSearch Search = KdTree>
CoordinationResult bonds_at_coordination(const particles::ParticleSet& particles, const geometry::Box& box,
                                         double coordination) {
  core::ThreadPool one_thread(1);
  return bonds_at_coordination<Search>(particles, box, coordination, one_thread);
}

} // namespace cdem::network
