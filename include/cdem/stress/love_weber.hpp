#pragma once

/// @file
/// Love–Weber stress of the specimens of a tessellation.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/geometry/segment.hpp>
#include <cdem/stress/bond_loads.hpp>
#include <cdem/stress/stress_estimator.hpp>
#include <cdem/stress/tessellation/hexahedra.hpp>
#include <cdem/stress/tessellation/tessellation.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace cdem::stress {

/// To which specimens a bond contributes.
enum class Sharing : std::uint8_t {
  /// To each that its branch crosses, in proportion to the length inside.
  /// @deviation [L17] counts a contact in the specimen that holds it; see by_midpoint.
  by_length,
  /// To the one that holds the contact point, as in [L17] section 2.5. The contact point is the middle of the gap
  /// between the two spheres: on the branch, at R_first + (|d| - R_first - R_second)/2 from the first centre.
  by_midpoint
};

/// What is done with a body of which something lies outside the specimens.
enum class Outside : std::uint8_t {
  refuse, ///< throws: the tessellation is meant to cover the body
  report  ///< sums it up in StressField::outside: the tessellation is a window on the body
};

/// Choices of LoveWeber.
struct LoveWeberParameters {
  Sharing sharing = Sharing::by_length;
  Outside outside = Outside::refuse;
};

/// Love–Weber stress, averaged over each specimen.
///
/// sigma = (1/V) sum over bonds of f (x) d          [L17] section 2.5; Love 1927; Weber 1966
///
/// f is the force on the bond's first particle, d the branch from the first to the second: a bond in tension
/// pulls its first particle along d, so tension is positive. The tensor is not symmetrised: bonds that carry
/// moments make it unsymmetric locally. With Sharing::by_length the sum of V sigma over the specimens, plus
/// what is outside, is the sum of f (x) d over the bonds, whatever the tessellation. A branch that leaves
/// through a periodic face re-enters through the opposite one.
///
/// With moments also the couple stress, mu = (1/V) sum over bonds of (integral of T(s) ds over the piece inside) (x) d: the
/// moment T that a bond transfers (see BondLoads) is linear along it, so a piece has that of its middle times its length.
///
/// Positions and branches are those at rest (small displacements), so the stress is linear in the forces: the
/// stress of the forces averaged over time is the average of the stresses.
template <tessellation::Tessellation Cells = tessellation::Hexahedra>
class LoveWeber {
public:
  using Parameters = LoveWeberParameters;

  /// @throws core::InvalidInput for a tessellation without cells, of 2^32 - 1 cells or more, or a cell whose
  ///         volume is not a finite positive number
  explicit LoveWeber(Cells cells, Parameters parameters = {})
      : cells_(std::move(cells)), parameters_(parameters) {
    core::expect(cells_.cell_count() >= 1 && cells_.cell_count() < std::numeric_limits<std::uint32_t>::max(),
                 "number of specimens", cells_.cell_count(), "1 to 2^32 - 2 is expected");
    for (std::size_t cell = 0; cell < cells_.cell_count(); ++cell)
      if (const double volume = cells_.volume(cell); !(std::isfinite(volume) && volume > 0))
        core::reject("volume of specimen " + std::to_string(cell), volume,
                     "a finite number above 0 m^3 is expected");
  }

  const Cells& cells() const noexcept { return cells_; }
  const Parameters& parameters() const noexcept { return parameters_; }

  /// Stress of each specimen from the forces of the bonds, on one thread.
  ///
  /// @param particles  positions at rest; radii are read by Sharing::by_midpoint
  /// @param network    bonds and branches at rest
  /// @param loads      [bonds] forces, N, on the bond's first particle; moments, N m, or none
  /// @return           [specimens] Pa, tension positive, not symmetrised
  /// @throws core::InvalidInput for a bad particle or bond, a number of loads other than the bonds', a load
  ///         that is not finite, and with Outside::refuse a centre or a part of a branch outside the specimens
  /// @complexity       O(particles + pieces of branches); about 4 MB of working memory beside the result
  StressField estimate(const particles::ParticleSet& particles, const network::BondNetwork& network,
                       const BondLoads& loads) const {
    core::ThreadPool one_thread;
    return estimate(particles, network, loads, one_thread);
  }

  /// The same on the threads of `pool`: every specimen sums its bonds in their order, so the bytes are the
  /// same for any number of threads.
  StressField estimate(const particles::ParticleSet& particles, const network::BondNetwork& network,
                       const BondLoads& loads, core::ThreadPool& pool) const {
    particles.validate();
    detail::expect_matching_sizes(particles, network, loads);

    const std::size_t count = cells_.cell_count();
    StressField field;
    field.particles = count_particles(particles, pool);
    field.stress.assign(count + 1, Mat3::Zero());
    field.couple_stress.assign(loads.has_moments() ? count + 1 : 0, Mat3::Zero());
    add_moments(particles, network, loads, field, pool);
    field.volume.resize(count);
    for (std::size_t cell = 0; cell < count; ++cell) {
      field.volume[cell] = cells_.volume(cell);
      field.stress[cell] /= field.volume[cell];
      if (loads.has_moments())
        field.couple_stress[cell] /= field.volume[cell];
    }
    field.outside = field.stress.back();
    field.stress.pop_back();
    if (loads.has_moments()) {
      field.outside_couple = field.couple_stress.back();
      field.couple_stress.pop_back();
    }
    return field;
  }

private:
  /// Part of a bond in a cell; the cell that follows the last stands for the outside.
  struct Share {
    double fraction;
    double middle; ///< part of the branch at which the piece has its middle: where its mean moment is
    std::uint32_t cell;
    std::uint32_t bond; ///< counted from the first of the round
  };

