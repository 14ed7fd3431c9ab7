#pragma once

/// @file
/// A network with the stiffness of each bond: internal forces, energy, loads of single bonds.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/detail/bond_block.hpp>
#include <cdem/bond/detail/bond_block_avx2.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace cdem::bond {

/// The bonds of one particle in increasing order, a range of BondIndex: those it is the second end of (a list), then
/// those it is the first end of (consecutive).
class BondsOfParticle {
public:
  class Iterator {
  public:
    using value_type = BondIndex;
    using difference_type = std::ptrdiff_t;
    using iterator_category = std::forward_iterator_tag;
    using pointer = const BondIndex*;
    using reference = BondIndex;

    Iterator() = default;
    BondIndex operator*() const { return listed_ != listed_end_ ? *listed_ : own_; }
    Iterator& operator++() {
      if (listed_ != listed_end_)
        ++listed_;
      else
        ++own_;
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    bool operator==(const Iterator&) const = default;

  private:
    friend BondsOfParticle;
    Iterator(const BondIndex* listed, const BondIndex* listed_end, BondIndex own)
        : listed_(listed), listed_end_(listed_end), own_(own) {}
    const BondIndex* listed_ = nullptr;
    const BondIndex* listed_end_ = nullptr;
    BondIndex own_ = 0;
  };

  BondsOfParticle(std::span<const BondIndex> listed, BondIndex own_begin, BondIndex own_end)
      : listed_(listed), own_begin_(own_begin), own_end_(own_end) {}

  Iterator begin() const { return {listed_.data(), listed_.data() + listed_.size(), own_begin_}; }
  Iterator end() const {
    return {listed_.data() + listed_.size(), listed_.data() + listed_.size(), own_end_};
  }
  /// Number of bonds.
  std::size_t size() const { return listed_.size() + (own_end_ - own_begin_); }
  bool empty() const { return size() == 0; }

private:
  std::span<const BondIndex> listed_;
  BondIndex own_begin_, own_end_;
};

/// Internal forces f = -K u of a bonded body in small motion, matrix-free.
///
/// The stiffness of every bond is computed once, from any BondLaw. Forces are summed in double precision, block by
/// block of consecutive particles, so that results are bitwise the same for any number of threads. Order the
/// particles in space first (particles::space_filling_order): a block's bonds then stay mostly inside it.
/// @tparam GeometryReal  what a bond's geometry and stiffness are stored in. float halves the memory of a bond and
///                       changes each by 6e-8 of itself: K stays symmetric and the forces of a bond opposite, but a
///                       rigid rotation th gives forces of 6e-8 K_t L th instead of rounding errors in double
template <class GeometryReal = double>
class BasicLinearForces {
public:
  /// @throws core::InvalidInput for particles, a network or phases that do not fit together, bonds that are not
  ///         sorted as BondNetwork says, or a law that returns a stiffness that is negative or not finite (names the
  ///         bond)
  /// @complexity O(bonds); 64 bytes a bond (float: 32) and about 16 for the lists, 16 bytes a particle
  template <BondLaw Law>
  BasicLinearForces(const Law& law, const particles::ParticleSet& particles,
                    const network::BondNetwork& network)
      : first_(network.first), bonds_begin_(particles.size() + 1, 0), listed_begin_(particles.size() + 1, 0) {
    particles.validate();
    network.validate();
    core::expect(network.particle_count == particles.size(), "particle_count of the network",
                 network.particle_count,
                 "the number of particles, " + std::to_string(particles.size()) + ", is expected");
    law.validate(particles);
    records_.reserve(network.size());
    for (BondIndex b = 0; b < network.size(); ++b) {
      expect_sorted(network, b);
      const BondGeometry geometry = geometry_of(b, particles, network);
      const ChannelStiffness stiffness = law.stiffness(geometry);
      for (const double k : {stiffness.normal, stiffness.tangential, stiffness.torsion, stiffness.bending})
        core::expect_not_negative(k, "a stiffness of bond " + std::to_string(b));
      records_.emplace_back(geometry, stiffness, network.second[b]);
      expect_representable(records_.back(), b);
    }
    list_bonds();
    list_incoming();
  }

  std::size_t particle_count() const noexcept { return bonds_begin_.size() - 1; }
  std::size_t bond_count() const noexcept { return records_.size(); }

