#pragma once

/// @file
/// The networks from which the static multigrid is set up: the body's bonds, and the links between groups.

#include <cdem/integrate/detail/multigrid_bonds.hpp>
#include <cdem/integrate/detail/multigrid_operator.hpp>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <vector>

namespace cdem::integrate::detail {

/// The network of a body's particles.
template <LinearBonds Forces>
class BondGraph {
public:
  using Links = BondLinks;
  using Link = typename Bonds<Forces>::Number;

  BondGraph(const Bonds<Forces>& bonds, const std::vector<HeldMask>& held) : bonds_(bonds), held_(held) {}

  std::uint32_t size() const { return static_cast<std::uint32_t>(held_.size()); }
  bool is_held(std::uint32_t node) const { return held_[node] == all_held; }
  HeldMask held(std::uint32_t node) const { return held_[node]; }
  double weight(Link link) const { return bonds_.weight(link); }

  /// visit(link, neighbour or none, branch): branch() goes from the node to the neighbour.
  template <class Visit>
  void for_each_link(std::uint32_t node, Visit&& visit) const {
    for (const auto end : bonds_.of(node))
      visit(end.bond, is_held(end.neighbour) ? none : end.neighbour,
            [this, node, end]() -> Vec3 { return bonds_.branch(node, end); });
  }

  BondStiffness stiffness(Link link) const { return bonds_.stiffness(link); }
  Mat3 slip_stiffness(Link link) const { return bonds_.stiffness(link).slip; }
  void pack(Link link, const Vec3& branch, Links& links, std::size_t lane) const {
    bonds_.pack(link, branch, links, lane);
  }

  /// Stiffness that ties a node to the ground, besides its links: none.
  const Matrix6* ground(std::uint32_t) const { return nullptr; }

private:
  const Bonds<Forces>& bonds_;
  const std::vector<HeldMask>& held_;
};

/// Stores a symmetric matrix in one lane, see multiply_symmetric().
inline void pack_symmetric(const Matrix6& matrix, float* upper, std::size_t lane) {
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      upper[8 * static_cast<std::size_t>(upper_entry(row, column)) + lane] =
          static_cast<float>(matrix(row, column));
}

/// The links between groups, each once, by first group.
class GroupGraph {
public:
  using Links = GroupLinks;
  using Link = std::uint32_t;
  struct Edge {
    std::uint32_t first, second;
    Vec3 branch;       ///< from the centre of `first` to that of `second`
    Matrix6 stiffness; ///< at the middle of the branch
  };

  GroupGraph(std::vector<Edge> edges, std::vector<Matrix6> grounds, std::vector<std::uint32_t> ground_of)
      : edges_(std::move(edges)), grounds_(std::move(grounds)), ground_of_(std::move(ground_of)),
        begin_(ground_of_.size() + 1, 0) {
    for (const Edge& edge : edges_) {
      ++begin_[edge.first + 1];
      ++begin_[edge.second + 1];
    }
    for (std::size_t i = 1; i < begin_.size(); ++i)
      begin_[i] += begin_[i - 1];
    ends_.resize(2 * edges_.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      ends_[next[edges_[e].first]++] = e;
      ends_[next[edges_[e].second]++] = e;
    }
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(ground_of_.size()); }
  bool is_held(std::uint32_t) const { return false; }
  HeldMask held(std::uint32_t) const { return 0; }
  double weight(std::uint32_t e) const { return edges_[e].stiffness.topLeftCorner<3, 3>().trace(); }

  template <class Visit>
  void for_each_link(std::uint32_t node, Visit&& visit) const {
    for (std::uint32_t k = begin_[node]; k < begin_[node + 1]; ++k) {
      const std::uint32_t e = ends_[k];
      const bool outward = edges_[e].first == node;
      const std::uint32_t neighbour = outward ? edges_[e].second : edges_[e].first;
      visit(e, neighbour, [this, e, outward]() -> Vec3 { return (outward ? 1 : -1) * edges_[e].branch; });
    }
  }

  const Matrix6& stiffness(std::uint32_t e) const { return edges_[e].stiffness; }

  Mat3 slip_stiffness(std::uint32_t e) const { return edges_[e].stiffness.topLeftCorner<3, 3>(); }

