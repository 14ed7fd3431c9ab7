#pragma once

/// @file
/// Set-up of the static multigrid: levels of groups of groups, numbered so that the members of a group follow each other.

#include <cdem/integrate/detail/multigrid_graph.hpp>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <algorithm>
#include <memory>
#include <vector>

namespace cdem::integrate::detail {

/// One level: its operator, the smoother's inverse diagonal, and the groups that make the next level's nodes.
template <class LinkType>
struct Level {
  using Links = LinkType;
  LinkedNodes<Links> network;
  LevelArray<float> inverse_diagonal;     ///< [eights of nodes x 21 x 8], see multiply_symmetric()
  std::vector<std::size_t> inverse_begin; ///< [blocks] where each block's begins
  std::vector<HeldMask> held;             ///< [nodes] on the level of the particles, else empty
  std::vector<NodeIndex> group_begin; ///< [groups + 1] first node of each group; empty on the coarsest level
  LevelArray<float> arm;              ///< [nodes x 4] from the group's centre, last of each zero
  std::vector<NodeIndex> block_group; ///< [blocks + 1] first group of each block of the network

  Field rhs, x, next; ///< [nodes + spare_lines], the first spare one the ground
  NodeIndex size() const { return network.size(); }

  void allocate_fields() {
    for (Field* field : {&rhs, &x, &next})
      field->assign(size() + spare_lines, {});
  }
  std::size_t bytes() const {
    return network.bytes() + inverse_diagonal.size() * sizeof(float) + held.size() +
           group_begin.size() * sizeof(NodeIndex) + arm.size() * sizeof(float) +
           3 * rhs.size() * sizeof(rhs[0]);
  }
};

/// Old number of each node in the new order: members of a group together, groups in their own new order.
///
/// @param group_position  [groups] where each group stands in the next level's order; empty where nodes keep theirs
inline std::vector<std::uint32_t> order_by_group(const Groups& groups,
                                                 const std::vector<std::uint32_t>& group_position) {
  std::vector<std::uint32_t> next(groups.count + 1, 0);
  for (const std::uint32_t group : groups.group_of)
    if (group != none)
      ++next[group_position[group] + 1];
  for (std::size_t g = 0; g < groups.count; ++g)
    next[g + 1] += next[g];
  std::vector<std::uint32_t> order(next.back());
  for (std::uint32_t node = 0; node < groups.group_of.size(); ++node)
    if (groups.group_of[node] != none)
      order[next[group_position[groups.group_of[node]]]++] = node;
  return order;
}

/// Where each old node stands in `order`; `ground` for nodes that are not in it.
inline std::vector<std::uint32_t> positions_in(const std::vector<std::uint32_t>& order, std::size_t nodes,
                                               std::uint32_t ground) {
  std::vector<std::uint32_t> position(nodes, ground);
  for (std::uint32_t k = 0; k < order.size(); ++k)
    position[order[k]] = k;
  return position;
}

/// Bounds of blocks of about `nodes_per_block` nodes made of whole groups, and the groups' own bounds.
template <class Links>
void cut_into_blocks(Level<Links>& level, const Groups* groups, const std::vector<std::uint32_t>& order,
                     NodeIndex nodes_per_block) {
  const auto nodes = static_cast<NodeIndex>(order.size());
  auto& bounds = level.network.block_begin;
  bounds.assign(1, 0);
  if (!groups) {
    for (NodeIndex begin = 0; begin < nodes; begin = bounds.back())
      bounds.push_back(std::min(nodes, begin + nodes_per_block));
    return;
  }
  level.group_begin.assign(1, 0);
  level.block_group.assign(1, 0);
  for (NodeIndex node = 1; node <= nodes; ++node) {
    if (node < nodes && groups->group_of[order[node]] == groups->group_of[order[node - 1]])
      continue;
    level.group_begin.push_back(node);
    if (node - bounds.back() >= nodes_per_block || node == nodes) {
      bounds.push_back(node);
      level.block_group.push_back(static_cast<NodeIndex>(level.group_begin.size() - 1));
    }
  }
}

/// Links of one block before they are packed: a row holds those that leave the block and, of those that stay, the ones
/// to a later node.
template <class Graph>
struct BlockLinks {
  struct Entry {
    NodeIndex row, other; ///< numbers in the level
    typename Graph::Link link;
    Vec3 branch;
  };
  std::vector<Entry> inner, leaving;

