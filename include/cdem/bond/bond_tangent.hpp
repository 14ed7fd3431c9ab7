#pragma once

/// @file
/// Linear forces of small motion about a deformed body: what Newton's method solves with.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/detail/bond_lanes.hpp>
#include <cdem/bond/response.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace cdem::bond {

namespace detail {

/// The 6x6 block of one bond's stiffness that couples its first or second end with itself: B_e' H B_e.
template <class Resistance>
Matrix6 end_block(const RestBond& rest, const Resistance& resistance, bool first) {
  const Mat3 axes = local_frame(rest.direction).transpose();
  const double sign = first ? -1 : 1;
  Mat3 arm; // th -> -(L/2) th x n
  const Vec3 n = 0.5 * rest.length * rest.direction;
  arm << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
  Matrix6 slip_and_turn = Matrix6::Zero(); // in the local frame, by the end's motion
  slip_and_turn.topLeftCorner<3, 3>() = sign * axes;
  slip_and_turn.topRightCorner<3, 3>() = axes * arm;
  slip_and_turn.bottomRightCorner<3, 3>() = sign * axes;
  return slip_and_turn.transpose() * resistance * slip_and_turn;
}

} // namespace detail

/// Forces f = -K x of small motion about a displacement, K = sum over bonds of B' H B with the law's tangent H there.
///
/// Made by BondForces::tangent(). A model of LinearForcesOfBonds: the four stiffnesses it tells of a bond are the means
/// of H's diagonal (none below 0), enough to precondition with; what it multiplies by is H itself.
///
/// @tparam Real  double; a template so that a unit that does not use it does not compile it
template <class Real = double>
class BasicBondTangent {
  using Field = particles::SpatialField<>;

public:
  /// @param rest        [bonds] where the bonds lie
  /// @param resistance  [bonds] H, in the local frames
  BasicBondTangent(std::shared_ptr<const detail::BondEnds> ends, std::vector<detail::RestBond> rest,
                   std::vector<Matrix6> resistance)
      : ends_(std::move(ends)), rest_(std::move(rest)), resistance_(std::move(resistance)) {}

  std::size_t particle_count() const noexcept { return ends_->particle_count(); }
  std::size_t bond_count() const noexcept { return ends_->bond_count(); }

  /// f = -K x. @complexity O(bonds)
  void evaluate(const Field& displacement, Field& force, core::ThreadPool& pool) const {
    force.resize(particle_count());
    pool.for_each_block(ends_->block_count(), [&](std::size_t block) {
      detail::sum_block<false>({rest_.data(), displacement.data(), nullptr}, *ends_, block, force.data(),
                               [&](BondIndex b, const double(&deformation)[6], double(&load)[6]) {
                                 Eigen::Map<Vector6>(load).noalias() =
                                     resistance_[b] * Eigen::Map<const Vector6>(deformation);
                               });
    });
  }

  /// x.K x / 2, J. @complexity O(bonds)
  double elastic_energy(const Field& displacement, core::ThreadPool& pool) const {
    return core::parallel_sum(pool, bond_count(), 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (BondIndex b = begin; b < end; ++b) {
        const auto d = deformation(b, displacement);
        sum += 0.5 * d.dot(resistance_[b] * d);
      }
      return sum;
    });
  }

  /// Force and moments that a small motion adds to one bond. @complexity O(1)
  BondLoad load(BondIndex b, const Field& displacement) const {
    const Mat3 frame = local_frame(rest_[b].direction);
    const Vector6 f = resistance_[b] * deformation(b, displacement);
    const Vec3 force = frame * f.head<3>(), moment = frame * f.tail<3>();
    const Vec3 couple = 0.5 * rest_[b].length * rest_[b].direction.cross(force);
    return {force, couple + moment, couple - moment};
  }

  Matrix6 diagonal_block(ParticleIndex i) const {
    Matrix6 block = Matrix6::Zero();
    ends_->for_each_of(
        i, [&](BondIndex b) { block += detail::end_block(rest_[b], resistance_[b], ends_->first(b) == i); });
    return block;
  }

  /// Stiffnesses that stand for H where four must do.
  ChannelStiffness stiffness(BondIndex b) const {
    const Matrix6& h = resistance_[b];
    return {std::max(0.0, h(0, 0)), std::max(0.0, 0.5 * (h(1, 1) + h(2, 2))), std::max(0.0, h(3, 3)),
            std::max(0.0, 0.5 * (h(4, 4) + h(5, 5)))};
  }
  Vec3 direction(BondIndex b) const { return rest_[b].direction; }
  double length(BondIndex b) const { return rest_[b].length; }
  std::pair<ParticleIndex, ParticleIndex> ends(BondIndex b) const {
    return {ends_->first(b), ends_->second(b)};
  }

