#pragma once

/// @file
/// The cycle of the static multigrid: polynomial smoothing, restriction and prolongation by rigid motions, inner
/// conjugate gradients.

#include <cdem/integrate/detail/multigrid_hierarchy.hpp>
#include <cdem/integrate/detail/multigrid_smoother.hpp>

#include <utility>

namespace cdem::integrate::detail {

/// x with its held degrees of freedom set to zero.
inline Twist free_part(Twist x, HeldMask held) {
  for (int d = 0; d < 3; ++d) {
    if (held >> d & 1)
      x.linear[d] = 0;
    if (held >> (d + 3) & 1)
      x.angular[d] = 0;
  }
  return x;
}

/// A block's lines of the level's fields, for relax().
template <class Links>
RelaxedBlock relaxed_block(Level<Links>& level, std::size_t block, float gain) {
  const NodeIndex begin = level.network.block_begin[block];
  return {.inverse = level.inverse_diagonal.data() + level.inverse_begin[block],
          .rhs = level.rhs[begin].component,
          .force = nullptr,
          .x = level.x[begin].component,
          .result = level.next[begin].component,
          .count = level.network.block_begin[block + 1] - begin,
          .gain = gain};
}

/// x = first step from zero.
template <class Links>
void start_smoothing(Level<Links>& level, int steps, core::ThreadPool& pool) {
  const float gain = smoothing_gain(0, steps);
  pool.for_each_block(level.network.blocks(), [&](std::size_t block) {
    const RelaxedBlock relaxed = relaxed_block(level, block, gain);
    with_loops([&](auto loops) { loops.relax_zero(relaxed); });
  });
  std::swap(level.x, level.next);
}

/// Step j on x.
template <class Links>
void smooth(Level<Links>& level, int j, int steps, core::ThreadPool& pool) {
  const float gain = smoothing_gain(j, steps);
  level.network.for_each_block(level.x, pool,
                               [&](std::size_t block, NodeIndex, NodeIndex, const Field& force) {
                                 RelaxedBlock relaxed = relaxed_block(level, block, gain);
                                 relaxed.force = lines(force);
                                 with_loops([&](auto loops) { loops.relax(relaxed); });
                               });
  std::swap(level.x, level.next);
}

/// Forces and moments of the residual b - K x on each group, about its centre.
template <class Links>
void restrict_residual(const Level<Links>& level, Field& group_rhs, core::ThreadPool& pool) {
  level.network.for_each_block(
      level.x, pool, [&](std::size_t block, NodeIndex begin, NodeIndex, const Field& force) {
        for (NodeIndex group = level.block_group[block]; group < level.block_group[block + 1]; ++group) {
          Twist sum;
          for (NodeIndex node = level.group_begin[group]; node < level.group_begin[group + 1]; ++node) {
            Twist residual = Twist::load(level.rhs[node].component);
            residual += Twist::load(force[node - begin].component);
            if (!level.held.empty() && level.held[node] != 0)
              residual = free_part(residual, level.held[node]);
            const Float4 arm = load4(level.arm.data() + 4 * std::size_t{node});
            residual.angular += cross(arm, residual.linear);
            sum += residual;
          }
          sum.clean().store(group_rhs[group].component);
        }
      });
}

/// x += rigid motion of each node's group.
template <class Links>
void add_group_motion(Level<Links>& level, const Field& group_x, core::ThreadPool& pool) {
  pool.for_each_block(level.network.blocks(), [&](std::size_t block) {
    for (NodeIndex group = level.block_group[block]; group < level.block_group[block + 1]; ++group) {
      const Twist motion = Twist::load(group_x[group].component);
      for (NodeIndex node = level.group_begin[group]; node < level.group_begin[group + 1]; ++node) {
        const Float4 arm = load4(level.arm.data() + 4 * std::size_t{node});
        Twist carried{motion.linear + cross(motion.angular, arm), motion.angular};
        if (!level.held.empty() && level.held[node] != 0)
          carried = free_part(carried, level.held[node]);
        carried += Twist::load(level.x[node].component);
        carried.clean().store(level.x[node].component);
      }
    }
  });
}

/// What the cycle may be told.
struct CycleParameters {
  int smoothing_steps = 2;       ///< steps before and after the coarse correction
  int group_smoothing_steps = 1; ///< the same on the levels of groups
  double inner_tolerance =
      0.25; ///< an inner iteration that cut the residual so far is not followed by a second
};

/// The hierarchy and its cycle: an approximate inverse of the stiffness over the free degrees of freedom.
///
/// On the particles one V-cycle; on each level of groups up to two iterations of conjugate gradients preconditioned by
/// that level's V-cycle (K-cycle: Notay and Vassilevski, Numer. Linear Algebra Appl. 15 (2008) 473-487). The inner
/// iterations make it slightly non-linear: the outer ones must be flexible.
class Hierarchy {
public:
  struct Parameters {
    std::uint32_t group_size = 20;    ///< particles or groups to a group
    std::uint32_t coarsest_size = 60; ///< groups that the sparse factor takes
    double weakest_tie = 0.05;        ///< see GroupGrower
    std::uint32_t hanging = 3;        ///< see GroupGrower
    double held_stiffness = 1;        ///< see group_graph()
    double shift = 1e-12;             ///< see CoarsestSolver
    CycleParameters cycle = {};
  };

