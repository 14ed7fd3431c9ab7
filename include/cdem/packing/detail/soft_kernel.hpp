#pragma once

/// @file
/// Repulsion of overlapping spheres: the force kernel, four pairs at a time.

#include <cdem/core/types.hpp>
#include <cdem/packing/detail/quad.hpp>

#include <cstdint>

namespace cdem::packing::detail {

/// Spheres [begin, end) and what their forces depend on. A sphere is (x, y, z, size): its centre in the unit cube, and
/// its radius at a scale of 1.
///
/// Two spheres whose centres are closer than D, the sum of their radii, have the energy (D^2/4) (1 - r^2/D^2)^2 and
/// repel each other with f = (1 - r^2/D^2) r: a spring of stiffness 2 at first touch, whatever the sizes, softer the
/// deeper the overlap. It takes no square root. A wall at h < R from a centre has the energy (R - h)^2.
struct SoftBlock {
  /// Places in the lists, some 12 spheres, by which neighbours are asked from memory before they are needed.
  static constexpr std::uint32_t read_ahead = 96;

  const Quad* spheres; ///< of all
  const ParticleIndex*
      entries; ///< neighbours of the block's spheres, one list after the other, then `read_ahead` more
  const std::uint32_t* list_end; ///< [block] where a sphere's list ends in `entries`; a multiple of four
  ParticleIndex begin, end;
  double scale; ///< radius over size
  bool wraps;   ///< whether a listed pair may touch through a periodic face
  bool walls;   ///< whether the faces of the cube are walls
};

/// Sums over the spheres of a block, over x, y and z each.
struct SoftSums {
  Quad force;    ///< of F; its fourth: dE/d(ln scale), the work of swelling
  Quad squares;  ///< of F
  Quad power;    ///< of F v
  Quad velocity; ///< of v^2