  void pack(std::uint32_t e, const Vec3& branch, Links& links, std::size_t lane) const {
    for (int d = 0; d < 3; ++d)
      links.half_branch[d][lane] = static_cast<float>(0.5 * branch[d]);
    pack_symmetric(edges_[e].stiffness, links.upper.data(), lane);
  }

  const Matrix6* ground(std::uint32_t node) const {
    return ground_of_[node] == none ? nullptr : &grounds_[ground_of_[node]];
  }

  const std::vector<Edge>& edges() const { return edges_; }

private:
  std::vector<Edge> edges_;
  std::vector<Matrix6> grounds_;
  std::vector<std::uint32_t> ground_of_; ///< [nodes] index in grounds_ or none
  std::vector<std::uint32_t> begin_;     ///< [nodes + 1]
  std::vector<std::uint32_t> ends_;      ///< [2 edges]
};

/// Stiffness of a node with everything else at rest.
template <class Graph>
Matrix6 diagonal_stiffness(const Graph& graph, std::uint32_t node) {
  Matrix6 sum = Matrix6::Zero();
  if (const Matrix6* ground = graph.ground(node))
    sum += *ground;
  graph.for_each_link(node, [&](auto link, std::uint32_t, const auto& branch) {
    add_carried(sum, graph.stiffness(link), 0.5 * branch());
  });
  return sum;
}

/// Mean stiffness of a node against translations (first) and against rotations (second).
inline std::pair<double, double> mean_stiffness(const Matrix6& stiffness) {
  return {stiffness.topLeftCorner<3, 3>().trace() / 3, stiffness.bottomRightCorner<3, 3>().trace() / 3};
}

/// A stiffness below this part of a node's largest is rounding: the motion meets none.
inline constexpr double negligible = 1e-14;

/// Inverse of a positive definite matrix by Cholesky's factor; false if that meets a pivot below 1e-10.
inline bool invert_positive(const Matrix6& matrix, Matrix6& inverse) {
  double factor[6][6], inverted[6][6]; // L and its inverse, lower triangles
  for (int j = 0; j < 6; ++j) {
    for (int i = j; i < 6; ++i) {
      double sum = matrix(i, j);
      for (int k = 0; k < j; ++k)
        sum -= factor[i][k] * factor[j][k];
      if (i > j) {
        factor[i][j] = sum * inverted[j][j];
      } else {
        if (!(sum > 1e-10))
          return false;
        inverted[j][j] = 1 / std::sqrt(sum);
      }
    }
    for (int c = 0; c < j; ++c) {
      double sum = 0;
      for (int k = c; k < j; ++k)
        sum -= factor[j][k] * inverted[k][c];
      inverted[j][c] = sum * inverted[j][j];
    }
  }
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) {
      double sum = 0;
      for (int k = i; k < 6; ++k)
        sum += inverted[k][i] * inverted[k][j];
      inverse(i, j) = inverse(j, i) = sum;
    }
  return true;
}