  template <LinearBonds Forces>
  Hierarchy(const BondGraph<Forces>& bonds, const Parameters& parameters, core::ThreadPool& pool)
      : parameters_(parameters.cycle) {
    std::vector<Groups> groups; // of the particles, of their groups, ...
    groups.push_back(
        grow_groups(bonds, parameters.group_size, parameters.weakest_tie, parameters.hanging, pool));
    std::vector<GroupGraph> graphs;
    graphs.push_back(group_graph(bonds, groups[0], parameters.held_stiffness, pool));
    while (graphs.back().size() > parameters.coarsest_size) {
      Groups next = grow_groups(graphs.back(), parameters.group_size, parameters.weakest_tie, 0, pool);
      if (next.count > 0.9 * graphs.back().size())
        break; // nothing left to join: many bodies, each of one group
      groups.push_back(std::move(next));
      graphs.push_back(group_graph(graphs.back(), groups.back(), parameters.held_stiffness, pool));
    }
    coarsest_.factorise(graphs.back(), parameters.shift);

    std::vector<std::uint32_t> position(graphs.back().size()); // where each node of the level above stands
    for (std::uint32_t node = 0; node < position.size(); ++node)
      position[node] = node;
    levels_.resize(graphs.size() - 1);
    for (std::size_t k = graphs.size() - 1; k-- > 0;) {
      const std::vector<std::uint32_t> order = order_by_group(groups[k + 1], position);
      levels_[k].level = make_level(graphs[k], &groups[k + 1], order, nodes_per_coarse_block, pool);
      levels_[k].allocate();
      position = positions_in(order, graphs[k].size(), none);
      graphs.pop_back();
    }
    const std::vector<std::uint32_t> order = order_by_group(groups[0], position);
    particles_ = make_level(bonds, &groups[0], order, nodes_per_block, pool);
    particles_.held.resize(order.size());
    for (std::size_t k = 0; k < order.size(); ++k)
      particles_.held[k] = bonds.held(order[k]);
    place_ = positions_in(order, bonds.size(), none);
    const std::size_t coarsest_nodes =
        levels_.empty() ? particles_.group_begin.size() - 1 : levels_.back().level.group_begin.size() - 1;
    coarsest_rhs_.resize(coarsest_nodes);
    coarsest_x_.resize(coarsest_nodes);
  }

  /// [particles] place of each in the fields; none for those held altogether.
  const std::vector<std::uint32_t>& place() const { return place_; }
  /// Right-hand side, to be filled; changed by nobody.
  Field& rhs() { return particles_.rhs; }
  /// What precondition() made of it.
  const Field& result() const { return particles_.x; }

  /// One V-cycle on the particles.
  void precondition(core::ThreadPool& pool) { cycle(particles_, 0, pool); }

  std::size_t level_count() const { return levels_.size() + 2; }
  const Level<BondLinks>& particle_level() const { return particles_; }
  struct Size {
    std::size_t nodes, links, bytes;
    double applications;
  };
  /// Nodes, links, memory and operator applications so far of each level, the coarsest last.
  std::vector<Size> sizes() const {
    std::vector<Size> all{
        {particles_.size(), particles_.network.links.size() * 8, particles_.bytes(), applications_}};
    for (const auto& group_level : levels_)
      all.push_back({group_level.level.size(), group_level.level.network.links.size() * 8,
                     group_level.level.bytes() + 3 * group_level.search.size() * sizeof(Field::value_type),
                     group_level.applications});
    all.push_back({coarsest_x_.size(), coarsest_.entries(), coarsest_.entries() * 12, 0});
    return all;
  }

private:
  static constexpr NodeIndex nodes_per_block = 2048;
  static constexpr NodeIndex nodes_per_coarse_block = 512;

