#pragma once

/// @file
/// Small connected groups of nodes, the coarse unknowns of the static multigrid.

#include <cdem/core/parallel.hpp>
#include <cdem/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace cdem::integrate::detail {

/// No group, no node: what is held moves with the ground.
inline constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Which group each node belongs to, and where it stands in it.
struct Groups {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> group_of; ///< [nodes], none for a held node
  std::vector<Vec3> arm;               ///< [nodes] from the centre of its group
};

/// Grows groups one after the other over the network.
///
/// A group starts at the first free node and takes in, until it has `size` nodes, the free neighbour the largest part of
/// whose stiffness ties it to the group; a neighbour tied by less than `weakest_tie` of it is left out. So groups are
/// connected, compact, and do not cross an interface that is much softer than what it joins. A group that
/// could not grow to half its size joins the one it is tied to best.
///
/// First of all come the nodes that hang loosely, see group_hanging().
///
/// It sees one range of the nodes, from `begin` to `end`, and takes the links that leave it for none: see grow_groups().
///
/// @tparam Graph  size(), is_held(node), for_each_link(node, visit(link, neighbour, branch)), weight(link)
/// @complexity    O(links); the order of the nodes alone decides the outcome
template <class Graph>
class GroupGrower {
public:
  /// @param groups   [nodes] of the range: arms are written, group numbers from 0 on; those of other nodes stay as they are
  /// @param hanging  the most links of a node that hangs; 0 for no such nodes
  GroupGrower(const Graph& graph, Groups& groups, std::uint32_t begin, std::uint32_t end, std::uint32_t size,
              double weakest_tie, std::uint32_t hanging)
      : graph_(graph), groups_(groups), begin_(begin), end_(end), size_(size), weakest_tie_(weakest_tie),
        hanging_(hanging), total_weight_(end - begin, 0) {
    for (std::uint32_t node = begin; node < end; ++node)
      graph.for_each_link(node, [&](auto link, std::uint32_t, const auto&) {
        total_weight_[node - begin] += graph.weight(link);
      });
  }

  /// Returns the number of groups.
  std::uint32_t grow() {
    if (hanging_ > 0)
      group_hanging();
    for (std::uint32_t seed = begin_; seed < end_; ++seed) {
      if (graph_.is_held(seed) || groups_.group_of[seed] != none)
        continue;
      grow_from(seed);
      if (members_.size() >= std::max<std::size_t>(2, size_ / 2) || !join_best_neighbour())
        ++count_;
    }
    centre_arms();
    return count_;
  }

private:
  struct Candidate {
    std::uint32_t node;
    double tie; ///< weight of its links to the group
    Vec3 position;
  };

  /// Makes groups of the nodes that hang: those of trees, that one link after the other ties to the rest, and those
  /// with no more than `hanging_` links outside such trees.
  ///
  /// Two or more of them that follow each other bend about the links that end them like a chain about its hinges. Where
  /// bending is soft, that is far softer than what a smoother of single nodes sees, and a rigid group that holds
  /// them together with what they hang from does not have the motion. As groups of their own they do.
  void group_hanging() {
    std::vector<std::uint32_t> ties(end_ - begin_, 0), leaves;
    std::vector<bool> hangs(end_ - begin_, false);
    for (std::uint32_t node = begin_; node < end_; ++node) {
      graph_.for_each_link(node, [&](auto link, std::uint32_t, const auto&) {
        ties[node - begin_] += ties_to(node, link) ? 1U : 0U;
      });
      if (ties[node - begin_] == 1 && !graph_.is_held(node))
        leaves.push_back(node);
    }
    while (!leaves.empty()) {
      const std::uint32_t leaf = leaves.back();
      leaves.pop_back();
      hangs[leaf - begin_] = true;
      graph_.for_each_link(leaf, [&](auto link, std::uint32_t other, const auto&) {
        if (here(other) && !hangs[other - begin_] && ties_to(other, link) && --ties[other - begin_] == 1)
          leaves.push_back(other);
      });
    }
    for (std::uint32_t node = begin_; node < end_; ++node)
      hangs[node - begin_] =
          !graph_.is_held(node) && ties[node - begin_] > 0 && ties[node - begin_] <= hanging_;
    for (std::uint32_t seed = begin_; seed < end_; ++seed) {
      if (!hangs[seed - begin_])
        continue;
      members_.clear();
      const auto take = [&](std::uint32_t node, const Vec3& position) {
        hangs[node - begin_] = false;
        groups_.group_of[node] = count_;
        groups_.arm[node] = position;
        members_.push_back(node);
      };
      take(seed, Vec3::Zero());
      for (std::size_t next = 0; next < members_.size(); ++next) {
        const std::uint32_t node = members_[next];
        graph_.for_each_link(node, [&](auto link, std::uint32_t other, const auto& branch) {
          if (here(other) && hangs[other - begin_] && members_.size() < size_ && ties_to(node, link) &&
              ties_to(other, link))
            take(other, groups_.arm[node] + branch());
        });
      }
      if (members_.size() > 1)
        ++count_;
      else
        groups_.group_of[seed] = none; // by itself it is no worse than any other
    }
  }

  /// Whether a link is no negligible part of what ties the node.
  template <class Link>
  bool ties_to(std::uint32_t node, const Link& link) const {
    return graph_.weight(link) > weakest_tie_ * total_weight_[node - begin_];
  }
  bool here(std::uint32_t node) const { return node >= begin_ && node < end_; } // none is above all

