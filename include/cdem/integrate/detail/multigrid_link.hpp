#pragma once

/// @file
/// What the static multigrid asks of a body's bonds, and the algebra of rigid motions.

#include <cdem/core/types.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <concepts>
#include <cstddef>
#include <utility>

namespace cdem::integrate {

/// Tells the bonds of a body whose forces are linear: ends, direction, length and four stiffnesses of each.
///
/// The stiffnesses multiply the bond's stretch, shear, twist and bend: with n the direction and L the length,
/// slip = u_j - u_i - L (th_i + th_j)/2 x n and turn = th_j - th_i.              [L17] section 2.2, frame-free form
template <class F>
concept LinearBonds = requires(const F& forces, BondIndex b) {
  { forces.bond_count() } -> std::convertible_to<std::size_t>;
  { forces.ends(b) } -> std::convertible_to<std::pair<ParticleIndex, ParticleIndex>>;
  { forces.direction(b) } -> std::convertible_to<Vec3>;
  { forces.length(b) } -> std::convertible_to<double>;
  { forces.stiffness(b).normal } -> std::convertible_to<double>;
  { forces.stiffness(b).tangential } -> std::convertible_to<double>;
  { forces.stiffness(b).torsion } -> std::convertible_to<double>;
  { forces.stiffness(b).bending } -> std::convertible_to<double>;
};

namespace detail {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Whether a bond resists anything.
template <class Stiffness>
bool is_stiff(const Stiffness& k) {
  return k.normal > 0 || k.tangential > 0 || k.torsion > 0 || k.bending > 0;
}

/// [v]x, the matrix whose product with w is v x w.
inline Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// S' C S for the rigid motion carried from a frame to the point `arm` away from it: S = [1, -[arm]x; 0, 1].
inline Matrix6 carried(const Matrix6& stiffness, const Vec3& arm) {
  const Mat3 lever = -cross_matrix(arm);
  Matrix6 half = stiffness; // C S
  half.rightCols<3>() += stiffness.leftCols<3>() * lever;
  Matrix6 whole = half; // S' C S
  whole.bottomRows<3>() += lever.transpose() * half.topRows<3>();
  return whole;
}

/// Three floats in a vector register; the fourth lane means nothing. A vector type of GCC and Clang: Eigen's cross3()
/// goes through memory here, which costs three times the rest of a link.
using Float4 [[gnu::vector_size(16)]] = float;

inline Float4 load4(const float* place) {
  Float4 value;
  __builtin_memcpy(&value, place, sizeof value);
  return value;
}
inline void store4(const Float4& value, float* place) {
  __builtin_memcpy(place, &value, sizeof value);
}

/// Components y, z, x.
inline Float4 rotated(const Float4& v) {
  return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}
inline Float4 cross(const Float4& a, const Float4& b) {
  return rotated(a * rotated(b) - rotated(a) * b);
}
/// a . b in each of the three lanes.
inline Float4 dot(const Float4& a, const Float4& b) {
  const Float4 product = a * b, next = rotated(product);
  return product + next + rotated(next);
}

/// Translation and rotation of a node, or force and moment on it.
struct Twist {
  Float4 linear{};
  Float4 angular{};

  static Twist load(const float* component) { return {load4(component), load4(component + 4)}; }
  void store(float* component) const {
    store4(linear, component);
    store4(angular, component + 4);
  }
  Twist& operator+=(const Twist& other) {
    linear += other.linear;
    angular += other.angular;
    return *this;
  }
  Twist& operator-=(const Twist& other) {
    linear -= other.linear;
    angular -= other.angular;
    return *this;
  }
  friend Twist operator*(float factor, const Twist& twist) {
    return {factor * twist.linear, factor * twist.angular};
  }
  /// The same with zero in the lanes that mean nothing.
  Twist clean() const {
    const Float4 zero{};
    return {__builtin_shufflevector(linear, zero, 0, 1, 2, 4),
            __builtin_shufflevector(angular, zero, 0, 1, 2, 4)};
  }
};

/// Product of a 6x6 matrix stored column by column, with one float after it that may be read, and a twist.
inline Twist multiply(const float* columns, const Float4& linear, const Float4& angular) {
  Twist sum;
  for (int k = 0; k < 3; ++k) {
    sum.linear += linear[k] * load4(columns + 6 * k);
    sum.angular += linear[k] * load4(columns + 6 * k + 3);
  }
  for (int k = 0; k < 3; ++k) {
    sum.linear += angular[k] * load4(columns + 6 * k + 18);
    sum.angular += angular[k] * load4(columns + 6 * k + 21);
  }
  return sum;
}

} // namespace detail
} // namespace cdem::integrate
