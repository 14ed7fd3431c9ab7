#pragma once

/// @file
/// A network with the stiffness of each bond: internal forces, energy, loads of single bonds.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/detail/blocked_bonds.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace cdem::bond {

/// Internal forces f = -K u of a bonded body in small motion, matrix-free.
///
/// The stiffness of every bond is computed once, from any BondLaw. Forces are summed in double precision, block by
/// block of consecutive particles, so that results are bitwise the same for any number of threads. Order the
/// particles in space first (particles::space_filling_order): a block's bonds then stay mostly inside it.
/// @tparam StiffnessReal  what a bond's stiffnesses are stored in. float saves a quarter of a bond's memory and changes
///                        each stiffness by 6e-8 of itself; K stays symmetric, the forces of a bond opposite, and rigid
///                        motions give no more than rounding errors in double, as the geometry is kept in double
template <class StiffnessReal = double>
class BasicLinearForces {
public:
  /// @throws core::InvalidInput for particles, a network or phases that do not fit together, bonds that are not
  ///         sorted as BondNetwork says, or a law that returns a stiffness that is negative or not finite (names the
  ///         bond)
  /// @complexity O(bonds); at Z = 6.2 in space-filling order 79 bytes a bond (float: 61), lists included
  template <BondLaw Law>
  requires GivesChannelStiffness<Law> BasicLinearForces(const Law& law,
                                                        const particles::ParticleSet& particles,
                                                        const network::BondNetwork& network)
      : bonds_(checked(law, particles, network).size(), network.first, network.second, [&](BondIndex b) {
          const BondGeometry geometry = geometry_of(b, particles, network);
          const ChannelStiffness stiffness = law.stiffness(geometry);
          for (const double k :
               {stiffness.normal, stiffness.tangential, stiffness.torsion, stiffness.bending})
            if (!(k >= 0 && std::isfinite(k))) [[unlikely]]
              core::expect_not_negative(k, "a stiffness of bond " + std::to_string(b));
          const auto record =
              detail::BondRecord::of(geometry, stiffness, network.first[b], network.second[b]);
          expect_representable(record, b);
          return record;
        }) {}

  std::size_t particle_count() const noexcept { return bonds_.particle_count(); }
  std::size_t bond_count() const noexcept { return bonds_.bond_count(); }

  /// Internal forces, f = -K u.
  ///
  /// @param displacement  [particles] m, rad
  /// @param force         [particles] N, N m, overwritten
  /// @complexity          O(bonds), no allocation; a bond between two blocks is computed twice
  void evaluate(const particles::SpatialField<>& displacement, particles::SpatialField<>& force,
                core::ThreadPool& pool) const {
    force.resize(particle_count());
    pool.for_each_block(bonds_.block_count(), [&](std::size_t number) {
      const auto block = bonds_.block(number);
      particles::Spatial<>* const own = force.data() + block.begin;
      std::fill(own, own + block.size, particles::Spatial<>{});
      detail::add_forces(block, displacement.data(), own);
    });
  }

  /// Internal forces handed on block by block, while they are in the cache: what an explicit step needs of them.
  ///
  /// @param displacement  [particles] m, rad
  /// @param zero          where the sum begins
  /// @param use           Sum(begin, end, force): takes the forces [end - begin] (N, N m) of particles begin to
  ///                      end; called once for each block, from several threads at once
  /// @return              sum of what `use` returned, in block order: the same bits for any number of threads
  /// @complexity          as evaluate(); one sum a block is allocated
  template <class Sum, class Use>
  Sum evaluate_blockwise(const particles::SpatialField<>& displacement, Sum zero, core::ThreadPool& pool,
                         Use&& use) const {
    std::vector<Sum> partial(bonds_.block_count(), zero);
    pool.for_each_block(bonds_.block_count(), [&](std::size_t number) {
      particles::Spatial<> force[Bonds::block_size]; // zero
      const auto block = bonds_.block(number);
      detail::add_forces(block, displacement.data(), force);
      const std::size_t begin = block.begin;
      partial[number] = use(begin, begin + block.size, static_cast<const particles::Spatial<>*>(force));
    });
    for (const Sum& sum : partial)
      zero += sum;
    return zero;
  }

