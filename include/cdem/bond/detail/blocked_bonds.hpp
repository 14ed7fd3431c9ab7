#pragma once

/// @file
/// The bonds of a body cut into blocks of consecutive particles, and where each bond is kept.

#include <cdem/bond/detail/bond_group.hpp>
#include <cdem/bond/detail/bond_kernel.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

namespace cdem::bond {

/// The bonds of one particle in increasing order, a range of BondIndex: those it is the second end of (a list), then
/// those it is the first end of (consecutive).
class BondsOfParticle {
public:
  class Iterator {
  public:
    using value_type = BondIndex;
    using difference_type = std::ptrdiff_t;
    using iterator_category = std::forward_iterator_tag;
    using pointer = const BondIndex*;
    using reference = BondIndex;

    Iterator() = default;
    BondIndex operator*() const {
      if (listed_ == listed_end_)
        return own_;
      return *listed_ < own_count_ ? block_begin_ + *listed_ : incoming_[*listed_ - own_count_];
    }
    Iterator& operator++() {
      if (listed_ != listed_end_)
        ++listed_;
      else
        ++own_;
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    bool operator==(const Iterator& other) const { return listed_ == other.listed_ && own_ == other.own_; }

  private:
    friend BondsOfParticle;
    const std::uint32_t* listed_ = nullptr;
    const std::uint32_t* listed_end_ = nullptr;
    BondIndex own_ = 0;
    BondIndex block_begin_ = 0;
    const BondIndex* incoming_ = nullptr;
    std::uint32_t own_count_ = 0;
  };

  /// @param listed     places in the particle's block: below `own_count` a bond of the block, others come from outside
  /// @param own_begin  bonds whose first end is the particle: [own_begin, own_end)
  /// @param incoming   bond numbers of the places from `own_count` on
  BondsOfParticle(std::span<const std::uint32_t> listed, BondIndex own_begin, BondIndex own_end,
                  BondIndex block_begin, std::uint32_t own_count, const BondIndex* incoming)
      : size_(listed.size() + (own_end - own_begin)) {
    begin_.listed_ = listed.data();
    begin_.listed_end_ = listed.data() + listed.size();
    begin_.own_ = own_begin;
    begin_.block_begin_ = block_begin;
    begin_.incoming_ = incoming;
    begin_.own_count_ = own_count;
    end_ = begin_;
    end_.listed_ = begin_.listed_end_;
    end_.own_ = own_end;
  }

  Iterator begin() const { return begin_; }
  Iterator end() const { return end_; }
  /// Number of bonds.
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

private:
  Iterator begin_, end_;
  std::size_t size_;
};

namespace detail {

/// Bonds in groups of four, block by block.
///
/// Block k of `block_size` particles keeps first the bonds whose first end is in it, in their order, then copies of
/// those that come into it from a lower block, turned around (12 % at Z = 6.2 in space-filling order); the last group is
/// filled up with bonds that do nothing. The place of a bond is its number among these.
template <class StiffnessReal>
class BlockedBonds {
public:
  using Group = BondGroup<StiffnessReal>;

  /// Particles of one block: their forces (64 bytes each) stay in the cache next to a core.
  static constexpr std::size_t block_size = 3072;

  /// @param bond    BondRecord(BondIndex); asked once for every bond, in order
  /// @param first,second  [bonds] sorted by first end, which is the lower number
  template <class Bond>
  BlockedBonds(std::size_t particles, std::span<const ParticleIndex> first,
               std::span<const ParticleIndex> second, Bond&& bond)
      : particles_(particles), bonds_(first.size()) {
    count(first, second);
    std::vector<std::uint32_t> next_incoming(block_count(), 0);
    for (BondIndex b = 0; b < bonds_; ++b) {
      const BondRecord record = bond(b);
      const std::size_t home = first[b] / block_size, away = second[b] / block_size;
      put(home, static_cast<std::uint32_t>(b - blocks_[home].bonds_begin), record);
      if (home != away) {
        incoming_[blocks_[away].incoming_begin + next_incoming[away]] = b;
        put(away, own_count(away) + next_incoming[away]++, record.turned());
      }
    }
    for (std::size_t number = 0; number < block_count(); ++number)
      fill_up(number);
    list_seconds(second);
    note_homes();
  }

  std::size_t particle_count() const noexcept { return particles_; }
  std::size_t bond_count() const noexcept { return bonds_; }
  std::size_t block_count() const noexcept { return (particles_ + block_size - 1) / block_size; }

  BondBlock<StiffnessReal> block(std::size_t number) const {
    const std::size_t begin = number * block_size;
    return {groups_.data() + blocks_[number].groups_begin,
            blocks_[number + 1].groups_begin - blocks_[number].groups_begin,
            static_cast<ParticleIndex>(begin),
            static_cast<ParticleIndex>(std::min(block_size, particles_ - begin))};
  }

  BondRecord bond(BondIndex b) const {
    std::size_t home = home_[b >> home_shift];
    while (b >= blocks_[home + 1].bonds_begin)
      ++home;
    const BondIndex place = b - blocks_[home].bonds_begin;
    return groups_[blocks_[home].groups_begin + place / Group::lanes].get(place % Group::lanes);
  }

