#pragma once

/// @file
/// Who is bonded with whom, block of particles by block: the order in which the forces of bonds are summed.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/core/types.hpp>
#include <cdem/network/bond_network.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace cdem::bond::detail {

/// The ends of all bonds, and the bonds of each particle.
///
/// A bond belongs to its first particle. One that joins two blocks is computed in both, each block summing what falls on
/// its own particles: no block waits for another, and sums do not depend on threads.
class BondEnds {
public:
  /// Particles of a block.
  static constexpr std::size_t block_size = 2048;

  /// @throws core::InvalidInput for bonds that are not sorted as BondNetwork says
  /// @complexity O(bonds + particles); 16 bytes a bond and 16 a particle
  explicit BondEnds(const network::BondNetwork& network)
      : first_(network.first), second_(network.second), own_begin_(network.particle_count + 1),
        incoming_begin_(network.particle_count + 1), incoming_(network.size()) {
    for (BondIndex b = 0; b < first_.size(); ++b) {
      if (first_[b] >= second_[b] || (b > 0 && first_[b - 1] > first_[b]))
        core::reject("first particle of bond " + std::to_string(b), first_[b],
                     "bonds sorted by their first particle, which has the lower number, are expected");
      ++own_begin_[first_[b] + std::size_t{1}];
      ++incoming_begin_[second_[b] + std::size_t{1}];
    }
    for (std::size_t i = 1; i < own_begin_.size(); ++i) {
      own_begin_[i] += own_begin_[i - 1];
      incoming_begin_[i] += incoming_begin_[i - 1];
    }
    std::vector<BondIndex> place(incoming_begin_.begin(), incoming_begin_.end() - 1);
    for (BondIndex b = 0; b < first_.size(); ++b)
      incoming_[place[second_[b]]++] = b;
    entering_begin_.push_back(0);
    for (std::size_t block = 0; block < block_count(); ++block) {
      for (BondIndex k = incoming_begin_[block_begin(block)]; k < incoming_begin_[block_end(block)]; ++k)
        if (first_[incoming_[k]] < block_begin(block))
          entering_.push_back(incoming_[k]);
      entering_begin_.push_back(entering_.size());
    }
  }

  std::size_t particle_count() const noexcept { return own_begin_.size() - 1; }
  std::size_t bond_count() const noexcept { return first_.size(); }
  ParticleIndex first(BondIndex b) const { return first_[b]; }
  ParticleIndex second(BondIndex b) const { return second_[b]; }

  std::size_t block_count() const noexcept { return (particle_count() + block_size - 1) / block_size; }
  std::size_t block_begin(std::size_t block) const noexcept { return block * block_size; }
  std::size_t block_end(std::size_t block) const noexcept {
    return std::min(particle_count(), (block + 1) * block_size);
  }
  /// First bond of particle `i` as first particle; up to that of i + 1.
  BondIndex own_begin(std::size_t i) const { return own_begin_[i]; }

  /// The bonds that enter a block's particles from a block before it.
  std::span<const BondIndex> entering(std::size_t block) const {
    return {entering_.data() + entering_begin_[block], entering_.data() + entering_begin_[block + 1]};
  }
  /// Calls use(bond) for each bond of particle `i`, those it is second in first.
  template <class Use>
  void for_each_of(ParticleIndex i, Use&& use) const {
    for (BondIndex k = incoming_begin_[i]; k < incoming_begin_[i + std::size_t{1}]; ++k)
      use(incoming_[k]);
    for (BondIndex b = own_begin_[i]; b < own_begin_[i + std::size_t{1}]; ++b)
      use(b);
  }

  /// Bytes held.
  std::size_t memory() const noexcept {
    return (first_.size() + second_.size()) * sizeof(ParticleIndex) +
           (own_begin_.size() + incoming_begin_.size() + incoming_.size() + entering_.size()) *
               sizeof(BondIndex);
  }

private:
  std::vector<ParticleIndex> first_, second_; ///< [bonds]
  std::vector<BondIndex> own_begin_;          ///< [particles + 1]
  std::vector<BondIndex> incoming_begin_;     ///< [particles + 1] into incoming_
  std::vector<BondIndex> incoming_;           ///< [bonds] by second particle
  std::vector<BondIndex> entering_;           ///< by block of the second particle, from blocks before
  std::vector<std::size_t> entering_begin_;   ///< [blocks + 1]
};

} // namespace cdem::bond::detail
