#pragma once

/// @file
/// A body's bonds as the set-up of the static multigrid reads them: by particle, in the body's own units.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/integrate/detail/multigrid_groups.hpp>
#include <cdem/integrate/detail/multigrid_lanes.hpp>
#include <cdem/integrate/detail/multigrid_link.hpp>
#include <cdem/integrate/detail/multigrid_memory.hpp>

#include <limits>
#include <span>
#include <utility>
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
inline constexpr HeldMask all_held = 0x3F, all_translations_held = 0x07;

/// Stiffness of a bond at its middle: against slip and against turn, which it does not couple.
struct BondStiffness {
  Mat3 slip, turn;
};

/// Adds the stiffness of a bond whose middle is `arm` away: S' C S, S = [1, -[arm]x; 0, 1].
inline void add_carried(Matrix6& sum, const BondStiffness& stiffness, const Vec3& arm) {
  const Mat3 lever = -cross_matrix(arm), couple = stiffness.slip * lever;
  sum.topLeftCorner<3, 3>() += stiffness.slip;
  sum.topRightCorner<3, 3>() += couple;
  sum.bottomLeftCorner<3, 3>() += couple.transpose();
  sum.bottomRightCorner<3, 3>() += stiffness.turn + lever.transpose() * couple;
}
inline void add_carried(Matrix6& sum, const Matrix6& stiffness, const Vec3& arm) {
  sum += carried(stiffness, arm);
}

/// The bonds that resist anything, by particle.
template <LinearBonds Forces>
class Bonds {
public:
  using Number = std::uint32_t;
  struct End {
    std::uint32_t neighbour;
    Number bond;
  };

  /// @throws core::InvalidInput if the bonds are more than 32 bits number
  /// @complexity O(bonds); 32 bytes a bond and 8 a particle
  Bonds(const Forces& forces, core::ThreadPool& pool) : forces_(forces), ties_(forces.bond_count()) {
    core::expect(forces.bond_count() < std::numeric_limits<Number>::max(), "number of bonds",
                 forces.bond_count(), "fewer than 2^32 can be solved for");
    find_units(pool);
    list_ends();
  }

  const Units& units() const { return units_; }
  double moment_stiffness() const { return units_.stiffness * units_.length * units_.length; }
  const Forces& forces() const { return forces_; }
  std::uint32_t particles() const { return static_cast<std::uint32_t>(begin_.size() - 1); }
  /// The bonds of a particle, by number.
  std::span<const End> of(std::uint32_t particle) const {
    return {ends_.data() + begin_[particle], ends_.data() + begin_[particle + 1]};
  }
  /// How strongly a bond ties its ends, 0 for one that does not resist slip.
  double weight(Number b) const { return static_cast<double>(ties_[b].weight); }
  /// From the particle to the bond's other end, rounded to single precision.
  Vec3 branch(std::uint32_t particle, End end) const {
    const auto& branch = ties_[end.bond].branch;
    return (particle < end.neighbour ? 1 : -1) *
           Eigen::Vector3f(branch[0], branch[1], branch[2]).cast<double>();
  }
  /// The same, not rounded.
  Vec3 exact_branch(std::uint32_t particle, End end) const {
    const bool outward = forces_.ends(end.bond).first == particle;
    return ((outward ? 1 : -1) * forces_.length(end.bond) / units_.length) * forces_.direction(end.bond);
  }

  BondStiffness stiffness(Number b) const {
    const auto& k = forces_.stiffness(b);
    const Vec3 n = forces_.direction(b);
    const Mat3 along = n * n.transpose(), across = Mat3::Identity() - along;
    return {(k.normal * along + k.tangential * across) / units_.stiffness,
            (k.torsion * along + k.bending * across) / moment_stiffness()};
  }

  /// Stiffness of a particle with all others at rest.
  Matrix6 stiffness_of_particle(std::uint32_t particle) const {
    Matrix6 sum = Matrix6::Zero();
    for (const End end : of(particle))
      add_carried(sum, stiffness(end.bond), 0.5 * exact_branch(particle, end));
    return sum;
  }