  /// Elastic energy u.K u / 2, J. @complexity O(bonds)
  double elastic_energy(const particles::SpatialField<>& displacement, core::ThreadPool& pool) const {
    return core::parallel_sum(pool, bond_count(), 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t b = begin; b < end; ++b)
        sum += energy_of(b, displacement);
      return sum;
    });
  }

  /// Force and moments of one bond. @complexity O(1)
  BondLoad load(BondIndex b, const particles::SpatialField<>& displacement) const {
    const detail::BondRecord bond = bonds_.bond(b);
    return bond.load(displacement[bond.first], displacement[bond.second]);
  }

  /// Forces on the first particle of every bond, what a stress estimator reads.
  ///
  /// @param forces  [bonds] N, overwritten
  void bond_forces(const particles::SpatialField<>& displacement, std::vector<Vec3>& forces,
                   core::ThreadPool& pool) const {
    forces.resize(bond_count());
    core::parallel_for(pool, bond_count(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        forces[b] = load(b, displacement).force;
    });
  }

  /// Moments in the middle of every bond, on its first particle's side: what a couple stress is made of.
  ///
  /// @param moments  [bonds] N m, overwritten
  void bond_moments(const particles::SpatialField<>& displacement, std::vector<Vec3>& moments,
                    core::ThreadPool& pool) const {
    moments.resize(bond_count());
    core::parallel_for(pool, bond_count(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        moments[b] = load(b, displacement).middle_moment();
    });
  }

  /// The 6x6 block of K that couples particle i with itself (rows and columns: x, y, z, about x, y, z).
  ///
  ///     translation: K_n nn + K_t (1 - nn)                rotation: S_n nn + (E_mu I/L + K_t L^2/4)(1 - nn)
  ///     coupling:    -K_t (L/2) [n]x on the first end, +K_t (L/2) [n]x on the second
  Eigen::Matrix<double, 6, 6> diagonal_block(ParticleIndex i) const {
    Eigen::Matrix<double, 6, 6> block = Eigen::Matrix<double, 6, 6>::Zero();
    for (const BondIndex b : bonds_of(i)) {
      const detail::BondRecord bond = bonds_.bond(b);
      const double arm = bond.half_branch.norm();
      const Vec3 n = bond.half_branch / arm;
      const Mat3 along = n * n.transpose(), across = Mat3::Identity() - along;
      const ChannelStiffness k = bond.stiffness();
      Mat3 cross;
      cross << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
      const Mat3 coupling = (bond.first == i ? -1 : 1) * k.tangential * arm * cross;
      block.topLeftCorner<3, 3>() += k.normal * along + k.tangential * across;
      block.bottomRightCorner<3, 3>() += k.torsion * along + (k.bending + k.tangential * arm * arm) * across;
      block.topRightCorner<3, 3>() += coupling;
      block.bottomLeftCorner<3, 3>() += coupling.transpose();
    }
    return block;
  }

  /// Stiffness of one bond, as it is stored: what the law gave, to the rounding of StiffnessReal.
  ChannelStiffness stiffness(BondIndex b) const { return bonds_.bond(b).stiffness(); }
  /// Unit vector of one bond, from its first particle to its second.
  Vec3 direction(BondIndex b) const { return bonds_.bond(b).half_branch.normalized(); }
  /// Length of one bond at rest, m.
  double length(BondIndex b) const { return 2 * bonds_.bond(b).half_branch.norm(); }
  /// The two particles of one bond.
  std::pair<ParticleIndex, ParticleIndex> ends(BondIndex b) const {
    const detail::BondRecord bond = bonds_.bond(b);
    return {bond.first, bond.second};
  }
  /// The bonds of particle i, in increasing order.
  BondsOfParticle bonds_of(ParticleIndex i) const { return bonds_.bonds_of(i); }

  /// Bytes held for this body's bonds.
  std::size_t memory() const noexcept { return bonds_.memory(); }

private:
  using Bonds = detail::BlockedBonds<StiffnessReal>;

  /// @return  the particles, once all is found to fit together
  template <class Law>
  static const particles::ParticleSet& checked(const Law& law, const particles::ParticleSet& particles,
                                               const network::BondNetwork& network) {
    particles.validate();
    network.validate();
    core::expect(network.particle_count == particles.size(), "particle_count of the network",
                 network.particle_count,
                 "the number of particles, " + std::to_string(particles.size()) + ", is expected");
    law.validate(particles);
    for (BondIndex b = 0; b < network.size(); ++b)
      if (network.first[b] >= network.second[b] || (b > 0 && network.first[b - 1] > network.first[b]))
        core::reject("first particle of bond " + std::to_string(b), network.first[b],
                     "bonds sorted by their first particle, which has the lower number, are expected");
    return particles;
  }

  static void expect_representable(const detail::BondRecord& bond, BondIndex b) {
    for (const double value : {bond.tangential, bond.stretch, bond.twist, bond.bending})
      if (!std::isfinite(static_cast<StiffnessReal>(value)))
        core::reject("a stiffness of bond " + std::to_string(b) + " over its length squared", value,
                     "at most " + core::to_text(std::numeric_limits<StiffnessReal>::max()) +
                         " can be stored");
  }

  double energy_of(BondIndex b, const particles::SpatialField<>& displacement) const {
    const detail::BondRecord bond = bonds_.bond(b);
    return bond::energy_of(bond.stiffness(), bond.half_branch.normalized(),
                           bond.deformation(displacement[bond.first], displacement[bond.second]));
  }

  Bonds bonds_;
};

/// In double precision throughout.
using LinearForces = BasicLinearForces<double>;
/// In double precision but for the stored stiffnesses, for the largest bodies.
using CompactLinearForces = BasicLinearForces<float>;

} // namespace cdem::bond