  struct GroupLevel {
    Level<GroupLinks> level;
    Field search, image, image2; ///< of the inner conjugate gradients
    double applications = 0;
    void allocate() {
      for (Field* field : {&search, &image, &image2})
        field->assign(level.rhs.size(), {});
    }
  };

  template <class Links>
  void cycle(Level<Links>& level, std::size_t coarse, core::ThreadPool& pool) {
    const int steps = coarse == 0 ? parameters_.smoothing_steps : parameters_.group_smoothing_steps;
    start_smoothing(level, steps, pool);
    for (int j = 1; j < steps; ++j)
      smooth(level, j, steps, pool);
    const bool last = coarse == levels_.size();
    restrict_residual(level, last ? coarsest_rhs_ : levels_[coarse].level.rhs, pool);
    if (last)
      coarsest_.solve(coarsest_rhs_, coarsest_x_);
    else
      solve(coarse, pool);
    add_group_motion(level, last ? coarsest_x_ : levels_[coarse].level.x, pool);
    for (int j = steps; j-- > 0;)
      smooth(level, j, steps, pool);
    (coarse == 0 ? applications_ : levels_[coarse - 1].applications) += 2 * steps;
  }

  /// x = approximate solution of K x = rhs on a level of groups, by up to two iterations; overwrites rhs.
  void solve(std::size_t index, core::ThreadPool& pool) {
    GroupLevel& group_level = levels_[index];
    Level<GroupLinks>& level = group_level.level;
    const double start = inner(level.rhs, level.rhs, pool);
    cycle(level, index + 1, pool);
    apply(group_level, level.x, group_level.image, pool);
    const double energy = inner(level.x, group_level.image, pool), work = inner(level.x, level.rhs, pool);
    if (!(energy > 0))
      return;
    const auto step = static_cast<float>(work / energy);
    std::swap(group_level.search, level.x);
    combine(level.rhs, 1, level.rhs, -step, group_level.image, pool);
    const double left = inner(level.rhs, level.rhs, pool);
    if (left <= parameters_.inner_tolerance * parameters_.inner_tolerance * start) {
      combine(level.x, step, group_level.search, 0, group_level.search, pool);
      return;
    }
    cycle(level, index + 1, pool);
    apply(group_level, level.x, group_level.image2, pool);
    const double coupling = inner(level.x, group_level.image, pool),
                 energy2 = inner(level.x, group_level.image2, pool), work2 = inner(level.x, level.rhs, pool),
                 rest = energy2 - coupling * coupling / energy;
    const double step2 = rest > 0 ? work2 / rest : 0;
    combine(level.x, static_cast<float>(step2), level.x,
            static_cast<float>(work / energy - coupling / energy * step2), group_level.search, pool);
  }

  static void apply(GroupLevel& group_level, const Field& x, Field& image, core::ThreadPool& pool) {
    group_level.level.network.for_each_block(
        x, pool, [&](std::size_t, NodeIndex begin, NodeIndex end, const Field& force) {
          for (NodeIndex node = begin; node < end; ++node)
            (-1.0F * Twist::load(force[node - begin].component)).store(image[node].component);
        });
    group_level.applications += 1;
  }

  static double inner(const Field& a, const Field& b, core::ThreadPool& pool) {
    return core::parallel_sum(pool, a.size(), 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t node = begin; node < end; ++node) {
        const Twist u = Twist::load(a[node].component), v = Twist::load(b[node].component);
        sum += static_cast<double>(dot(u.linear, v.linear)[0] + dot(u.angular, v.angular)[0]);
      }
      return sum;
    });
  }

  /// result = s a + t b
  static void combine(Field& result, float s, const Field& a, float t, const Field& b,
                      core::ThreadPool& pool) {
    core::parallel_for(pool, result.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t node = begin; node < end; ++node) {
        Twist sum = s * Twist::load(a[node].component);
        sum += t * Twist::load(b[node].component);
        sum.store(result[node].component);
      }
    });
  }

  CycleParameters parameters_;
  Level<BondLinks> particles_;
  std::vector<std::uint32_t> place_; ///< [particles] their nodes on the first level
  std::vector<GroupLevel> levels_;   ///< of groups, without the coarsest
  CoarsestSolver coarsest_;
  Field coarsest_rhs_, coarsest_x_;
  double applications_ = 0;
};

} // namespace cdem::integrate::detail