  void gather(const Graph& graph, const std::vector<std::uint32_t>& order,
              const std::vector<std::uint32_t>& position, NodeIndex begin, NodeIndex end) {
    inner.clear();
    leaving.clear();
    for (NodeIndex row = begin; row < end; ++row)
      graph.for_each_link(order[row], [&](auto link, std::uint32_t neighbour, const auto& branch) {
        const NodeIndex other =
            neighbour == none ? static_cast<NodeIndex>(order.size()) : position[neighbour];
        if (other < begin || other >= end)
          leaving.push_back({row, other, link, branch()});
        else if (other > row)
          inner.push_back({row, other, link, branch()});
      });
  }

  static std::size_t eights(std::size_t links) { return (links + 7) / 8; }

  /// Packs links into eights. Links that follow each other mostly share their first end: over spans of eight eights they
  /// are dealt out so that the lanes of an eight do not wait for one another's sums.
  static void pack(const Graph& graph, const std::vector<Entry>& entries, NodeIndex first_base,
                   NodeIndex second_base, NodeIndex sink, NodeIndex resting, typename Graph::Links* eight) {
    for (std::size_t span = 0; span < entries.size(); span += 64) {
      const std::size_t count = std::min<std::size_t>(64, entries.size() - span), full = eights(count);
      for (std::size_t k = 0; k < full; ++k, ++eight) {
        *eight = {};
        for (std::size_t lane = 0; lane < 8; ++lane)
          if (const std::size_t place = lane * full + k; place < count) {
            const Entry& entry = entries[span + place];
            eight->first[lane] = entry.row - first_base;
            eight->second[lane] = entry.other - second_base;
            graph.pack(entry.link, entry.branch, *eight, lane);
          } else {
            eight->first[lane] = sink;
            eight->second[lane] = resting;
          }
      }
    }
  }
};

/// Writes the level's links from its graph.
template <class Graph>
void write_links(LinkedNodes<typename Graph::Links>& network, const Graph& graph,
                 const std::vector<std::uint32_t>& order, core::ThreadPool& pool) {
  const auto nodes = static_cast<NodeIndex>(order.size());
  const std::vector<std::uint32_t> position = positions_in(order, graph.size(), nodes);
  const std::size_t blocks = network.blocks();
  network.links_begin.assign(blocks + 1, 0);
  network.leaving.assign(blocks, 0);
  pool.for_each_block(blocks, [&](std::size_t block) {
    const NodeIndex begin = network.block_begin[block], end = network.block_begin[block + 1];
    std::size_t inner = 0, leaving = 0;
    for (NodeIndex row = begin; row < end; ++row)
      graph.for_each_link(order[row], [&](auto, std::uint32_t neighbour, const auto&) {
        const NodeIndex other = neighbour == none ? nodes : position[neighbour];
        (other < begin || other >= end ? leaving : inner) += 1;
      });
    network.leaving[block] = BlockLinks<Graph>::eights(inner / 2); // met at both ends
    network.links_begin[block + 1] = network.leaving[block] + BlockLinks<Graph>::eights(leaving);
  });
  for (std::size_t block = 0; block < blocks; ++block) {
    network.leaving[block] += network.links_begin[block];
    network.links_begin[block + 1] += network.links_begin[block];
  }
  network.links.resize(network.links_begin.back());
  pool.for_each_block(blocks, [&](std::size_t block) {
    const NodeIndex begin = network.block_begin[block], end = network.block_begin[block + 1];
    BlockLinks<Graph> links;
    links.gather(graph, order, position, begin, end);
    const NodeIndex sink = end - begin;
    BlockLinks<Graph>::pack(graph, links.inner, begin, begin, sink, sink,
                            network.links.data() + network.links_begin[block]);
    BlockLinks<Graph>::pack(graph, links.leaving, begin, 0, sink, nodes,
                            network.links.data() + network.leaving[block]);
  });

  network.ground_begin.assign(1, 0);
  for (std::size_t block = 0; block < blocks; ++block) {
    for (NodeIndex row = network.block_begin[block]; row < network.block_begin[block + 1]; ++row)
      if (const Matrix6* stiffness = graph.ground(order[row])) {
        GroundSpring spring{row, {}};
        Eigen::Map<Eigen::Matrix<float, 6, 6>>(spring.stiffness.data()) = stiffness->template cast<float>();
        network.ground.push_back(spring);
      }
    network.ground_begin.push_back(static_cast<std::uint32_t>(network.ground.size()));
  }
}

/// Writes the level's operator, inverse diagonal and arms from its graph.
///
/// @param groups  of the level's nodes; null on the coarsest level
/// @param order   [nodes] old number of each node
template <class Graph>
Level<typename Graph::Links> make_level(const Graph& graph, const Groups* groups,
                                        const std::vector<std::uint32_t>& order, NodeIndex nodes_per_block,
                                        core::ThreadPool& pool) {
  Level<typename Graph::Links> level;
  cut_into_blocks(level, groups, order, nodes_per_block);
  auto& network = level.network;
  write_links(network, graph, order, pool);
  std::size_t eights = 0;
  for (std::size_t block = 0; block < network.blocks(); ++block) {
    level.inverse_begin.push_back(168 * eights);
    eights += (network.block_begin[block + 1] - network.block_begin[block] + std::size_t{7}) / 8;
  }
  level.inverse_diagonal.resize(168 * eights);
  if (groups)
    level.arm.resize(order.size() * 4);
  pool.for_each_block(network.blocks(), [&](std::size_t block) {
    const NodeIndex begin = network.block_begin[block];
    for (NodeIndex row = begin; row < network.block_begin[block + 1]; ++row) {
      const std::size_t place = row - begin;
      pack_symmetric(inverse_of(diagonal_stiffness(graph, order[row]), graph.held(order[row])),
                     level.inverse_diagonal.data() + level.inverse_begin[block] + place / 8 * 168, place % 8);
      if (groups)
        Eigen::Map<Eigen::Vector3f>(level.arm.data() + row * std::size_t{4}) =
            groups->arm[order[row]].template cast<float>();
    }
  });
  level.allocate_fields();
  return level;
}

/// Exact solution on the coarsest level: sparse Cholesky factor of its assembled matrix.
class CoarsestSolver {
public:
  /// @param shift  part of each node's own stiffness that is added to it, so that motions without stiffness do no harm
  void factorise(const GroupGraph& graph, double shift) {
    using Entry = Eigen::Triplet<double>;
    std::vector<Entry> entries;
    const auto add = [&](std::uint32_t row, std::uint32_t column, const Matrix6& block) {
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r)
          if (block(r, c) != 0)
            entries.emplace_back(static_cast<int>(6 * row) + r, static_cast<int>(6 * column) + c,
                                 block(r, c));
    };
    for (std::uint32_t node = 0; node < graph.size(); ++node) {
      Matrix6 block = diagonal_stiffness(graph, node);
      const auto [translation, rotation] = mean_stiffness(block);
      const double least = negligible * std::max(translation, rotation);
      for (int d = 0; d < 6; ++d) {
        const double mean = d < 3 ? translation : rotation;
        block(d, d) += mean > least ? shift * mean : 1;
      }
      add(node, node, block);
    }
    for (const GroupGraph::Edge& edge : graph.edges()) {
      Matrix6 first = Matrix6::Identity(),
              second = Matrix6::Identity(); // rigid motion at the middle of the branch
      first.topRightCorner<3, 3>() = -cross_matrix(0.5 * edge.branch);
      second.topRightCorner<3, 3>() = cross_matrix(0.5 * edge.branch);
      const Matrix6 block = -first.transpose() * edge.stiffness * second;
      add(edge.first, edge.second, block);
      add(edge.second, edge.first, block.transpose());
    }
    const auto unknowns = static_cast<Eigen::Index>(6 * graph.size());
    Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
    matrix.setFromTriplets(entries.begin(), entries.end());
    factor_ = std::make_unique<Factor>(matrix);
    rhs_.resize(unknowns);
  }

  void solve(const Field& rhs, Field& x) {
    const auto nodes = static_cast<std::size_t>(rhs_.size() / 6);
    for (std::size_t node = 0; node < nodes; ++node)
      for (int d = 0; d < 6; ++d)
        rhs_[static_cast<Eigen::Index>(6 * node) + d] = static_cast<double>(rhs[node][d]);
    const Eigen::VectorXd solution = factor_->solve(rhs_);
    for (std::size_t node = 0; node < nodes; ++node)
      for (int d = 0; d < 6; ++d)
        x[node][d] = static_cast<float>(solution[static_cast<Eigen::Index>(6 * node) + d]);
  }

  bool factorised() const { return factor_ && factor_->info() == Eigen::Success; }
  std::size_t entries() const {
    return static_cast<std::size_t>(factor_->matrixL().nestedExpression().nonZeros());
  }

private:
  using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
  std::unique_ptr<Factor> factor_;
  Eigen::VectorXd rhs_;
};

} // namespace cdem::integrate::detail
