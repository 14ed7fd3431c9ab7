#pragma once

/// @file
/// The networks from which the static multigrid is set up: the body's bonds, and the links between groups.

#include <cdem/integrate/detail/multigrid_groups.hpp>
#include <cdem/integrate/detail/multigrid_operator.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <vector>

namespace cdem::integrate::detail {

/// Units in which a body's numbers are near one: single precision needs them, and they make translations and
/// rotations comparable.
struct Units {
  double length = 1;    ///< m: mean length of the bonds
  double stiffness = 1; ///< N/m: mean normal stiffness of the bonds
};

/// Which degrees of freedom of a particle are held: bit d for degree of freedom d.
using HeldMask = std::uint8_t;
inline constexpr HeldMask all_held = 0x3F;

/// The bonds of a body, in the multigrid's units.
template <LinearBonds Forces>
class BondGraph {
public:
  using Link = BondLink;

  BondGraph(const Forces& forces, const std::vector<HeldMask>& held, Units units)
      : forces_(forces), held_(held), units_(units) {}

  std::uint32_t size() const { return static_cast<std::uint32_t>(held_.size()); }
  bool is_held(std::uint32_t node) const { return held_[node] == all_held; }
  HeldMask held(std::uint32_t node) const { return held_[node]; }
  double weight(BondIndex b) const {
    const auto& stiffness = forces_.stiffness(b);
    return (stiffness.normal + 2 * stiffness.tangential) / units_.stiffness;
  }

  /// visit(bond, neighbour or none, branch): branch() goes from the node to the neighbour.
  template <class Visit>
  void for_each_link(std::uint32_t node, Visit&& visit) const {
    for (const BondIndex b : forces_.bonds_of(node)) {
      const auto [first, second] = forces_.ends(b);
      const bool outward = first == node;
      const std::uint32_t neighbour = outward ? second : first;
      visit(b, is_held(neighbour) ? none : neighbour, [this, b, outward]() -> Vec3 {
        return ((outward ? 1 : -1) * forces_.length(b) / units_.length) * forces_.direction(b);
      });
    }
  }

  /// Stiffness of a link at its middle.
  Matrix6 stiffness(BondIndex b) const {
    const auto& k = forces_.stiffness(b);
    const Vec3 n = forces_.direction(b);
    const Mat3 along = n * n.transpose(), across = Mat3::Identity() - along;
    Matrix6 matrix = Matrix6::Zero();
    matrix.topLeftCorner<3, 3>() = (k.normal * along + k.tangential * across) / units_.stiffness;
    matrix.bottomRightCorner<3, 3>() = (k.torsion * along + k.bending * across) / moment_stiffness();
    return matrix;
  }

  Link packed(BondIndex b, const Vec3& branch) const {
    const auto& k = forces_.stiffness(b);
    const Eigen::Vector3f n = branch.normalized().template cast<float>();
    return {{n.x(), n.y(), n.z(), static_cast<float>(0.5 * branch.norm())},
            static_cast<float>(k.tangential / units_.stiffness),
            static_cast<float>((k.normal - k.tangential) / units_.stiffness),
            static_cast<float>(k.bending / moment_stiffness()),
            static_cast<float>((k.torsion - k.bending) / moment_stiffness())};
  }

  /// Stiffness that ties a node to the ground, besides its links: none.
  const Matrix6* ground(std::uint32_t) const { return nullptr; }

private:
  double moment_stiffness() const { return units_.stiffness * units_.length * units_.length; }

  const Forces& forces_;
  const std::vector<HeldMask>& held_;
  Units units_;
};

/// The links between groups, each once, by first group.
class GroupGraph {
public:
  using Link = GroupLink;
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

  Link packed(std::uint32_t e, const Vec3& branch) const {
    Link link;
    Eigen::Map<Eigen::Matrix<float, 6, 6>>(link.data.data()) = edges_[e].stiffness.cast<float>();
    Eigen::Map<Eigen::Vector3f>(link.data.data() + 36) = (0.5 * branch).cast<float>();
    return link;
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
    sum += carried(graph.stiffness(link), 0.5 * branch());
  });
  return sum;
}

/// Mean stiffness of a node against translations (first) and against rotations (second).
inline std::pair<double, double> mean_stiffness(const Matrix6& stiffness) {
  return {stiffness.topLeftCorner<3, 3>().trace() / 3, stiffness.bottomRightCorner<3, 3>().trace() / 3};
}

/// A stiffness below this part of a node's largest is rounding: the motion meets none.
inline constexpr double negligible = 1e-14;

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
  const Eigen::LLT<Matrix6> factor(scaled);
  Matrix6 inverse;
  if (factor.info() == Eigen::Success && factor.matrixLLT().diagonal().minCoeff() > 1e-5) {
    inverse = factor.solve(Matrix6::Identity());
  } else {
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
          ground += carried(*own, arm);
          grounded = true;
        }
        if (graph.held(node) != 0) {
          const Vector6 diagonal = diagonal_stiffness(graph, node).diagonal();
          Matrix6 springs = Matrix6::Zero();
          for (int d = 0; d < 6; ++d)
            if (graph.held(node) >> d & 1)
              springs(d, d) = held_stiffness * diagonal[d];
          ground += carried(springs, arm);
          grounded = true;
        }
        graph.for_each_link(node, [&](auto link, std::uint32_t neighbour, const auto& branch) {
          if (neighbour == none) {
            ground += carried(graph.stiffness(link), arm + 0.5 * branch());
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
              ground.bottomRightCorner<3, 3>() += 0.5 * lever.transpose() *
                                                  graph.stiffness(link).template topLeftCorner<3, 3>() *
                                                  lever; // met twice
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
          place->stiffness += carried(graph.stiffness(link), arm + 0.5 * (way - place->branch));
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
