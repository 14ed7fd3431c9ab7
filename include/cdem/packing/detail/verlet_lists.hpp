#pragma once

/// @file
/// Lists of the spheres near each sphere, made for all at once and kept while none has moved far.

#include <cdem/core/parallel.hpp>
#include <cdem/packing/detail/near_search.hpp>
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
             double largest, core::ThreadPool& pool) {
    list_end_.resize(spheres.size());
    entries_.resize((spheres.size() + spheres_per_block - 1) / spheres_per_block);
    wraps_.resize(blocks());
    pool.for_each_block(blocks(), [&](std::size_t block) {
      NearCandidates candidates;
      std::vector<ParticleIndex>& entries = entries_[block];
      entries.clear();
      wraps_[block] = 0;
      for (std::size_t begin = first(block), end = begin; begin < last(block); begin = end) {
        // The spheres of one cell have the same candidates.
        const std::array<int, 3> place = cells.place_of(spheres[begin]);
        double size = 0;
        for (; end < last(block) && cells.place_of(spheres[end]) == place; ++end)
          size = std::max(size, spheres[end][3]);
        const double reach = (size + largest) * scale + skin;
        candidates.clear();
        cells.visit_around(place, reach, [&](ParticleIndex from, ParticleIndex to) {
          candidates.add(spheres.data(), from, to);
        });
        const NearRule rule{scale, skin, cells.wraps_around(place, reach)};
        wraps_[block] |= rule.wraps ? 1 : 0;
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t near = candidates.find_near(spheres[i], static_cast<ParticleIndex>(i), rule);
          entries.insert(entries.end(), candidates.found(), candidates.found() + near);
          list_end_[i] = static_cast<std::uint32_t>(entries.size());
        }
      }
      entries.resize(entries.size() + SoftBlock::read_ahead, static_cast<ParticleIndex>(first(block)));
    });
  }

  /// The block as the force kernel wants it.
  SoftBlock block(std::size_t block, const std::vector<Quad>& spheres, double scale, bool walls) const {
    return {spheres.data(),
            entries_[block].data(),
            list_end_.data() + first(block),
            static_cast<ParticleIndex>(first(block)),
            static_cast<ParticleIndex>(last(block)),
            scale,
            wraps_[block] != 0,
            walls};
  }

  /// The list of a sphere, which may be filled up with the sphere itself.
  std::span<const ParticleIndex> of(std::size_t sphere) const {
    const std::size_t block = sphere / spheres_per_block;
    const std::uint32_t begin = sphere == first(block) ? 0 : list_end_[sphere - 1];
    return {entries_[block].data() + begin, list_end_[sphere] - begin};
  }

private:
  std::size_t first(std::size_t block) const { return block * spheres_per_block; }
  std::size_t last(std::size_t block) const {
    return std::min((block + 1) * spheres_per_block, list_end_.size());
  }

  std::vector<std::vector<ParticleIndex>> entries_; ///< [blocks]
  std::vector<char> wraps_;             ///< [blocks] whether pairs were searched for through a periodic face
  std::vector<std::uint32_t> list_end_; ///< [spheres] end of the list in its block's entries
};

} // namespace cdem::packing::detail
