#pragma once

/// @file
/// Internal forces of a bonded body under a law of any kind.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/bond_tangent.hpp>
#include <cdem/bond/detail/bond_lanes.hpp>
#include <cdem/bond/response.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace cdem::bond {

namespace detail {
inline Deformation<> deformation_from(const double* d) {
  return {d[0], {d[1], d[2]}, d[3], {d[4], d[5]}};
}
inline void write(double* to, const ChannelLoad<>& f) {
  to[0] = f.normal, to[1] = f.tangential.t, to[2] = f.tangential.b;
  to[3] = f.torsion, to[4] = f.bending.t, to[5] = f.bending.b;
}
inline Vec3 vec(const Components<double>& c) {
  return {c.x, c.y, c.z};
}
inline Components<double> components(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
} // namespace detail

/// Internal forces of a body under any BondLaw: linear, force or energy law, with or without a memory, in small motion
/// or with finite rotations.
///
/// What the body remembers is that of the last advance(): the state of each bond and, with finite rotations, the
/// orientation of each particle. evaluate() tries a displacement from there and changes nothing; advance() accepts it.
/// An explicit integrator advances at every step; a static solver tries, and the caller advances to the equilibrium
/// found. The rotation in a displacement is the sum of its increments: between two advances a particle turns by the
/// rotation vector of the difference.
///
/// Sums are formed block by block of consecutive particles: bitwise the same for any number of threads. Order the
/// particles in space first (particles::space_filling_order). LinearForces is some twice as fast for laws with
/// four linear channels.
template <BondLaw Law>
class BondForces {
  using Field = particles::SpatialField<>;
  using Prepared = typename Response<Law>::Prepared;

public:
  using State = StateOf<Law>;
  static constexpr bool finite_rotation = TurnsWithItsEnds<Law>;
  static constexpr bool has_state = HasState<Law>;

  /// All that a body remembers beside its motion: what a checkpoint keeps.
  struct Memory {
    std::vector<State> state; ///< [bonds]; empty without one
    Field displacement;       ///< [particles] at the last advance(); at rest before the first
    std::vector<detail::Rotation> orientation; ///< [particles]; empty in small motion
    double dissipated = 0;                     ///< J
  };

  /// @throws core::InvalidInput for particles, a network or phases that do not fit together, bonds that are not sorted as
  ///         BondNetwork says, or a stiffness that is not accepted (names the bond)
  /// @complexity O(bonds)
  BondForces(const Law& law, const particles::ParticleSet& particles, const network::BondNetwork& network)
      : law_(law), ends_(checked_ends(law, particles, network)) {
    rest_.reserve(network.size());
    prepared_.reserve(network.size());
    for (BondIndex b = 0; b < network.size(); ++b) {
      const BondGeometry geometry = geometry_of(b, particles, network);
      rest_.push_back({geometry.direction, geometry.length});
      prepared_.push_back(Response<Law>::prepare(law_, geometry));
      if constexpr (GivesChannelStiffness<Law>)
        expect_stiffness(prepared_.back(), b);
    }
    if constexpr (has_state) {
      memory_.state.resize(network.size());
      next_state_.resize(network.size());
    }
    if constexpr (has_state || finite_rotation)
      memory_.displacement.resize(particles.size());
    if constexpr (finite_rotation)
      memory_.orientation.resize(particles.size());
  }

  std::size_t particle_count() const noexcept { return ends_->particle_count(); }
  std::size_t bond_count() const noexcept { return ends_->bond_count(); }
  const Law& law() const noexcept { return law_; }

  /// Internal forces at a displacement tried from the last advance().
  ///
  /// @param displacement  [particles] m, rad
  /// @param force         [particles] N, N m, overwritten
  /// @complexity          O(bonds); a bond between two blocks is computed twice
  void evaluate(const Field& displacement, Field& force, core::ThreadPool& pool) const {
    force.resize(particle_count());
    const std::vector<detail::Rotation> orientation = orientations(displacement, pool);
    pool.for_each_block(ends_->block_count(), [&](std::size_t block) {
      sum_block(block, source(displacement, orientation), force,
                [&](BondIndex b, const double(&deformation)[6], double(&load)[6]) {
                  const Deformation<> d = detail::deformation_from(deformation);
                  detail::write(load, Response<Law>::load(law_, prepared_[b], d, updated(b, d)));
                });
    });
  }

