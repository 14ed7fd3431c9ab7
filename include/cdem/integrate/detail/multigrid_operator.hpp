#pragma once

/// @file
/// K x for a network of links, cut into blocks of nodes so that threads share nothing and sums never change.

#include <cdem/core/parallel.hpp>
#include <cdem/integrate/detail/multigrid_link.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <cstdint>
#include <vector>

namespace cdem::integrate::detail {

using Field = particles::SpatialField<float>;
using NodeIndex = std::uint32_t;

/// A node tied to the ground by a full stiffness.
struct GroundSpring {
  NodeIndex node;
  std::array<float, 37> stiffness; ///< 36 of the symmetric matrix, 1 that may be read
};

/// The links of a level, row by row, in blocks of consecutive nodes.
///
/// A link within a block is stored once, with its first node; one that leaves the block is stored with each of its two
/// ends. So a block owns all that its nodes need: it computes a link once, adds to both ends where both are its own,
/// and the result does not depend on which thread ran it. Links to held nodes end at node `size()`, which never moves.
template <class Link>
struct LinkedNodes {
  std::vector<NodeIndex> block_begin{0};      ///< [blocks + 1] first node of each block
  std::vector<std::uint64_t> row_begin{0};    ///< [nodes + 1] first link of each node
  std::vector<NodeIndex> other;               ///< [links] the link's other end
  std::vector<Link> link;                     ///< [links] branch from this node to the other
  std::vector<GroundSpring> ground;           ///< by node
  std::vector<std::uint32_t> ground_begin{0}; ///< [blocks + 1] first ground spring of each block

  NodeIndex size() const { return block_begin.back(); }
  std::size_t blocks() const { return block_begin.size() - 1; }
  std::size_t bytes() const {
    return row_begin.size() * sizeof(row_begin[0]) + other.size() * sizeof(NodeIndex) +
           link.size() * sizeof(Link) + ground.size() * sizeof(GroundSpring);
  }

  /// Calls body(begin, end, f) for every block of nodes [begin, end), where f(node) = -K x is the force and moment that
  /// the node's links exert on it. `body` may write to its nodes' entries of any field but x.
  template <class Body>
  void for_each_block(const Field& x, core::ThreadPool& pool, Body&& body) const {
    pool.for_each_block(blocks(), [&](std::size_t block) {
      const NodeIndex begin = block_begin[block], end = block_begin[block + 1];
      Field force(end - begin + std::size_t{1}); // the last one collects what leaves the block
      gather(block, x, force);
      body(block, begin, end, [&](NodeIndex node) { return Twist::load(force[node - begin].component); });
    });
  }

private:
  void gather(std::size_t block, const Field& x, Field& force) const {
    const NodeIndex begin = block_begin[block], count = block_begin[block + 1] - begin;
    for (NodeIndex row = 0; row < count; ++row) {
      const Twist here = Twist::load(x[begin + row].component);
      Twist sum = Twist::load(force[row].component);
      for (std::uint64_t e = row_begin[begin + row]; e < row_begin[begin + row + 1]; ++e) {
        __builtin_prefetch(x.data() + other[std::min<std::uint64_t>(e + 8, other.size() - 1)]);
        const Twist there = Twist::load(x[other[e]].component);
        const Float4 half_branch = link[e].half_branch();
        const Float4 rotations = here.angular + there.angular;
        const Float4 slip = there.linear - here.linear - cross(rotations, half_branch);
        const Float4 turn = there.angular - here.angular;
        const LinkPull pull = link[e].pull(slip, turn);
        const Float4 couple = cross(half_branch, pull.force);
        sum.linear += pull.force;
        sum.angular += pull.moment + couple;
        float* const reaction =
            force[std::min(other[e] - begin, count)].component; // below `begin` wraps to above
        Twist back = Twist::load(reaction);
        back.linear -= pull.force;
        back.angular += couple - pull.moment;
        back.store(reaction);
      }
      sum.store(force[row].component);
    }
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
