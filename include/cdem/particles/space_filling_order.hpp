#pragma once

/// @file
/// An order of the particles in which those close in space are close in memory.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/particles/particle_set.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace cdem::particles {

namespace detail {

inline constexpr int hilbert_bits = 16; ///< per axis: 65,536 cells along the longest edge

/// Position along the Hilbert curve of the cell with these coordinates, each below 2^hilbert_bits.
///
/// J. Skilling, Programming the Hilbert curve, AIP Conference Proceedings 707 (2004) 381.
inline std::uint64_t hilbert_key(std::array<std::uint32_t, 3> cell) {
  constexpr std::uint32_t highest = std::uint32_t{1} << (hilbert_bits - 1);
  // From the finest orientation back to the coarsest: undo the exchanges and reflections of each octant.
  for (std::uint32_t bit = highest; bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (std::uint32_t& coordinate : cell) {
      if (coordinate & bit) {
        cell[0] ^= below;
      } else {
        const std::uint32_t exchange = (cell[0] ^ coordinate) & below;
        cell[0] ^= exchange;
        coordinate ^= exchange;
      }
    }
  }
  // Gray code over the three axes.
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  std::uint32_t flip = 0;
  for (std::uint32_t bit = highest; bit > 1; bit >>= 1)
    if (cell[2] & bit)
      flip ^= bit - 1;
  // Three bits a level, the coarsest first.
  std::uint64_t key = 0;
  for (int bit = hilbert_bits - 1; bit >= 0; --bit)
    for (const std::uint32_t coordinate : cell)
      key = (key << 1) | (((coordinate ^ flip) >> bit) & 1u);
  return key;
}

/// Cell of a cubic grid of 2^hilbert_bits cells along the box's longest edge; points outside count as on the face.
inline std::array<std::uint32_t, 3> hilbert_cell(const Vec3& point, const geometry::Box& box) {
  constexpr double cells = std::uint32_t{1} << hilbert_bits;
  const Vec3 scaled = (box.wrap(point) - box.lower) * (cells / box.size().maxCoeff());
  std::array<std::uint32_t, 3> cell{};
  for (std::size_t k = 0; k < 3; ++k)
    cell[k] = static_cast<std::uint32_t>(std::clamp(scaled[static_cast<Eigen::Index>(k)], 0.0, cells - 1));
  return cell;
}

} // namespace detail

/// Numbers of the particles along a Hilbert curve through the box.
///
/// The Hilbert curve rather than Morton's, which jumps: see docs/network.md for the locality of bonds measured.
/// @param box  a periodic direction wraps the particles; its longest edge holds 65,536 cells of the curve
/// @return     [particles] permutation: the new particle i is the old particle permutation[i]; particles of one cell
///             keep their order
/// @throws     core::InvalidInput for particles or a box that are not valid
/// @complexity O(particles log particles), 16 bytes a particle beside the result
inline std::vector<ParticleIndex> space_filling_order(const ParticleSet& particles,
                                                      const geometry::Box& box) {
  particles.validate();
  box.validate();
  core::expect(particles.size() <= std::numeric_limits<ParticleIndex>::max(), "number of particles",
               particles.size(), "at most 2^32 - 1 is expected");
  std::vector<std::pair<std::uint64_t, ParticleIndex>> keys(particles.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    keys[i] = {detail::hilbert_key(detail::hilbert_cell(particles.position[i], box)),
               static_cast<ParticleIndex>(i)};
  std::sort(keys.begin(), keys.end());
  std::vector<ParticleIndex> permutation(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    permutation[i] = keys[i].second;
  return permutation;
}

/// The particles in the order of `permutation`: the new particle i is the old particle permutation[i].
///
/// Do it before the network is made: bonds hold particle numbers.
/// @throws core::InvalidInput if the permutation does not name each particle exactly once
inline ParticleSet reorder(const ParticleSet& particles, const std::vector<ParticleIndex>& permutation) {
  particles.validate();
  core::expect(permutation.size() == particles.size(), "length of the permutation", permutation.size(),
               "one number per particle (" + std::to_string(particles.size()) + ") is expected");
  std::vector<bool> seen(particles.size(), false);
  ParticleSet reordered;
  reordered.resize(particles.size());
  for (std::size_t i = 0; i < permutation.size(); ++i) {
    const ParticleIndex old = permutation[i];
    if (old >= particles.size() || seen[old])
      core::reject("permutation[" + std::to_string(i) + "]", old,
                   "each number below " + std::to_string(particles.size()) + " is expected exactly once");
    seen[old] = true;
    reordered.position[i] = particles.position[old];
    reordered.radius[i] = particles.radius[old];
    reordered.phase[i] = particles.phase[old];
  }
  return reordered;
}

} // namespace cdem::particles