protected:
  const detail::BondEnds& bond_ends() const noexcept { return *ends_; }

private:
  Vector6 deformation(BondIndex b, const Field& displacement) const {
    const Mat3 frame = local_frame(rest_[b].direction);
    const BondDeformation d = deformation_of(rest_[b].direction, rest_[b].length,
                                             displacement[ends_->first(b)], displacement[ends_->second(b)]);
    Vector6 local;
    local << frame.transpose() * d.slip, frame.transpose() * d.turn;
    return local;
  }

  std::shared_ptr<const detail::BondEnds> ends_;
  std::vector<detail::RestBond> rest_;
  std::vector<Matrix6> resistance_;
};

using BondTangent = BasicBondTangent<>;

/// The tangent of forces with finite rotations: the bonds' forces turn with their ends, so that each bond has a 12x12
/// block beside what its material resists (the geometric stiffness).
///
/// Blocks are symmetrised: out of equilibrium the derivative of moments by rotations is not symmetric, in it it is.
template <class Real = double>
class BasicFiniteTangent : public BasicBondTangent<Real> {
  using Field = particles::SpatialField<>;

public:
  /// @param block  [bonds] derivative of the forces on the ends by their motion, negative, in (u_i, th_i, u_j, th_j)
  BasicFiniteTangent(BasicBondTangent<Real> material, std::vector<Matrix12> block)
      : BasicBondTangent<Real>(std::move(material)), block_(std::move(block)) {
    for (Matrix12& k : block_)
      k = Matrix12(0.5 * (k + k.transpose()));
  }

  /// f = -K x. @complexity O(bonds)
  void evaluate(const Field& x, Field& force, core::ThreadPool& pool) const {
    force.resize(this->particle_count());
    core::parallel_for(pool, this->particle_count(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Vector6 sum = Vector6::Zero();
        this->bond_ends().for_each_of(static_cast<ParticleIndex>(i), [&](BondIndex b) {
          const bool first = this->bond_ends().first(b) == i;
          sum -= block_[b].middleRows<6>(first ? 0 : 6) * motion(b, x);
        });
        force[i] = {};
        force[i].linear() = sum.head<3>();
        force[i].angular() = sum.tail<3>();
      }
    });
  }

  /// x.K x / 2, J. @complexity O(bonds)
  double elastic_energy(const Field& x, core::ThreadPool& pool) const {
    return core::parallel_sum(pool, this->bond_count(), 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (BondIndex b = begin; b < end; ++b) {
        const auto ends = motion(b, x);
        sum += 0.5 * ends.dot(block_[b] * ends);
      }
      return sum;
    });
  }

  Matrix6 diagonal_block(ParticleIndex i) const {
    Matrix6 block = Matrix6::Zero();
    this->bond_ends().for_each_of(i, [&](BondIndex b) {
      const int first = this->bond_ends().first(b) == i ? 0 : 6;
      block += block_[b].block<6, 6>(first, first);
    });
    return block;
  }

private:
  Eigen::Matrix<double, 12, 1> motion(BondIndex b, const Field& x) const {
    const auto &i = x[this->bond_ends().first(b)], &j = x[this->bond_ends().second(b)];
    Eigen::Matrix<double, 12, 1> ends;
    ends << i.linear(), i.angular(), j.linear(), j.angular();
    return ends;
  }

  std::vector<Matrix12> block_;
};

using FiniteTangent = BasicFiniteTangent<>;

} // namespace cdem::bond
