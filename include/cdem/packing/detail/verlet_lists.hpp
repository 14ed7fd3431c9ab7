#pragma once

/// @file
/// Lists of the spheres near each sphere, made for all at once and kept while none has moved far.

#include <cdem/core/parallel.hpp>
#include <cdem/packing/detail/cell_grid.hpp>
#include <cdem/packing/detail/quad.hpp>
#include <cdem/packing/detail/soft_kernel.hpp>
#include <cdem/packing/detail/sorted_cells.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cdem::packing::detail {

/// Lists of neighbours of blocks of consecutive spheres. Each pair stands in both lists.
/// @complexity  a list of n entries takes 4 n bytes, up to twice that while blocks grow
class VerletLists {
public:
  static constexpr std::size_t spheres_per_block = 1024;

  std::size_t blocks() const noexcept { return entries_.size(); }

  /// Makes all the lists: the pairs whose surfaces are closer than `skin`.
  /// @param spheres  in the order of `cells`
  /// @param largest  no sphere's size is larger
  void build(const std::vector<Quad>& spheres, const SortedCells& cells, double scale, double skin,
             double largest, bool periodic, core::ThreadPool& pool) {
    list_end_.resize(spheres.size());
    entries_.resize((spheres.size() + spheres_per_block - 1) / spheres_per_block);
    pool.for_each_block(blocks(), [&](std::size_t block) {
      Candidates candidates;
      entries_[block].clear();
      for (std::size_t begin = first(block), end = begin; begin < last(block); begin = end) {
        // The spheres of one cell have the same candidates.
        const std::array<int, 3> place = cells.place_of(spheres[begin]);
        double size = 0;
        for (; end < last(block) && cells.place_of(spheres[end]) == place; ++end)
          size = std::max(size, spheres[end][3]);
        candidates.clear();
        cells.visit_around(place, (size + largest) * scale + skin,
                           [&](ParticleIndex from, ParticleIndex to) { candidates.add(spheres, from, to); });
        for (std::size_t i = begin; i < end; ++i) {
          candidates.append_near(spheres[i], static_cast<ParticleIndex>(i), scale, skin, periodic,
                                 entries_[block]);
          list_end_[i] = static_cast<std::uint32_t>(entries_[block].size());
        }
      }
    });
  }

  /// The block as the force kernel wants it.
  SoftBlock block(std::size_t block, const std::vector<Quad>& spheres, double scale, bool periodic) const {
    return {spheres.data(),
            entries_[block].data(),
            list_end_.data() + first(block),
            static_cast<ParticleIndex>(first(block)),
            static_cast<ParticleIndex>(last(block)),
            scale,
            periodic};
  }

  /// The list of a sphere, which may be filled up with the sphere itself.
  std::span<const ParticleIndex> of(std::size_t sphere) const {
    const std::size_t block = sphere / spheres_per_block;
    const std::uint32_t begin = sphere == first(block) ? 0 : list_end_[sphere - 1];
    return {entries_[block].data() + begin, list_end_[sphere] - begin};
  }

private:
  /// Spheres of some cells, four to a register.
  class Candidates {
  public:
    void clear() { count_ = 0; }
    void add(const std::vector<Quad>& spheres, ParticleIndex begin, ParticleIndex end) {
      make_room(count_ + (end - begin));
      for (ParticleIndex j = begin; j < end; ++j, ++count_) {
        for (std::size_t k = 0; k < 4; ++k)
          values_[k][count_] = spheres[j].component[k];
        spheres_[count_] = j;
      }
    }
    /// To a multiple of four, with the sphere itself.
    void fill_up(const Quad& own, ParticleIndex i) {
      make_room(count_ + 3);
      for (std::size_t c = count_; c % 4 != 0; ++c) {
        for (std::size_t k = 0; k < 4; ++k)
          values_[k][c] = own.component[k];
        spheres_[c] = i;
      }
    }
    /// Appends those whose surface is closer than `skin` to that of sphere `i`, then `i` itself up to a multiple of
    /// four.
    void append_near(const Quad& own, ParticleIndex i, double scale, double skin, bool periodic,
                     std::vector<ParticleIndex>& entries) {
      constexpr double round = 0x1.8p52; // adding it leaves no bits for the fraction
      fill_up(own, i);
      const double x = own[0], y = own[1], z = own[2], own_size = own[3];
      std::size_t found = 0;
      for (std::size_t c = 0; c < count_; c += 4) {
        Lanes dx, dy, dz, size;
        __builtin_memcpy(&dx, &values_[0][c], sizeof dx);
        __builtin_memcpy(&dy, &values_[1][c], sizeof dy);
        __builtin_memcpy(&dz, &values_[2][c], sizeof dz);
        __builtin_memcpy(&size, &values_[3][c], sizeof size);
        dx -= x;
        dy -= y;
        dz -= z;
        if (periodic) {
          dx -= (dx + round) - round;
          dy -= (dy + round) - round;
          dz -= (dz + round) - round;
        }
        const Lanes reach = (size + own_size) * scale + skin;
        const auto near = dx * dx + dy * dy + dz * dz < reach * reach;
        for (int lane = 0; lane < 4; ++lane) {
          const ParticleIndex j = spheres_[c + static_cast<std::size_t>(lane)];
          found_[found] = j;
          found += static_cast<std::size_t>(-near[lane]) & static_cast<std::size_t>(j != i);
        }
      }
      while (found % 4 != 0)
        found_[found++] = i; // acts on itself with no force
      entries.insert(entries.end(), found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(found));
    }

  private:
    void make_room(std::size_t count) {
      if (count + 4 < spheres_.size())
        return;
      for (auto& values : values_)
        values.resize(2 * count + 64);
      spheres_.resize(2 * count + 64);
      found_.resize(2 * count + 64);
    }

    std::size_t count_ = 0;
    std::array<std::vector<double>, 4> values_; ///< x, y, z, size
    std::vector<ParticleIndex> spheres_, found_;
  };

  std::size_t first(std::size_t block) const { return block * spheres_per_block; }
  std::size_t last(std::size_t block) const {
    return std::min((block + 1) * spheres_per_block, list_end_.size());
  }

  std::vector<std::vector<ParticleIndex>> entries_; ///< [blocks]
  std::vector<std::uint32_t> list_end_;             ///< [spheres] end of the list in its block's entries
};

} // namespace cdem::packing::detail
