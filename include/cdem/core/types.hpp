#pragma once

/// @file
/// Scalar, index and vector aliases shared by every layer. SI units everywhere, tension positive.

#include <Eigen/Core>

#include <cstdint>

namespace cdem::core {

/// Vector of three components (position m, displacement m, rotation rad, force N, moment N m).
template <class Real>
using Vector3 = Eigen::Matrix<Real, 3, 1>;
/// 3x3 matrix; a stress tensor is in Pa, row = direction of the force, column = direction of the branch.
template <class Real>
using Matrix3 = Eigen::Matrix<Real, 3, 3>;

using Vec3 = Vector3<double>;
using Mat3 = Matrix3<double>;

/// Number of a particle: 32 bits hold 4.29e9 particles.
using ParticleIndex = std::uint32_t;
/// Number of a bond: 64 bits, since bonds are three times as many as particles.
using BondIndex = std::uint64_t;
/// Number of a phase (material) of a particle: at most 256 phases.
using PhaseIndex = std::uint8_t;

/// The axis of a test, a face or a plane normal.
enum class Axis : std::uint8_t { x = 0, y = 1, z = 2 };

/// 0, 1 or 2 for x, y or z.
constexpr int index_of(Axis axis) noexcept {
  return static_cast<int>(axis);
}
/// 'x', 'y' or 'z'.
constexpr char name_of(Axis axis) noexcept {
  return static_cast<char>('x' + index_of(axis));
}

} // namespace cdem::core

namespace cdem {
using core::Axis;
using core::BondIndex;
using core::Mat3;
using core::ParticleIndex;
using core::PhaseIndex;
using core::Vec3;
} // namespace cdem
