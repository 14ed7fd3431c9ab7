#pragma once

/// @file
/// K x for a network of links, cut into blocks of nodes so that threads share nothing and sums never change.

#include <cdem/core/parallel.hpp>
#include <cdem/integrate/detail/multigrid_lanes.hpp>
#include <cdem/integrate/detail/multigrid_link.hpp>
#include <cdem/integrate/detail/multigrid_memory.hpp>

#include <cstdint>
#include <vector>

namespace cdem::integrate::detail {

using NodeIndex = std::uint32_t;

/// Lines of a field that the loops over eight nodes may read beyond a block's or level's last.
inline constexpr std::size_t spare_lines = 8;

/// A node tied to the ground by a full stiffness.
struct GroundSpring {
  NodeIndex node;
  std::array<float, 37> stiffness; ///< 36 of the symmetric matrix, 1 that may be read
};

inline float* lines(Field& field) {
  return field.data()->component;
}
inline const float* lines(const Field& field) {
  return field.data()->component;
}

/// The links of a level, eight by eight, in blocks of consecutive nodes.
///
/// A link within a block is stored once; one that leaves the block is stored with each of its two ends. So a block
/// owns all that its nodes need: it computes a link once, adds to both ends where both are its own, and the result
/// does not depend on which thread ran it. Links to held nodes end at node `size()`, which never moves. Where a block's
/// links do not fill the last eight, links without stiffness do.
template <class Links>
struct LinkedNodes {
  std::vector<NodeIndex> block_begin{0};      ///< [blocks + 1] first node of each block
  LevelArray<Links> links;                    ///< in eights
  std::vector<std::uint64_t> links_begin{0};  ///< [blocks + 1] first eight of each block
  std::vector<std::uint64_t> leaving;         ///< [blocks] first eight whose links leave the block
  std::vector<GroundSpring> ground;           ///< by node
  std::vector<std::uint32_t> ground_begin{0}; ///< [blocks + 1] first ground spring of each block

  NodeIndex size() const { return block_begin.back(); }
  std::size_t blocks() const { return block_begin.size() - 1; }
  std::size_t bytes() const { return links.size() * sizeof(Links) + ground.size() * sizeof(GroundSpring); }

  /// Calls body(block, begin, end, force) for every block of nodes [begin, end), where force = -K x holds the forces
  /// and moments that their links exert on them, from `begin` on. `body` may write to its nodes' entries of any
  /// field but x.
  template <class Body>
  void for_each_block(const Field& x, core::ThreadPool& pool, Body&& body) const {
    pool.for_each_block(blocks(), [&](std::size_t block) {
      const NodeIndex begin = block_begin[block], end = block_begin[block + 1];
      Field force(end - begin +
                  spare_lines); // the first spare one collects what links without stiffness exert
      gather(block, x, force);
      body(block, begin, end, static_cast<const Field&>(force));
    });
  }

private:
  void gather(std::size_t block, const Field& x, Field& force) const {
    const NodeIndex begin = block_begin[block];
    const LinkBlock<Links> own{links.data() + links_begin[block], links.data() + leaving[block],
                               links.data() + links_begin[block + 1]};
    with_loops([&](auto loops) { loops.act(own, lines(x), x[begin].component, lines(force)); });
    for (std::uint32_t g = ground_begin[block]; g < ground_begin[block + 1]; ++g) {
      const Twist here = Twist::load(x[ground[g].node].component);
      float* const place = force[ground[g].node - begin].component;
      Twist sum = Twist::load(place);
      sum -= multiply(ground[g].stiffness.data(), here.linear, here.angular);
      sum.store(place);
    }
  }
};

} // namespace cdem::integrate::detail