  /// Internal forces at a displacement that is accepted: states and orientations follow it, and what bonds lost whose
  /// state changed is booked, the path since the last advance (the first: from rest) taken straight and the load along it
  /// as the mean of its ends'. A bond whose state does not change is elastic.
  ///
  /// @complexity as evaluate()
  void advance(const Field& displacement, Field& force,
               core::ThreadPool& pool) requires(has_state || finite_rotation) {
    force.resize(particle_count());
    std::vector<detail::Rotation>& orientation = next_orientation_;
    orient(orientation, displacement, pool);
    std::vector<double> lost(ends_->block_count(), 0.0);
    pool.for_each_block(ends_->block_count(), [&](std::size_t block) {
      [[maybe_unused]] const std::size_t begin = ends_->block_begin(block);
      sum_block(block, source(displacement, orientation), force,
                [&](BondIndex b, const double(&deformation)[6], double(&channel)[6]) {
                  const Deformation<> d = detail::deformation_from(deformation);
                  const State state = updated(b, d);
                  const ChannelLoad<> load = Response<Law>::load(law_, prepared_[b], d, state);
                  detail::write(channel, load);
                  if constexpr (has_state)
                    if (ends_->first(b) >= begin) { // else the block before books it
                      next_state_[b] = state;
                      lost[block] += lost_by(b, d, load, state);
                    }
                });
    });
    if constexpr (has_state)
      memory_.state.swap(next_state_);
    for (const double sum : lost)
      memory_.dissipated += sum;
    if constexpr (finite_rotation)
      memory_.orientation.swap(orientation);
    core::parallel_for(pool, particle_count(), [&](std::size_t begin, std::size_t end) {
      std::copy(displacement.begin() + static_cast<std::ptrdiff_t>(begin),
                displacement.begin() + static_cast<std::ptrdiff_t>(end),
                memory_.displacement.begin() + static_cast<std::ptrdiff_t>(begin));
    });
  }

  /// Energy stored at a displacement tried from the last advance(), J. @complexity O(bonds)
  double elastic_energy(const Field& displacement, core::ThreadPool& pool) const {
    const std::vector<detail::Rotation> orientation = orientations(displacement, pool);
    return core::parallel_sum(pool, bond_count(), 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (BondIndex b = begin; b < end; ++b) {
        const Deformation<> deformation =
            detail::deformation_from(motion_of(b, displacement, orientation).deformation);
        sum += Response<Law>::energy(law_, prepared_[b], deformation, updated(b, deformation));
      }
      return sum;
    });
  }

  /// What the bonds lost since the beginning (broken, softened, slid), J: work done on them less what they store.
  double dissipated_energy() const noexcept requires has_state { return memory_.dissipated; }

  /// Force and moments of one bond at a displacement tried from the last advance(). @complexity O(1)
  BondLoad load(BondIndex b, const Field& displacement) const {
    const auto motion = motion_at(b, displacement);
    double channel[6];
    detail::write(channel, channel_load(b, detail::deformation_from(motion.deformation)));
    detail::EndLoads<double> ends;
    motion.on_ends(ends, channel);
    return {detail::vec(ends.force), detail::vec(ends.moment_first), detail::vec(ends.moment_second)};
  }

  /// Deformation of one bond at a displacement tried from the last advance(). @complexity O(1)
  Deformation<> deformation(BondIndex b, const Field& displacement) const {
    return detail::deformation_from(motion_at(b, displacement).deformation);
  }

  /// Forces on the first particle of every bond, what a stress estimator reads. @param forces [bonds] N, overwritten
  void bond_forces(const Field& displacement, std::vector<Vec3>& forces, core::ThreadPool& pool) const {
    forces.resize(bond_count());
    core::parallel_for(pool, bond_count(), [&](std::size_t begin, std::size_t end) {
      for (BondIndex b = begin; b < end; ++b)
        forces[b] = load(b, displacement).force;
    });
  }

  /// Moments in the middle of every bond, on its first particle's side: what a couple stress is made of.
  /// @param moments [bonds] N m, overwritten
  void bond_moments(const Field& displacement, std::vector<Vec3>& moments, core::ThreadPool& pool) const {
    moments.resize(bond_count());
    core::parallel_for(pool, bond_count(), [&](std::size_t begin, std::size_t end) {
      for (BondIndex b = begin; b < end; ++b)
        moments[b] = load(b, displacement).middle_moment();
    });
  }