  void pack(Number b, const Vec3& branch, BondLinks& links, std::size_t lane) const {
    const auto& k = forces_.stiffness(b);
    const double square = 0.25 * branch.squaredNorm();
    for (int d = 0; d < 3; ++d)
      links.half_branch[d][lane] = static_cast<float>(0.5 * branch[d]);
    links.tangential[lane] = static_cast<float>(k.tangential / units_.stiffness);
    links.stretch[lane] = static_cast<float>((k.normal - k.tangential) / units_.stiffness / square);
    links.bending[lane] = static_cast<float>(k.bending / moment_stiffness());
    links.twist[lane] = static_cast<float>((k.torsion - k.bending) / moment_stiffness() / square);
  }

  std::size_t bytes() const {
    return ties_.size() * sizeof(Tie) + begin_.size() * sizeof(begin_[0]) + ends_.size() * sizeof(End);
  }

private:
  struct Tie {
    float branch[3]; ///< from the end of lower number
    float weight;    ///< against slip; not_stiff where the bond resists nothing
  };

  /// Also the bonds' ties.
  void find_units(core::ThreadPool& pool) {
    struct Sums {
      double length = 0, stiffness = 0, count = 0;
      Sums& operator+=(const Sums& other) {
        length += other.length;
        stiffness += other.stiffness;
        count += other.count;
        return *this;
      }
    };
    const Sums sums =
        core::parallel_sum(pool, forces_.bond_count(), Sums{}, [&](std::size_t begin, std::size_t end) {
          Sums sum;
          for (std::size_t b = begin; b < end; ++b) {
            const auto& k = forces_.stiffness(b);
            if (!is_stiff(k))
              continue;
            sum.length += forces_.length(b);
            sum.stiffness += k.normal;
            sum.count += 1;
          }
          return sum;
        });
    if (sums.count > 0)
      units_.length = sums.length / sums.count;
    if (sums.stiffness > 0)
      units_.stiffness = sums.stiffness / sums.count;
    core::parallel_for(pool, ties_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        const auto& k = forces_.stiffness(b);
        const auto [i, j] = forces_.ends(b);
        const Vec3 branch = ((i < j ? 1 : -1) * forces_.length(b) / units_.length) * forces_.direction(b);
        for (int d = 0; d < 3; ++d)
          ties_[b].branch[d] = static_cast<float>(branch[d]);
        ties_[b].weight =
            is_stiff(k) ? static_cast<float>((k.normal + 2 * k.tangential) / units_.stiffness) : not_stiff;
      }
    });
  }

  void list_ends() {
    begin_.assign(forces_.particle_count() + 1, 0);
    for (Number b = 0; b < ties_.size(); ++b)
      if (ties_[b].weight >= 0) {
        const auto [i, j] = forces_.ends(b);
        ++begin_[i + std::size_t{1}];
        ++begin_[j + std::size_t{1}];
      }
    for (std::size_t i = 1; i < begin_.size(); ++i)
      begin_[i] += begin_[i - 1];
    ends_.resize(begin_.back());
    for (Number b = static_cast<Number>(ties_.size());
         b-- > 0;) // from the last, so that begin_ ends up right
      if (ties_[b].weight >= 0) {
        const auto [i, j] = forces_.ends(b);
        ends_[--begin_[i + std::size_t{1}]] = {j, b};
        ends_[--begin_[j + std::size_t{1}]] = {i, b};
      }
    begin_.erase(begin_.begin());
    begin_.push_back(ends_.size());
  }

  static constexpr float not_stiff = -1;

  const Forces& forces_;
  Units units_;
  LevelArray<Tie> ties_;             ///< [bonds]
  std::vector<std::uint64_t> begin_; ///< [particles + 1]
  LevelArray<End> ends_;             ///< [2 bonds that resist]
};

} // namespace cdem::integrate::detail
