#pragma once

/// @file
/// How many bonds each particle has, and which particles hang together.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>
#include <cdem/network/bond_network.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace cdem::network {

/// Number of bonds of each particle.
///
/// @return      [particles]
/// @throws      core::InvalidInput for a network without particles or not valid
/// @complexity  O(particles + bonds)
inline std::vector<std::uint32_t> degrees(const BondNetwork& network) {
  core::expect(network.particle_count > 0, "number of particles", network.particle_count,
               "at least 1 is expected");
  network.validate();
  std::vector<std::uint32_t> degree(network.particle_count, 0);
  for (std::size_t bond = 0; bond < network.size(); ++bond) {
    ++degree[network.first[bond]];
    ++degree[network.second[bond]];
  }
  return degree;
}

/// How many particles have how many bonds.
struct DegreeHistogram {
  std::vector<std::uint64_t>
      particles; ///< [largest degree + 1] particles[d] have d bonds; their sum is all of them

  /// Mean number of bonds of a particle: the coordination number Z = 2 bonds / particles, [L17] section 2.1.
  double mean() const {
    double count = 0;
    double ends = 0;
    for (std::size_t degree = 0; degree < particles.size(); ++degree) {
      count += static_cast<double>(particles[degree]);
      ends += static_cast<double>(degree) * static_cast<double>(particles[degree]);
    }
    return count > 0 ? ends / count : 0;
  }

  /// Number of particles with fewer than `bonds` bonds; fewer_than(1) have none.
  std::uint64_t fewer_than(std::size_t bonds) const {
    const auto end = particles.begin() + static_cast<std::ptrdiff_t>(std::min(bonds, particles.size()));
    return std::accumulate(particles.begin(), end, std::uint64_t{0});
  }
};

/// Histogram of degrees().
/// @throws     core::InvalidInput for a network without particles or not valid
/// @complexity O(particles + bonds)
inline DegreeHistogram degree_histogram(const BondNetwork& network) {
  const std::vector<std::uint32_t> degree = degrees(network);
  DegreeHistogram histogram;
  histogram.particles.resize(std::size_t{*std::max_element(degree.begin(), degree.end())} + 1, 0);
  for (const std::uint32_t bonds : degree)
    ++histogram.particles[bonds];
  return histogram;
}

/// The parts into which a network falls: particles of one cluster are joined by a path of bonds, those of two are not.
struct Clusters {
  std::vector<ParticleIndex> of;        ///< [particles] number of the particle's cluster
  std::vector<std::uint64_t> particles; ///< [clusters] size of each; numbered by their lowest particle
  std::size_t largest = 0;              ///< number of the largest cluster, the first of equals

  /// Particles that are not in the largest cluster: nothing holds them, and no load reaches them through it.
  std::uint64_t outside_largest() const { return of.size() - particles.at(largest); }
};

/// Connected components of a network. A particle without bonds is a cluster of its own.
///
/// Union–find with path halving, the lower root kept: the numbering depends on the network alone.
/// @throws     core::InvalidInput for a network without particles or not valid
/// @complexity O(particles + bonds log particles) at worst, close to linear in practice
inline Clusters clusters(const BondNetwork& network) {
  core::expect(network.particle_count > 0, "number of particles", network.particle_count,
               "at least 1 is expected");
  network.validate();
  std::vector<ParticleIndex> parent(network.particle_count);
  std::iota(parent.begin(), parent.end(), ParticleIndex{0});
  const auto root = [&](ParticleIndex i) {
    while (parent[i] != i)
      i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t bond = 0; bond < network.size(); ++bond) {
    const auto [low, high] = std::minmax({root(network.first[bond]), root(network.second[bond])});
    parent[high] = low;
  }

  Clusters result;
  result.of.resize(network.particle_count);
  for (std::size_t index = 0; index < network.particle_count; ++index) {
    const auto i = static_cast<ParticleIndex>(index);
    const ParticleIndex top = root(i); // top <= i, so its cluster has its number already unless top is i
    if (top == i) {
      result.of[i] = static_cast<ParticleIndex>(result.particles.size());
      result.particles.push_back(0);
    } else {
      result.of[i] = result.of[top];
    }
    ++result.particles[result.of[i]];
  }
  result.largest = static_cast<std::size_t>(
      std::max_element(result.particles.begin(), result.particles.end()) - result.particles.begin());
  return result;
}

} // namespace cdem::network
