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
  using Link = LinkType;
  LinkedNodes<Link> network;
  std::vector<float> inverse_diagonal; ///< [nodes x 36 + 1] of each node's 6x6 block
  std::vector<HeldMask> held;          ///< [nodes] on the level of the particles, else empty
  std::vector<NodeIndex> group_begin;  ///< [groups + 1] first node of each group; empty on the coarsest level
  std::vector<float> arm;              ///< [nodes x 4] from the group's centre, last of each zero
  std::vector<NodeIndex> block_group;  ///< [blocks + 1] first group of each block of the network

  Field rhs, x, previous; ///< [nodes + 1], the last one the ground
  NodeIndex size() const { return network.size(); }

  void allocate_fields() {
    for (Field* field : {&rhs, &x, &previous})
      field->assign(size() + std::size_t{1}, {});
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
template <class Link>
void cut_into_blocks(Level<Link>& level, const Groups* groups, const std::vector<std::uint32_t>& order,
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

/// Writes the level's operator, inverse diagonal and arms from its graph.
///
/// @param groups  of the level's nodes; null on the coarsest level
/// @param order   [nodes] old number of each node
template <class Graph>
Level<typename Graph::Link> make_level(const Graph& graph, const Groups* groups,
                                       const std::vector<std::uint32_t>& order, NodeIndex nodes_per_block,
                                       core::ThreadPool& pool) {
  Level<typename Graph::Link> level;
  cut_into_blocks(level, groups, order, nodes_per_block);
  auto& network = level.network;
  const auto nodes = static_cast<NodeIndex>(order.size());
  const std::vector<std::uint32_t> position = positions_in(order, graph.size(), nodes);

  // A row holds the links that leave its block and, of those that stay, the ones to a later node.
  const auto for_each_row_link = [&](std::size_t block, NodeIndex row, auto&& visit) {
    const NodeIndex begin = network.block_begin[block], end = network.block_begin[block + 1];
    graph.for_each_link(order[row], [&](auto link, std::uint32_t neighbour, const auto& branch) {
      const NodeIndex other = neighbour == none ? nodes : position[neighbour];
      if (other > row || other < begin || other >= end)
        visit(link, other, branch);
    });
  };
  network.row_begin.assign(nodes + std::size_t{1}, 0);
  pool.for_each_block(network.blocks(), [&](std::size_t block) {
    for (NodeIndex row = network.block_begin[block]; row < network.block_begin[block + 1]; ++row)
      for_each_row_link(block, row, [&](auto, NodeIndex, const auto&) { ++network.row_begin[row + 1]; });
  });
  for (NodeIndex row = 0; row < nodes; ++row)
    network.row_begin[row + 1] += network.row_begin[row];
  network.other.resize(network.row_begin.back());
  network.link.resize(network.row_begin.back());
  level.inverse_diagonal.resize(nodes * std::size_t{36} + 1);
  if (groups)
    level.arm.resize(nodes * std::size_t{4});
  pool.for_each_block(network.blocks(), [&](std::size_t block) {
    for (NodeIndex row = network.block_begin[block]; row < network.block_begin[block + 1]; ++row) {
      std::uint64_t place = network.row_begin[row];
      for_each_row_link(block, row, [&](auto link, NodeIndex other, const auto& branch) {
        network.other[place] = other;
        network.link[place++] = graph.packed(link, branch());
      });
      Eigen::Map<Eigen::Matrix<float, 6, 6>>(level.inverse_diagonal.data() + row * std::size_t{36}) =
          inverse_of(diagonal_stiffness(graph, order[row]), graph.held(order[row])).template cast<float>();
      if (groups)
        Eigen::Map<Eigen::Vector3f>(level.arm.data() + row * std::size_t{4}) =
            groups->arm[order[row]].template cast<float>();
    }
  });

  network.ground_begin.assign(1, 0);
  for (std::size_t block = 0; block < network.blocks(); ++block) {
    for (NodeIndex row = network.block_begin[block]; row < network.block_begin[block + 1]; ++row)
      if (const Matrix6* stiffness = graph.ground(order[row])) {
        GroundSpring spring{row, {}};
        Eigen::Map<Eigen::Matrix<float, 6, 6>>(spring.stiffness.data()) = stiffness->template cast<float>();
        network.ground.push_back(spring);
      }
    network.ground_begin.push_back(static_cast<std::uint32_t>(network.ground.size()));
  }
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