  void grow_from(std::uint32_t seed) {
    members_.clear();
    candidates_.clear();
    take_in(seed, Vec3::Zero());
    while (members_.size() < size_) {
      auto best = candidates_.end();
      double best_part = weakest_tie_;
      for (auto candidate = candidates_.begin(); candidate != candidates_.end(); ++candidate) {
        const double part = candidate->tie / total_weight_[candidate->node - begin_];
        if (part > best_part) {
          best_part = part;
          best = candidate;
        }
      }
      if (best == candidates_.end())
        return;
      const Candidate chosen = *best;
      candidates_.erase(best); // keeps the order: the earliest found wins a tie, and groups stay round
      take_in(chosen.node, chosen.position);
    }
  }

  void take_in(std::uint32_t node, const Vec3& position) {
    groups_.group_of[node] = count_;
    groups_.arm[node] = position;
    members_.push_back(node);
    graph_.for_each_link(node, [&](auto link, std::uint32_t neighbour, const auto& branch) {
      if (!here(neighbour) || groups_.group_of[neighbour] != none)
        return;
      for (Candidate& candidate : candidates_)
        if (candidate.node == neighbour) {
          candidate.tie += graph_.weight(link);
          return;
        }
      candidates_.push_back({neighbour, graph_.weight(link), position + branch()});
    });
  }

  /// Moves the members into the group they are tied to best; false if no tie is strong enough.
  bool join_best_neighbour() {
    struct Neighbour {
      std::uint32_t group;
      double tie;
      double strongest;
      Vec3 shift; ///< from this group's frame to the neighbour's, along the strongest link
    };
    std::vector<Neighbour> neighbours;
    double total = 0;
    for (const std::uint32_t node : members_) {
      total += total_weight_[node - begin_];
      graph_.for_each_link(node, [&](auto link, std::uint32_t other, const auto& branch) {
        if (!here(other) || groups_.group_of[other] == count_ || groups_.group_of[other] == none)
          return;
        const double weight = graph_.weight(link);
        const std::uint32_t group = groups_.group_of[other];
        auto place = std::find_if(neighbours.begin(), neighbours.end(),
                                  [&](const Neighbour& n) { return n.group == group; });
        if (place == neighbours.end())
          place = neighbours.insert(neighbours.end(), {group, 0, 0, Vec3::Zero()});
        place->tie += weight;
        if (weight > place->strongest) {
          place->strongest = weight;
          place->shift = groups_.arm[other] - branch() - groups_.arm[node];
        }
      });
    }
    const auto best = std::max_element(neighbours.begin(), neighbours.end(),
                                       [](const Neighbour& a, const Neighbour& b) { return a.tie < b.tie; });
    if (best == neighbours.end() || best->tie <= weakest_tie_ * total)
      return false;
    for (const std::uint32_t node : members_) {
      groups_.group_of[node] = best->group;
      groups_.arm[node] += best->shift;
    }
    return true;
  }

  void centre_arms() {
    std::vector<Vec3> centre(count_, Vec3::Zero());
    std::vector<double> members(count_, 0);
    for (std::uint32_t node = begin_; node < end_; ++node)
      if (const std::uint32_t group = groups_.group_of[node]; group != none) {
        centre[group] += groups_.arm[node];
        members[group] += 1;
      }
    for (std::uint32_t node = begin_; node < end_; ++node)
      if (const std::uint32_t group = groups_.group_of[node]; group != none)
        groups_.arm[node] -= centre[group] / members[group];
  }

  const Graph& graph_;
  Groups& groups_;
  std::uint32_t begin_, end_;
  std::uint32_t size_;
  double weakest_tie_;
  std::uint32_t hanging_;
  std::uint32_t count_ = 0;
  std::vector<double> total_weight_; ///< [nodes of the range] of all the links of a node
  std::vector<std::uint32_t> members_;
  std::vector<Candidate> candidates_;
};

/// Groups of a network's nodes: see GroupGrower, which grows them in ranges of consecutive nodes, each by itself.
///
/// @return  the same for any number of threads, since the ranges are
template <class Graph>
Groups grow_groups(const Graph& graph, std::uint32_t size, double weakest_tie, std::uint32_t hanging,
                   core::ThreadPool& pool) {
  constexpr std::uint32_t range = 1U << 16;
  Groups groups;
  groups.group_of.assign(graph.size(), none);
  groups.arm.assign(graph.size(), Vec3::Zero());
  std::vector<std::uint32_t> first(graph.size() / range + 1, 0); // group of each range
  const auto end_of = [&](std::size_t r) {
    return static_cast<std::uint32_t>(std::min<std::size_t>(graph.size(), (r + 1) * range));
  };
  pool.for_each_block(first.size(), [&](std::size_t r) {
    first[r] = GroupGrower(graph, groups, static_cast<std::uint32_t>(r * range), end_of(r), size, weakest_tie,
                           hanging)
                   .grow();
  });
  for (std::uint32_t& count : first)
    groups.count += std::exchange(count, groups.count);
  pool.for_each_block(first.size(), [&](std::size_t r) {
    for (auto node = static_cast<std::uint32_t>(r * range); node < end_of(r); ++node)
      if (groups.group_of[node] != none)
        groups.group_of[node] += first[r];
  });
  return groups;
}

} // namespace cdem::integrate::detail
