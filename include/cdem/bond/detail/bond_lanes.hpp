#pragma once

/// @file
/// The forces of bonds under any law: kinematics four bonds at a time in vector registers, the law one by one.

#include <cdem/bond/detail/bond_ends.hpp>
#include <cdem/bond/detail/bond_kernel.hpp>
#include <cdem/bond/detail/bond_kinematics.hpp>
#include <cdem/core/unrolled.hpp>
#include <cdem/core/vector_registers.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cdem::bond::detail {

/// A bond as it lies: where the rest of it is known by its ends.
struct RestBond {
  Vec3 direction = Vec3::UnitX();
  double length = 1;
};
static_assert(sizeof(RestBond) == 4 * sizeof(double));

/// A rotation as unit quaternion w + v.
struct Rotation {
  Vec3 v = Vec3::Zero();
  double w = 1;

  /// exp of a rotation vector: sin(|r|/2)/|r| r, cos(|r|/2).
  static Rotation by(const Vec3& r) {
    const double square = 0.25 * r.squaredNorm();
    if (square < 1e-4) // h = |r|/2: sin h / h and cos h to rounding
      return {(0.5 - square * (1.0 / 12 - square * (1.0 / 240 - square / 10080))) * r,
              1 - square * (0.5 - square * (1.0 / 24 - square * (1.0 / 720 - square / 40320)))};
    const double half = std::sqrt(square);
    return {(0.5 * std::sin(half) / half) * r, std::cos(half)};
  }
  /// This one after `before`, of length 1 again after rounding.
  Rotation after(const Rotation& before) const {
    const Rotation product{w * before.v + before.w * v + v.cross(before.v), w * before.w - v.dot(before.v)};
    const double scale = 1.5 - 0.5 * (product.w * product.w + product.v.squaredNorm());
    return {scale * product.v, scale * product.w};
  }
};
static_assert(sizeof(Rotation) == 4 * sizeof(double));

/// Where the ends of bonds are read from.
struct EndsSource {
  const RestBond* rest;                     ///< [bonds]
  const particles::Spatial<>* displacement; ///< [particles]
  const Rotation* orientation;              ///< [particles]; null in small motion
};

/// Memory of four lines (x, y, z, w) becomes lanes.
[[gnu::always_inline]] inline void gather(Components<core::Four>& xyz, core::Four& w,
                                          const double* const line[4]) {
  core::Four a, b, c, d;
  load(a, line[0]);
  load(b, line[1]);
  load(c, line[2]);
  load(d, line[3]);
  const core::Four ab_low = __builtin_shufflevector(a, b, 0, 4, 2, 6),
                   ab_high = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const core::Four cd_low = __builtin_shufflevector(c, d, 0, 4, 2, 6),
                   cd_high = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  xyz.x = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  xyz.y = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  xyz.z = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  w = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}
/// One line becomes the components of one bond.
[[gnu::always_inline]] inline void gather(Components<double>& xyz, double& w, const double* const line[1]) {
  xyz = {line[0][0], line[0][1], line[0][2]};
  w = line[0][3];
}

/// Bonds side by side in one Real.
template <class Real>
inline constexpr std::size_t lanes_of = sizeof(Real) / sizeof(double);

/// The motion of one bond, or of four.
template <class Real, bool finite>
using MotionOf = std::conditional_t<finite, FiniteMotion<Real>, SmallMotion<Real>>;

/// Reads the ends of bonds. @param bond [lanes of Real]
template <class Real, bool finite>
[[gnu::always_inline]] inline MotionOf<Real, finite> motion_of(const EndsSource& from, const BondEnds& ends,
                                                               const BondIndex* bond) {
  constexpr std::size_t lanes = lanes_of<Real>;
  constexpr int angular = 4; // where rotations begin in a Spatial
  const double *rest[lanes], *u[lanes], *v[lanes];
  core::unrolled<lanes>([&](std::size_t q) __attribute__((always_inline)) {
    rest[q] = from.rest[bond[q]].direction.data();
    u[q] = from.displacement[ends.first(bond[q])].component;
    v[q] = from.displacement[ends.second(bond[q])].component;
  });
  Components<Real> direction;
  Real length, padding;
  gather(direction, length, rest);
  SmallEnds<Real> motion;
  gather(motion.displacement_first, padding, u);
  gather(motion.displacement_second, padding, v);
  if constexpr (finite) {
    FiniteEnds<Real> turned;
    const auto &a = motion.displacement_first, &b = motion.displacement_second;
    turned.relative = {b.x - a.x, b.y - a.y, b.z - a.z};
    core::unrolled<lanes>([&](std::size_t q) __attribute__((always_inline)) {
      u[q] = from.orientation[ends.first(bond[q])].v.data();
      v[q] = from.orientation[ends.second(bond[q])].v.data();
    });
    gather(turned.v_first, turned.w_first, u);
    gather(turned.v_second, turned.w_second, v);
    return {direction, length, turned};
  } else {
    core::unrolled<lanes>([&](std::size_t q) __attribute__((always_inline)) {
      u[q] += angular;
      v[q] += angular;
    });
    gather(motion.rotation_first, padding, u);
    gather(motion.rotation_second, padding, v);
    return {direction, length, motion};
  }
}