/// Inverse of a node's stiffness over its free degrees of freedom; zero over the held ones, and over motions that
/// meet no stiffness: least such motion, with rotations and translations each measured by their mean stiffness.
inline Matrix6 inverse_of(Matrix6 stiffness, HeldMask held) {
  const double least = negligible * stiffness.diagonal().maxCoeff();
  for (int d = 0; d < 6; ++d)
    if (held >> d & 1) {
      stiffness.row(d).setZero();
      stiffness.col(d).setZero();
    }
  const auto [translation, rotation] = mean_stiffness(stiffness);
  const auto scale_of = [least](double mean) { return mean > least ? 1 / std::sqrt(mean) : 0; };
  Vector6 scale;
  scale << Vec3::Constant(scale_of(translation)), Vec3::Constant(scale_of(rotation));
  const Matrix6 scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
  Matrix6 inverse;
  if (!invert_positive(scaled, inverse)) {
    const Eigen::SelfAdjointEigenSolver<Matrix6> modes(scaled);
    const Vector6 inverted = modes.eigenvalues().unaryExpr([](double k) { return k > 1e-10 ? 1 / k : 0; });
    inverse = modes.eigenvectors() * inverted.asDiagonal() * modes.eigenvectors().transpose();
  }
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

/// The network of groups that the rigid motions of the groups of `graph` make: its stiffness is the Galerkin product.
///
/// A link within a group is not strained by the group's motion and vanishes. Those between two groups are carried
/// to the middle of the groups' branch and added. What a held degree of freedom of a group's member resists is
/// taken as a spring to the ground with the member's own stiffness, times `held_stiffness`; a link to a member that
/// is held altogether is exact.
///
/// @complexity O(links)
template <class Graph>
GroupGraph group_graph(const Graph& graph, const Groups& groups, double held_stiffness,
                       core::ThreadPool& pool) {
  std::vector<std::uint32_t> begin(groups.count + 1, 0), members;
  for (const std::uint32_t group : groups.group_of)
    if (group != none)
      ++begin[group + 1];
  for (std::size_t g = 0; g < groups.count; ++g)
    begin[g + 1] += begin[g];
  members.resize(begin.back());
  {
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t node = 0; node < graph.size(); ++node)
      if (groups.group_of[node] != none)
        members[next[groups.group_of[node]]++] = node;
  }

  constexpr std::size_t groups_per_block = 256;
  struct Part {
    std::vector<GroupGraph::Edge> edges;
    std::vector<std::pair<std::uint32_t, Matrix6>> grounds;
  };
  std::vector<Part> parts((groups.count + groups_per_block - 1) / groups_per_block);
  pool.for_each_block(parts.size(), [&](std::size_t block) {
    Part& part = parts[block];
    const std::size_t last = std::min<std::size_t>(groups.count, (block + 1) * groups_per_block);
    for (auto group = static_cast<std::uint32_t>(block * groups_per_block); group < last; ++group) {
      const std::size_t first_edge = part.edges.size();
      Matrix6 ground = Matrix6::Zero();
      bool grounded = false;
      for (std::uint32_t m = begin[group]; m < begin[group + 1]; ++m) {
        const std::uint32_t node = members[m];
        const Vec3& arm = groups.arm[node];
        if (const Matrix6* own = graph.ground(node)) {
          add_carried(ground, *own, arm);
          grounded = true;
        }
        if (graph.held(node) != 0) {
          const Vector6 diagonal = diagonal_stiffness(graph, node).diagonal();
          Matrix6 springs = Matrix6::Zero();
          for (int d = 0; d < 6; ++d)
            if (graph.held(node) >> d & 1)
              springs(d, d) = held_stiffness * diagonal[d];
          add_carried(ground, springs, arm);
          grounded = true;
        }
        graph.for_each_link(node, [&](auto link, std::uint32_t neighbour, const auto& branch) {
          if (neighbour == none) {
            add_carried(ground, graph.stiffness(link), arm + 0.5 * branch());
            grounded = true;
            return;
          }
          const std::uint32_t other = groups.group_of[neighbour];
          if (other < group)
            return; // the other group has it
          const Vec3 way = branch();
          const Vec3 between = arm + way - groups.arm[neighbour]; // from this group's centre to the other's
          if (other == group) { // not strained, unless it closes on the group through a periodic face
            if (between.squaredNorm() > 1e-6 * way.squaredNorm()) {
              const Mat3 lever = cross_matrix(between);
              ground.bottomRightCorner<3, 3>() +=
                  0.5 * lever.transpose() * graph.slip_stiffness(link) * lever; // met twice
              grounded = true;
            }
            return;
          }
          auto place = part.edges.begin() + static_cast<std::ptrdiff_t>(first_edge);
          while (
              place != part.edges.end() &&
              !(place->second == other && (place->branch - between).squaredNorm() < 1e-6 * way.squaredNorm()))
            ++place;
          if (place == part.edges.end())
            place = part.edges.insert(place, {group, other, between, Matrix6::Zero()});
          add_carried(place->stiffness, graph.stiffness(link), arm + 0.5 * (way - place->branch));
        });
      }
      if (grounded)
        part.grounds.emplace_back(group, ground);
    }
  });

  std::vector<GroupGraph::Edge> edges;
  std::size_t count = 0;
  for (const Part& part : parts)
    count += part.edges.size();
  edges.reserve(count);
  std::vector<Matrix6> grounds;
  std::vector<std::uint32_t> ground_of(groups.count, none);
  for (Part& part : parts) {
    edges.insert(edges.end(), part.edges.begin(), part.edges.end());
    for (const auto& [group, ground] : part.grounds) {
      ground_of[group] = static_cast<std::uint32_t>(grounds.size());
      grounds.push_back(ground);
    }
    part = Part{};
  }
  return GroupGraph(std::move(edges), std::move(grounds), std::move(ground_of));
}

} // namespace cdem::integrate::detail