  /// The 6x6 block of the stiffness at rest that couples particle i with itself, the bonds' states as they are.
  Matrix6 diagonal_block(ParticleIndex i) const {
    Matrix6 block = Matrix6::Zero();
    ends_->for_each_of(i, [&](BondIndex b) {
      block += detail::end_block(rest_[b], resistance(b, {}), ends_->first(b) == i);
    });
    return block;
  }

  /// The linear forces that a small motion from `displacement` adds, tried from the last advance().
  ///
  /// @return  a BondTangent or, with finite rotations, a FiniteTangent: models of LinearForcesOfBonds
  /// @complexity O(bonds); 320 bytes a bond, with finite rotations 1472
  auto tangent(const Field& displacement, core::ThreadPool& pool) const {
    const std::vector<detail::Rotation> orientation = orientations(displacement, pool);
    std::vector<detail::RestBond> rest(bond_count());
    std::vector<Matrix6> resistance(bond_count());
    std::vector<Matrix12> block(finite_rotation ? bond_count() : 0);
    core::parallel_for(pool, bond_count(), [&](std::size_t begin, std::size_t end) {
      for (BondIndex b = begin; b < end; ++b) {
        const auto motion = motion_of(b, displacement, orientation);
        resistance[b] = this->resistance(b, detail::deformation_from(motion.deformation));
        if constexpr (finite_rotation) {
          detail::Components<double> present;
          motion.branch(present);
          const Vec3 branch = detail::vec(present);
          rest[b] = {branch.normalized(), branch.norm()};
          const ParticleIndex i = ends_->first(b), j = ends_->second(b);
          block[b] = finite_block(
              b, ends_at(displacement[j].linear() - displacement[i].linear(), orientation[i], orientation[j]),
              resistance[b]);
        } else {
          rest[b] = rest_[b];
        }
      }
    });
    BondTangent linear(ends_, std::move(rest), std::move(resistance));
    if constexpr (finite_rotation)
      return FiniteTangent(std::move(linear), std::move(block));
    else
      return linear;
  }

  /// Unit vector of one bond at rest, from its first particle to its second.
  Vec3 direction(BondIndex b) const { return rest_[b].direction; }
  /// Length of one bond at rest, m.
  double length(BondIndex b) const { return rest_[b].length; }
  /// The two particles of one bond.
  std::pair<ParticleIndex, ParticleIndex> ends(BondIndex b) const {
    return {ends_->first(b), ends_->second(b)};
  }
  /// What prepare() made of one bond.
  const Prepared& prepared(BondIndex b) const { return prepared_[b]; }

  /// [bonds] what the law remembers, as of the last advance().
  std::span<const State> states() const noexcept requires has_state { return memory_.state; }
  /// Orientation of one particle as of the last advance().
  Eigen::Quaterniond orientation(ParticleIndex i) const requires finite_rotation {
    const detail::Rotation& q = memory_.orientation[i];
    return {q.w, q.v.x(), q.v.y(), q.v.z()};
  }

  const Memory& memory() const noexcept { return memory_; }
  /// Goes back to what was remembered. @throws core::InvalidInput if it is that of another body
  void restore(const Memory& memory) {
    core::expect(memory.state.size() == memory_.state.size() &&
                     memory.orientation.size() == memory_.orientation.size(),
                 "number of remembered bonds", memory.state.size(),
                 "the memory of this very body, " + std::to_string(memory_.state.size()) + ", is expected");
    memory_ = memory;
  }

private:
  static std::shared_ptr<const detail::BondEnds>
  checked_ends(const Law& law, const particles::ParticleSet& particles, const network::BondNetwork& network) {
    particles.validate();
    network.validate();
    core::expect(network.particle_count == particles.size(), "particle_count of the network",
                 network.particle_count,
                 "the number of particles, " + std::to_string(particles.size()) + ", is expected");
    law.validate(particles);
    return std::make_shared<const detail::BondEnds>(network);
  }

  static void expect_stiffness(const ChannelStiffness& stiffness, BondIndex b) {
    for (const double k : {stiffness.normal, stiffness.tangential, stiffness.torsion, stiffness.bending})
      if (!(k >= 0 && std::isfinite(k))) [[unlikely]]
        core::expect_not_negative(k, "a stiffness of bond " + std::to_string(b));
  }