/// Adds the loads of four bonds to the particles of [begin, end) among their ends; the first `count` of the four count.
///
/// @tparam own     the first ends are in the block; else the second ends alone are
/// @param load_of  void(BondIndex, const double (&deformation)[6], double (&load)[6])
template <bool finite, bool own, class LoadOf>
[[gnu::always_inline]] inline void add_four(const EndsSource& from, const BondEnds& ends,
                                            const BondIndex* bond, int count, std::size_t end,
                                            particles::Spatial<>* force, LoadOf& load_of) {
  using core::Four;
  const auto motion = motion_of<Four, finite>(from, ends, bond);
  double deformation[4][6], channel[4][6];
  core::unrolled<4>([&](std::size_t q) __attribute__((always_inline)) {
    core::unrolled<6>([&](std::size_t k)
                          __attribute__((always_inline)) { deformation[q][k] = motion.deformation[k][q]; });
  });
  for (int q = 0; q < count; ++q) // the law is in the code once
    load_of(bond[q], deformation[q], channel[q]);
  for (int q = count; q < 4; ++q)
    std::fill(channel[q], channel[q] + 6, 0.0);
  const auto& c = channel;
  const Four load[6] = {{c[0][0], c[1][0], c[2][0], c[3][0]}, {c[0][1], c[1][1], c[2][1], c[3][1]},
                        {c[0][2], c[1][2], c[2][2], c[3][2]}, {c[0][3], c[1][3], c[2][3], c[3][3]},
                        {c[0][4], c[1][4], c[2][4], c[3][4]}, {c[0][5], c[1][5], c[2][5], c[3][5]}};
  EndLoads<Four> loads;
  motion.on_ends(loads, load);
  Four pull[4], moment_first[4], moment_second[4];
  spread(pull, {loads.force.x, loads.force.y, loads.force.z});
  if constexpr (own)
    spread(moment_first, {loads.moment_first.x, loads.moment_first.y, loads.moment_first.z});
  spread(moment_second, {loads.moment_second.x, loads.moment_second.y, loads.moment_second.z});
  particles::Spatial<> elsewhere; // takes what falls on other blocks, and of bonds that do not count
  core::unrolled<4>([&](std::size_t q) __attribute__((always_inline)) {
    const bool counts = static_cast<int>(q) < count;
    if constexpr (own) {
      double* const i = (counts ? force + ends.first(bond[q]) : &elsewhere)->component;
      increase(i, pull[q]);
      increase(i + 4, moment_first[q]);
    }
    const std::size_t second = ends.second(bond[q]);
    double* const j = (counts && second < end ? force + second : &elsewhere)->component;
    decrease(j, pull[q]);
    increase(j + 4, moment_second[q]);
  });
}

/// Bonds ahead whose ends are asked for from memory.
inline constexpr BondIndex bonds_ahead = 32;

/// Forces on one block of particles, which they overwrite: its own bonds in order, then those that enter it.
template <bool finite, class LoadOf>
[[gnu::always_inline]] inline void sum_block_inline(const EndsSource& from, const BondEnds& ends,
                                                    std::size_t block, particles::Spatial<>* force,
                                                    LoadOf& load_of) {
  const std::size_t begin = ends.block_begin(block), end = ends.block_end(block);
  std::fill(force + begin, force + end, particles::Spatial<>{});
  const BondIndex own_end = ends.own_begin(end);
  BondIndex four[4];
  for (BondIndex b = ends.own_begin(begin); b < own_end; b += 4) {
    const int count = static_cast<int>(std::min<BondIndex>(4, own_end - b));
    core::unrolled<4>([&](std::size_t q) __attribute__((always_inline)) {
      four[q] = std::min<BondIndex>(b + q, own_end - 1);
      const std::size_t ahead = ends.second(std::min<BondIndex>(b + q + bonds_ahead, own_end - 1));
      __builtin_prefetch(from.displacement + ahead);
      if constexpr (finite)
        __builtin_prefetch(from.orientation + ahead);
    });
    add_four<finite, true>(from, ends, four, count, end, force, load_of);
  }
  const auto entering = ends.entering(block);
  for (std::size_t k = 0; k < entering.size(); k += 4) {
    const int count = static_cast<int>(std::min<std::size_t>(4, entering.size() - k));
    core::unrolled<4>([&](std::size_t q) __attribute__((always_inline)) {
      four[q] = entering[std::min(k + q, entering.size() - 1)];
    });
    add_four<finite, false>(from, ends, four, count, end, force, load_of);
  }
}

#if defined(__x86_64__)
template <bool finite, class LoadOf>
[[gnu::target("avx2"), gnu::flatten]] void sum_block_avx2(const EndsSource& from, const BondEnds& ends,
                                                          std::size_t block, particles::Spatial<>* force,
                                                          LoadOf& load_of) {
  sum_block_inline<finite>(from, ends, block, force, load_of);
}
#endif

/// sum_block_inline() by the best means of this processor.
template <bool finite, class LoadOf>
void sum_block(const EndsSource& from, const BondEnds& ends, std::size_t block, particles::Spatial<>* force,
               LoadOf&& load_of) {
#if defined(__x86_64__)
  if (core::has_avx2())
    return sum_block_avx2<finite>(from, ends, block, force, load_of);
#endif
  sum_block_inline<finite>(from, ends, block, force, load_of);
}

} // namespace cdem::bond::detail