  SoftSums& operator+=(const SoftSums& other) {
    for (int k = 0; k < 4; ++k) {
      force[k] += other.force[k];
      squares[k] += other.squares[k];
      power[k] += other.power[k];
      velocity[k] += other.velocity[k];
    }
    return *this;
  }
};

/// Adds the push of a wall at `height` below a sphere's centre to force and work of swelling.
inline void push_off(double height, double radius, double inwards, double& force, double& swelling) {
  if (height < radius) {
    force += inwards * 2 * (radius - height);
    swelling += 2 * (radius - height) * radius;
  }
}

/// Forces on a block's spheres as (F, its share of dE/d(ln scale)), and their sums. Half a pair's share belongs to each
/// of its spheres; spheres that touch nothing have exactly 0.
///
/// Lists are filled up with the sphere itself, which does nothing to itself.
/// @param velocity  of all
/// @param force     of all, those of the block are written
template <bool wraps, bool walls>
[[gnu::always_inline]] inline void soft_forces(const SoftBlock& block, const ShortQuad* velocity,
                                               ShortQuad* force, SoftSums& sums) {
  const core::Four zero = {0, 0, 0, 0};
  const core::Four one = {1, 1, 1, 1};
  core::Four sum = zero, squares = zero, power = zero, velocities = zero;
  std::uint32_t k = 0;
  for (ParticleIndex i = block.begin; i < block.end; ++i) {
    const Quad& own = block.spheres[i];
    const core::Four x = one * own.component[0], y = one * own.component[1], z = one * own.component[2],
                     size = one * own.component[3];
    core::Four fx = zero, fy = zero, fz = zero, swelling = zero;
    for (const std::uint32_t end = block.list_end[i - block.begin]; k < end; k += 4) {
      for (std::uint32_t n = k + SoftBlock::read_ahead; n < k + SoftBlock::read_ahead + 4; ++n)
        __builtin_prefetch(&block.spheres[block.entries[n]]);
      core::Four a, b, c, d;
      load(a, block.spheres[block.entries[k]]);
      load(b, block.spheres[block.entries[k + 1]]);
      load(c, block.spheres[block.entries[k + 2]]);
      load(d, block.spheres[block.entries[k + 3]]);
      const core::Four xz_low = __builtin_shufflevector(a, b, 0, 4, 2, 6);
      const core::Four yw_low = __builtin_shufflevector(a, b, 1, 5, 3, 7);
      const core::Four xz_high = __builtin_shufflevector(c, d, 0, 4, 2, 6);
      const core::Four yw_high = __builtin_shufflevector(c, d, 1, 5, 3, 7);
      core::Four dx = x - __builtin_shufflevector(xz_low, xz_high, 0, 1, 4, 5);
      core::Four dy = y - __builtin_shufflevector(yw_low, yw_high, 0, 1, 4, 5);
      core::Four dz = z - __builtin_shufflevector(xz_low, xz_high, 2, 3, 6, 7);
      const core::Four reach = (size + __builtin_shufflevector(yw_low, yw_high, 2, 3, 6, 7)) * block.scale;
      if constexpr (wraps) {
        wrap(dx);
        wrap(dy);
        wrap(dz);
      }
      const core::Four square = dx * dx + dy * dy + dz * dz;
      core::Four push = one - square / (reach * reach);
      push = ((push > zero) & (square > zero)) ? push : zero;
      fx += push * dx;
      fy += push * dy;
      fz += push * dz;
      swelling += push * (reach * reach + square);
    }
    // The four sums side by side: one addition of each pair of halves for all.
    const core::Four xy =
        __builtin_shufflevector(fx, fy, 0, 4, 2, 6) + __builtin_shufflevector(fx, fy, 1, 5, 3, 7);
    const core::Four zw = __builtin_shufflevector(fz, swelling * 0.25, 0, 4, 2, 6) +
                          __builtin_shufflevector(fz, swelling * 0.25, 1, 5, 3, 7);
    core::Four total =
        __builtin_shufflevector(xy, zw, 0, 1, 4, 5) + __builtin_shufflevector(xy, zw, 2, 3, 6, 7);
    if constexpr (walls) {
      const double radius = own.component[3] * block.scale;
      for (int axis = 0; axis < 3; ++axis) {
        double push = total[axis], work = total[3];
        push_off(own.component[axis], radius, 1, push, work);
        push_off(1 - own.component[axis], radius, -1, push, work);
        total[axis] = push;
        total[3] = work;
      }
    }
    core::Four v;
    load(v, velocity[i]);
    store(force[i], total);
    sum += total;
    squares += total * total;
    power += total * v;
    velocities += v * v;
  }
  store(sums.force, sum);
  store(sums.squares, squares);
  store(sums.power, power);
  store(sums.velocity, velocities);
}

[[gnu::always_inline]] inline void soft_forces(const SoftBlock& block, const ShortQuad* velocity,
                                               ShortQuad* force, SoftSums& sums) {
  block.walls   ? soft_forces<false, true>(block, velocity, force, sums)
  : block.wraps ? soft_forces<true, false>(block, velocity, force, sums)
                : soft_forces<false, false>(block, velocity, force, sums);
}

/// What a step of the descent does: v = keep v + push F, then x += step v.
struct SoftStep {
  double keep, push, step;
};

/// Moves the spheres [begin, end). Those that touch nothing stop.
/// @return  at least the square of the farthest move
[[gnu::always_inline]] inline double soft_move(const SoftStep& step, ParticleIndex begin, ParticleIndex end,
                                               const ShortQuad* force, ShortQuad* velocity, Quad* spheres) {
  const core::Four zero = {0, 0, 0, 0};
  const core::Four push = {step.push, step.push, step.push, 0};
  core::Four farthest = zero;
  for (ParticleIndex i = begin; i < end; ++i) {
    core::Four f, v, x;
    load(f, force[i]);
    load(v, velocity[i]);
    load(x, spheres[i]);
    v = __builtin_shufflevector(f, f, 3, 3, 3, 3) > zero ? v : zero;
    v = step.keep * v + push * f;
    core::Four shift = step.step * v;
    x += shift;
    shift *= shift;
    farthest = shift > farthest ? shift : farthest;
    store(velocity[i], v);
    store(spheres[i], x);
  }
  return farthest[0] + farthest[1] + farthest[2];
}

/// The two loops of the descent, for any processor.
struct SoftKernels {
  void (*forces)(const SoftBlock& block, const ShortQuad* velocity, ShortQuad* force, SoftSums& sums);
  double (*move)(const SoftStep& step, ParticleIndex begin, ParticleIndex end, const ShortQuad* force,
                 ShortQuad* velocity, Quad* spheres);

  static void forces_anywhere(const SoftBlock& block, const ShortQuad* velocity, ShortQuad* force,
                              SoftSums& sums) {
    soft_forces(block, velocity, force, sums);
  }
  static double move_anywhere(const SoftStep& step, ParticleIndex begin, ParticleIndex end,
                              const ShortQuad* force, ShortQuad* velocity, Quad* spheres) {
    return soft_move(step, begin, end, force, velocity, spheres);
  }

  /// Those that run on every processor.
  static SoftKernels anywhere() { return {forces_anywhere, move_anywhere}; }

#if defined(__x86_64__)
  // The same operations in the same order in registers of 256 bits. Not fused, so that the bytes are the same (unless
  // the whole translation unit is compiled for fused multiply-add, as by -march=native).
  [[gnu::target("avx2")]] static void forces_avx2(const SoftBlock& block, const ShortQuad* velocity,
                                                  ShortQuad* force, SoftSums& sums) {
    soft_forces(block, velocity, force, sums);
  }
  [[gnu::target("avx2")]] static double move_avx2(const SoftStep& step, ParticleIndex begin,
                                                  ParticleIndex end, const ShortQuad* force,
                                                  ShortQuad* velocity, Quad* spheres) {
    return soft_move(step, begin, end, force, velocity, spheres);
  }
#endif

  /// The fastest that this processor has.
  static SoftKernels fastest() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2"))
      return {forces_avx2, move_avx2};
#endif
    return anywhere();
  }
};

} // namespace cdem::packing::detail