  /// Orientations at a displacement; empty in small motion.
  std::vector<detail::Rotation> orientations(const Field& displacement, core::ThreadPool& pool) const {
    std::vector<detail::Rotation> orientation;
    orient(orientation, displacement, pool);
    return orientation;
  }
  void orient([[maybe_unused]] std::vector<detail::Rotation>& orientation,
              [[maybe_unused]] const Field& displacement, [[maybe_unused]] core::ThreadPool& pool) const {
    if constexpr (finite_rotation) {
      orientation.resize(particle_count());
      core::parallel_for(pool, particle_count(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          orientation[i] = orientation_at(i, displacement);
      });
    }
  }
  detail::Rotation orientation_at(std::size_t i, const Field& displacement) const {
    return detail::Rotation::by(displacement[i].angular() - memory_.displacement[i].angular())
        .after(memory_.orientation[i]);
  }

  detail::EndsSource source(const Field& displacement,
                            const std::vector<detail::Rotation>& orientation) const {
    return {rest_.data(), displacement.data(), orientation.data()};
  }
  auto motion_of(BondIndex b, const Field& displacement,
                 const std::vector<detail::Rotation>& orientation) const {
    return detail::motion_of<double, finite_rotation>(source(displacement, orientation), *ends_, &b);
  }
  auto motion_at(BondIndex b, const Field& displacement) const {
    if constexpr (finite_rotation) {
      return detail::FiniteMotion<double>(
          detail::components(rest_[b].direction), rest_[b].length,
          ends_at(displacement[ends_->second(b)].linear() - displacement[ends_->first(b)].linear(),
                  orientation_at(ends_->first(b), displacement),
                  orientation_at(ends_->second(b), displacement)));
    } else {
      return motion_of(b, displacement, {});
    }
  }

  static detail::FiniteEnds<double> ends_at(const Vec3& relative, const detail::Rotation& first,
                                            const detail::Rotation& second) {
    return {detail::components(relative), detail::components(first.v), detail::components(second.v), first.w,
            second.w};
  }
  Matrix12 finite_block(BondIndex b, const detail::FiniteEnds<double>& ends, const Matrix6& tangent) const {
    return detail::finite_block(detail::components(rest_[b].direction), rest_[b].length, ends,
                                [&](const double(&deformation)[6], double(&load)[6], Matrix6& resistance) {
                                  detail::write(load, channel_load(b, detail::deformation_from(deformation)));
                                  resistance = tangent;
                                });
  }

  ChannelLoad<> channel_load(BondIndex b, const Deformation<>& deformation) const {
    return Response<Law>::load(law_, prepared_[b], deformation, updated(b, deformation));
  }
  Matrix6 resistance(BondIndex b, const Deformation<>& deformation) const {
    return Response<Law>::tangent(law_, prepared_[b], deformation, updated(b, deformation), rest_[b].length);
  }

  /// The state of bond `b` once it has followed the deformation.
  [[gnu::always_inline]] State updated(BondIndex b, const Deformation<>& deformation) const {
    if constexpr (has_state) {
      State state = memory_.state[b];
      Response<Law>::update(law_, prepared_[b], deformation, state);
      return state;
    } else {
      return {};
    }
  }

  /// Energy lost by bond `b` since the last advance, J: none where its state is as it was.
  double lost_by(BondIndex b, const Deformation<>& deformation, const ChannelLoad<>& load,
                 const State& state) const {
    const State& before = memory_.state[b];
    if (std::memcmp(&state, &before, sizeof(State)) == 0)
      return 0;
    const Deformation<> start =
        detail::deformation_from(motion_of(b, memory_.displacement, memory_.orientation).deformation);
    const Vector6 mean = 0.5 * (detail::vector_of(load) +
                                detail::vector_of(Response<Law>::load(law_, prepared_[b], start, before)));
    return Response<Law>::energy(law_, prepared_[b], start, before) -
           Response<Law>::energy(law_, prepared_[b], deformation, state) +
           mean.dot(detail::vector_of(deformation) - detail::vector_of(start));
  }

  template <class LoadOf>
  void sum_block(std::size_t block, const detail::EndsSource& from, Field& force, LoadOf&& load_of) const {
    detail::sum_block<finite_rotation>(from, *ends_, block, force.data(), std::forward<LoadOf>(load_of));
  }

  Law law_;
  std::shared_ptr<const detail::BondEnds> ends_;
  std::vector<detail::RestBond> rest_; ///< [bonds]
  std::vector<Prepared> prepared_;     ///< [bonds]
  Memory memory_;
  std::vector<State> next_state_;                  ///< [bonds] written while the present one is read
  std::vector<detail::Rotation> next_orientation_; ///< [particles] likewise
};

} // namespace cdem::bond