  BondsOfParticle bonds_of(ParticleIndex i) const {
    const std::size_t home = i / block_size, at = i + home;
    const Block& block = blocks_[home];
    const std::uint32_t* const listed = listed_.data() + block.listed_begin;
    return {{listed + listed_begin_[at], listed + listed_begin_[at + 1]},
            block.bonds_begin + own_begin_[at],
            block.bonds_begin + own_begin_[at + 1],
            block.bonds_begin,
            own_count(home),
            incoming_.data() + block.incoming_begin};
  }

  std::size_t memory() const noexcept {
    const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return bytes(groups_) + bytes(blocks_) + bytes(own_begin_) + bytes(listed_begin_) + bytes(listed_) +
           bytes(incoming_) + bytes(home_);
  }

private:
  /// Where a block's bonds, groups, incoming bonds and bonds by second end begin.
  struct Block {
    BondIndex bonds_begin = 0;
    std::size_t groups_begin = 0;
    std::size_t incoming_begin = 0;
    BondIndex listed_begin = 0;
  };
  static constexpr int home_shift = 12;

  std::uint32_t own_count(std::size_t number) const {
    return static_cast<std::uint32_t>(blocks_[number + 1].bonds_begin - blocks_[number].bonds_begin);
  }
  std::size_t incoming_count(std::size_t number) const {
    return blocks_[number + 1].incoming_begin - blocks_[number].incoming_begin;
  }

  void count(std::span<const ParticleIndex> first, std::span<const ParticleIndex> second) {
    blocks_.resize(block_count() + 1);
    own_begin_.assign(particles_ + block_count(), 0);
    listed_begin_.assign(particles_ + block_count(), 0);
    for (BondIndex b = 0; b < bonds_; ++b) {
      const std::size_t home = first[b] / block_size, away = second[b] / block_size;
      ++blocks_[home + 1].bonds_begin;
      ++blocks_[away + 1].listed_begin;
      blocks_[away + 1].incoming_begin += home != away ? 1 : 0;
      ++own_begin_[first[b] + home + 1];
      ++listed_begin_[second[b] + away + 1];
    }
    for (std::size_t number = 0; number < block_count(); ++number) {
      Block &here = blocks_[number], &next = blocks_[number + 1];
      const std::size_t groups = (next.bonds_begin + next.incoming_begin + Group::lanes - 1) / Group::lanes;
      next.groups_begin = here.groups_begin + groups;
      next.bonds_begin += here.bonds_begin;
      next.incoming_begin += here.incoming_begin;
      next.listed_begin += here.listed_begin;
      const std::size_t begin = number * block_size, end = std::min(begin + block_size, particles_);
      for (std::size_t at = begin + number; at < end + number; ++at) {
        own_begin_[at + 1] += own_begin_[at];
        listed_begin_[at + 1] += listed_begin_[at];
      }
    }
    groups_.resize(blocks_.back().groups_begin + ends_ahead);
    incoming_.resize(blocks_.back().incoming_begin);
  }

  void put(std::size_t number, std::uint32_t place, const BondRecord& bond) {
    groups_[blocks_[number].groups_begin + place / Group::lanes].set(place % Group::lanes, bond);
  }

  /// Bonds of a particle with itself, without stiffness.
  void fill_up(std::size_t number) {
    const auto idle = static_cast<ParticleIndex>(number * block_size);
    const std::size_t groups = blocks_[number + 1].groups_begin - blocks_[number].groups_begin;
    for (std::size_t place = own_count(number) + incoming_count(number); place < groups * Group::lanes;
         ++place)
      put(number, static_cast<std::uint32_t>(place), {Vec3::Zero(), 0, 0, 0, 0, idle, idle});
  }

  /// By second end: those that come into its block, then those of the block. So the bonds of a particle increase.
  void list_seconds(std::span<const ParticleIndex> second) {
    listed_.resize(bonds_);
    std::vector<std::uint32_t> next = listed_begin_;
    for (std::size_t number = 0; number < block_count(); ++number) {
      const Block& block = blocks_[number];
      const auto list = [&](BondIndex b, std::size_t place) {
        listed_[block.listed_begin + next[second[b] + number]++] = static_cast<std::uint32_t>(place);
      };
      for (std::size_t k = 0; k < incoming_count(number); ++k)
        list(incoming_[block.incoming_begin + k], own_count(number) + k);
      for (std::size_t place = 0; place < own_count(number); ++place)
        if (second[block.bonds_begin + place] / block_size == number)
          list(block.bonds_begin + place, place);
    }
  }

  void note_homes() {
    home_.resize((bonds_ >> home_shift) + 1);
    std::size_t home = 0;
    for (std::size_t k = 0; k < home_.size(); ++k) {
      while (home + 1 < block_count() && (BondIndex{k} << home_shift) >= blocks_[home + 1].bonds_begin)
        ++home;
      home_[k] = static_cast<std::uint32_t>(home);
    }
  }

  std::size_t particles_, bonds_;
  std::vector<Group, particles::CacheAlignedAllocator<Group>> groups_;
  std::vector<Block> blocks_; ///< [blocks + 1]
  /// [particles + blocks] where each particle's bonds as first end begin among those of its block; after the last
  /// particle of a block comes their end. Likewise where it is the second end, in the block's part of `listed_`.
  std::vector<std::uint32_t> own_begin_, listed_begin_;
  std::vector<std::uint32_t> listed_; ///< [bonds] place in the second end's block, by second end
  std::vector<BondIndex> incoming_;   ///< numbers of the bonds that are copies, by block
  std::vector<std::uint32_t> home_;   ///< block of every 4096th bond
};

} // namespace detail
} // namespace cdem::bond