  static constexpr std::size_t blocks_per_round = 64;
  static constexpr std::size_t bonds_per_round = blocks_per_round * core::block_size;

  /// [cells] number of centres in each.
  std::vector<std::uint32_t> count_particles(const particles::ParticleSet& particles,
                                             core::ThreadPool& pool) const {
    const auto outside = static_cast<std::uint32_t>(cells_.cell_count());
    std::vector<std::uint32_t> cell_of(particles.size());
    core::parallel_for(pool, particles.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::optional<std::size_t> cell = cells_.locate(particles.position[i]);
        if (!cell && parameters_.outside == Outside::refuse) [[unlikely]]
          core::reject(
              "position of particle " + std::to_string(i), detail::text_of(particles.position[i]),
              "a point inside the tessellation is expected (or the parameter outside = Outside::report)");
        cell_of[i] = cell ? static_cast<std::uint32_t>(*cell) : outside;
      }
    });
    std::vector<std::uint32_t> centres(cells_.cell_count() + 1, 0);
    for (const std::uint32_t cell : cell_of)
      ++centres[cell];
    centres.pop_back();
    return centres;
  }

  /// Adds f (x) d, N m, and T (x) d, N m^2, of each cell and, last, of the outside.
  ///
  /// Bonds are taken in rounds, which bounds the memory. In a round, blocks of bonds first list their shares;
  /// then every thread adds up those of its own cells, in the order of the bonds.
  void add_moments(const particles::ParticleSet& particles, const network::BondNetwork& network,
                   const BondLoads& loads, StressField& field, core::ThreadPool& pool) const {
    std::vector<std::vector<Share>> shares(blocks_per_round);
    for (std::size_t round = 0; round < network.size(); round += bonds_per_round) {
      pool.for_each_block(blocks_per_round, [&](std::size_t block) {
        shares[block].clear();
        const std::size_t begin = std::min(network.size(), round + block * core::block_size);
        const std::size_t end = std::min(network.size(), begin + core::block_size);
        for (std::size_t bond = begin; bond < end; ++bond) {
          detail::expect_sound(network, loads, bond);
          list_shares(particles, network, bond, static_cast<std::uint32_t>(bond - round), shares[block]);
        }
      });
      const auto owners = static_cast<std::uint32_t>(pool.size());
      pool.for_each_block(owners, [&](std::size_t owner) {
        for (const std::vector<Share>& list : shares)
          for (const Share& share : list)
            if (owner_of(share.cell, owners) == owner) {
              const std::size_t bond = round + share.bond;
              const Vec3& branch = network.branch[bond];
              field.stress[share.cell].noalias() +=
                  (share.fraction * loads.forces[bond]) * branch.transpose();
              if (loads.has_moments())
                field.couple_stress[share.cell].noalias() +=
                    (share.fraction * loads.moment_at(bond, branch, share.middle)) * branch.transpose();
            }
      });
    }
  }

  /// Thread that sums a cell: runs of eight cells, so that threads seldom write to one cache line.
  static std::uint32_t owner_of(std::uint32_t cell, std::uint32_t owners) {
    return owners == 1 ? 0 : cell / 8 % owners;
  }

  void list_shares(const particles::ParticleSet& particles, const network::BondNetwork& network,
                   std::size_t bond, std::uint32_t number, std::vector<Share>& list) const {
    const geometry::Segment branch{particles.position[network.first[bond]], network.branch[bond]};
    const std::size_t before = list.size();
    double outside = 0;
    if (parameters_.sharing == Sharing::by_length) {
      outside = cells_.for_each_piece(branch, [&](std::size_t cell, double begin, double end) {
        list.push_back({end - begin, 0.5 * (begin + end), static_cast<std::uint32_t>(cell), number});
      });
    } else {
      const double contact = contact_place(particles, network, bond);
      if (const auto cell = cells_.locate(branch.at(contact)))
        list.push_back({1, contact, static_cast<std::uint32_t>(*cell), number});
      else
        outside = 1;
    }
    if (outside > 0) [[unlikely]] {
      if (parameters_.outside == Outside::refuse)
        core::reject("part outside the tessellation of bond " + std::to_string(bond), outside,
                     "0 is expected: is the box periodic where the bonds are (or is Outside::report meant)?");
      double first_moment = 0.5; // of the whole branch; less that of the pieces inside
      for (std::size_t k = before; k < list.size(); ++k)
        first_moment -= list[k].fraction * list[k].middle;
      if (parameters_.sharing == Sharing::by_midpoint)
        first_moment = contact_place(particles, network, bond);
      list.push_back(
          {outside, first_moment / outside, static_cast<std::uint32_t>(cells_.cell_count()), number});
    }
  }

  /// Part of the branch at the middle of the gap between the two spheres; 0 or 1 if one sphere lies within the other.
  static double contact_place(const particles::ParticleSet& particles, const network::BondNetwork& network,
                              std::size_t bond) {
    const double difference = particles.radius[network.first[bond]] - particles.radius[network.second[bond]];
    return std::clamp(0.5 + 0.5 * difference / network.branch[bond].norm(), 0.0, 1.0);
  }

  Cells cells_;
  Parameters parameters_;
};

static_assert(StressEstimator<LoveWeber<>> && EstimatesCoupleStress<LoveWeber<>>);

} // namespace cdem::stress