  /// Internal forces, f = -K u.
  ///
  /// @param displacement  [particles] m, rad
  /// @param force         [particles] N, N m, overwritten
  /// @complexity          O(bonds), no allocation; a bond between two blocks is computed twice
  void evaluate(const particles::SpatialField<>& displacement, particles::SpatialField<>& force,
                core::ThreadPool& pool) const {
    pool.for_each_block(block_count(), [&](std::size_t number) {
      const Block block = this->block(number);
      std::fill(force.begin() + block.begin, force.begin() + block.end, particles::Spatial<>{});
      add_forces(block, displacement.data(), force.data() + block.begin);
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
    std::vector<Sum> partial(block_count(), zero);
    pool.for_each_block(block_count(), [&](std::size_t number) {
      particles::Spatial<> force[block_size]; // zero
      const Block block = this->block(number);
      add_forces(block, displacement.data(), force);
      partial[number] = use(std::size_t{block.begin}, std::size_t{block.end},
                            static_cast<const particles::Spatial<>*>(force));
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
        sum += energy_of(stiffness(b), direction(b), deformation(b, displacement));
      return sum;
    });
  }

  /// Force and moments of one bond. @complexity O(1)
  BondLoad load(BondIndex b, const particles::SpatialField<>& displacement) const {
    const auto [force, couple, moment] =
        detail::action_of(records_[b], displacement[first_[b]], displacement[records_[b].second]);
    return {force, couple + moment, couple - moment};
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

  /// The 6x6 block of K that couples particle i with itself (rows and columns: x, y, z, about x, y, z).
  ///
  ///     translation: K_n nn + K_t (1 - nn)                rotation: S_n nn + (E_mu I/L + K_t L^2/4)(1 - nn)
  ///     coupling:    -K_t (L/2) [n]x on the first end, +K_t (L/2) [n]x on the second
  Eigen::Matrix<double, 6, 6> diagonal_block(ParticleIndex i) const {
    Eigen::Matrix<double, 6, 6> block = Eigen::Matrix<double, 6, 6>::Zero();
    for (const BondIndex b : bonds_of(i)) {
      const Vec3 n = direction(b);
      const Mat3 along = n * n.transpose(), across = Mat3::Identity() - along;
      const ChannelStiffness k = stiffness(b);
      const double arm = 0.5 * length(b);
      Mat3 cross;
      cross << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
      const Mat3 coupling = (first_[b] == i ? -1 : 1) * k.tangential * arm * cross;
      block.topLeftCorner<3, 3>() += k.normal * along + k.tangential * across;
      block.bottomRightCorner<3, 3>() += k.torsion * along + (k.bending + k.tangential * arm * arm) * across;
      block.topRightCorner<3, 3>() += coupling;
      block.bottomLeftCorner<3, 3>() += coupling.transpose();
    }
    return block;
  }

  /// Stiffness of one bond, as it is stored: what the law gave, to the rounding of GeometryReal.
  ChannelStiffness stiffness(BondIndex b) const {
    const auto& bond = records_[b];
    const double square = bond.arm().squaredNorm();
    const double tangential = bond.tangential, bending = bond.bending;
    // what is left of a stiffness of 0 beside a large one is rounding, and may be below 0
    return {.normal = std::max(0.0, tangential + bond.stretch * square),
            .tangential = tangential,
            .torsion = std::max(0.0, bending + bond.twist * square),
            .bending = bending};
  }
  /// Unit vector of one bond, from its first particle to its second.
  Vec3 direction(BondIndex b) const { return records_[b].arm().normalized(); }
  /// Length of one bond at rest, m.
  double length(BondIndex b) const { return 2 * records_[b].arm().norm(); }
  /// The two particles of one bond.
  std::pair<ParticleIndex, ParticleIndex> ends(BondIndex b) const { return {first_[b], records_[b].second}; }
  /// The bonds of particle i, in increasing order.
  BondsOfParticle bonds_of(ParticleIndex i) const {
    return {{listed_.data() + listed_begin_[i], listed_.data() + listed_begin_[i + 1]},
            bonds_begin_[i],
            bonds_begin_[i + 1]};
  }

  /// Bytes held for this body's bonds.
  std::size_t memory() const noexcept {
    const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return bytes(records_) + bytes(first_) + bytes(bonds_begin_) + bytes(listed_) + bytes(listed_begin_) +
           bytes(incoming_) + bytes(incoming_begin_);
  }

private:
  using Record = detail::BondRecord<GeometryReal>;
  using Block = detail::BondBlock<GeometryReal>;

  /// Particles of one block: their forces (64 bytes each) stay in the cache next to a core.
  static constexpr std::size_t block_size = 1024;

  static void expect_sorted(const network::BondNetwork& network, BondIndex b) {
    const std::string expected =
        "bonds sorted by their first particle, which has the lower number, are expected";
    core::expect(network.first[b] < network.second[b], "first particle of bond " + std::to_string(b),
                 network.first[b], expected);
    core::expect(b == 0 || network.first[b - 1] <= network.first[b],
                 "first particle of bond " + std::to_string(b), network.first[b], expected);
  }

  static void expect_representable(const Record& bond, BondIndex b) {
    for (const GeometryReal value : {bond.tangential, bond.stretch, bond.twist, bond.bending})
      core::expect(std::isfinite(value),
                   "a stiffness of bond " + std::to_string(b) + " over its length squared", value,
                   "at most " + core::to_text(std::numeric_limits<GeometryReal>::max()) + " can be stored");
  }

  /// Where each particle's bonds begin, and the list of those it is the second end of.
  void list_bonds() {
    for (BondIndex b = 0; b < bond_count(); ++b) {
      ++bonds_begin_[first_[b] + std::size_t{1}];
      ++listed_begin_[records_[b].second + std::size_t{1}];
    }
    for (std::size_t i = 0; i < particle_count(); ++i) {
      bonds_begin_[i + 1] += bonds_begin_[i];
      listed_begin_[i + 1] += listed_begin_[i];
    }
    listed_.resize(bond_count());
    std::vector<BondIndex> next(listed_begin_.begin(), listed_begin_.end() - 1);
    for (BondIndex b = 0; b < bond_count(); ++b)
      listed_[next[records_[b].second]++] = b;
  }

  /// The bonds that come into each block from another.
  void list_incoming() {
    incoming_begin_.assign(block_count() + 1, 0);
    for (std::size_t number = 0; number < block_count(); ++number) {
      const std::size_t begin = number * block_size, end = std::min(begin + block_size, particle_count());
      for (BondIndex k = listed_begin_[begin]; k < listed_begin_[end]; ++k)
        if (const BondIndex b = listed_[k]; first_[b] < begin)
          incoming_.push_back({b, first_[b]});
      incoming_begin_[number + 1] = incoming_.size();
    }
    incoming_.shrink_to_fit();
  }

  std::size_t block_count() const noexcept { return (particle_count() + block_size - 1) / block_size; }

  Block block(std::size_t number) const {
    const std::size_t begin = number * block_size, end = std::min(begin + block_size, particle_count());
    return {.records = records_.data(),
            .bonds_begin = bonds_begin_.data(),
            .incoming = incoming_.data() + incoming_begin_[number],
            .incoming_count = incoming_begin_[number + 1] - incoming_begin_[number],
            .begin = static_cast<ParticleIndex>(begin),
            .end = static_cast<ParticleIndex>(end)};
  }

  static void add_forces(const Block& block, const particles::Spatial<>* displacement,
                         particles::Spatial<>* force) {
#if defined(__x86_64__) && defined(__GNUC__)
    if (detail::has_avx2())
      return detail::Avx2::add_forces(block, displacement, force);
#endif
    detail::add_forces(block, displacement, force);
  }

  BondDeformation deformation(BondIndex b, const particles::SpatialField<>& displacement) const {
    return detail::deformation_of(records_[b], displacement[first_[b]], displacement[records_[b].second]);
  }

  std::vector<Record, particles::CacheAlignedAllocator<Record>> records_; ///< [bonds]
  std::vector<ParticleIndex> first_;                                      ///< [bonds]
  std::vector<BondIndex> bonds_begin_;  ///< [particles + 1] where each particle's bonds as first end begin
  std::vector<BondIndex> listed_begin_; ///< [particles + 1] where each particle's bonds in `listed_` begin
  std::vector<BondIndex> listed_;       ///< [bonds] by their second end
  std::vector<detail::IncomingBond> incoming_; ///< of each block
  std::vector<std::size_t> incoming_begin_;    ///< [blocks + 1]
};

/// In double precision throughout.
using LinearForces = BasicLinearForces<double>;
/// Forces in double precision from bonds stored in float, for the largest bodies.
using CompactLinearForces = BasicLinearForces<float>;

} // namespace cdem::bond
