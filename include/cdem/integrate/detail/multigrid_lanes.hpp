#pragma once

/// @file
/// The static multigrid's innermost loops, eight links or eight nodes at a time: one in each lane of a register.
///
/// They are written once, in vectors of eight floats of GCC and Clang, and compiled twice: for any processor and, on
/// x86, for AVX2, which is taken where the processor has it. The operations and their order are the same (no fused
/// multiply-add is asked for), and so are the bits.

#include <array>
#include <cstddef>
#include <cstdint>

namespace cdem::integrate::detail {

using Float8 [[gnu::vector_size(32)]] = float;

/// The same anywhere in memory, over whatever is there.
using Float8Memory [[gnu::vector_size(32), gnu::aligned(4), gnu::may_alias]] = float;

// Vectors go by reference: how wide ones are passed by value depends on the processor compiled for.
[[gnu::always_inline]] inline void load8(const float* place, Float8& value) {
  value = *reinterpret_cast<const Float8Memory*>(place);
}
[[gnu::always_inline]] inline void store8(const Float8& value, float* place) {
  *reinterpret_cast<Float8Memory*>(place) = value;
}
/// use(0), ..., use(7), written out: an array that a loop runs over would go through memory.
template <class Use>
[[gnu::always_inline]] inline void for_eight(Use&& use) {
  use(0);
  use(1);
  use(2);
  use(3);
  use(4);
  use(5);
  use(6);
  use(7);
}

/// Translation and rotation (or force and moment) of eight nodes.
struct Twist8 {
  Float8 x, y, z; ///< linear
  Float8 a, b, c; ///< angular
};

/// From eight lines of memory, a node each (x y z 0 a b c 0), to one node in each lane.
[[gnu::always_inline]] inline void from_lines(const Float8 (&line)[8], Twist8& twist) {
  const auto quarter = [](const Float8& r0, const Float8& r1, const Float8& r2, const Float8& r3,
                          Float8& first, Float8& second, Float8& third) __attribute__((always_inline)) {
    const Float8 t0 = __builtin_shufflevector(r0, r1, 0, 8, 1, 9, 4, 12, 5, 13);
    const Float8 t1 = __builtin_shufflevector(r0, r1, 2, 10, 3, 11, 6, 14, 7, 15);
    const Float8 t2 = __builtin_shufflevector(r2, r3, 0, 8, 1, 9, 4, 12, 5, 13);
    const Float8 t3 = __builtin_shufflevector(r2, r3, 2, 10, 3, 11, 6, 14, 7, 15);
    first = __builtin_shufflevector(t0, t2, 0, 1, 8, 9, 4, 5, 12, 13);
    second = __builtin_shufflevector(t0, t2, 2, 3, 10, 11, 6, 7, 14, 15);
    third = __builtin_shufflevector(t1, t3, 0, 1, 8, 9, 4, 5, 12, 13);
  };
  Float8 xa_low, yb_low, zc_low, xa_high, yb_high, zc_high;
  quarter(line[0], line[1], line[2], line[3], xa_low, yb_low, zc_low);
  quarter(line[4], line[5], line[6], line[7], xa_high, yb_high, zc_high);
  twist.x = __builtin_shufflevector(xa_low, xa_high, 0, 1, 2, 3, 8, 9, 10, 11);
  twist.y = __builtin_shufflevector(yb_low, yb_high, 0, 1, 2, 3, 8, 9, 10, 11);
  twist.z = __builtin_shufflevector(zc_low, zc_high, 0, 1, 2, 3, 8, 9, 10, 11);
  twist.a = __builtin_shufflevector(xa_low, xa_high, 4, 5, 6, 7, 12, 13, 14, 15);
  twist.b = __builtin_shufflevector(yb_low, yb_high, 4, 5, 6, 7, 12, 13, 14, 15);
  twist.c = __builtin_shufflevector(zc_low, zc_high, 4, 5, 6, 7, 12, 13, 14, 15);
}

/// And back; the lanes that mean nothing are zero.
[[gnu::always_inline]] inline void to_lines(const Twist8& twist, Float8 (&line)[8]) {
  const Float8 xa_low = __builtin_shufflevector(twist.x, twist.a, 0, 1, 2, 3, 8, 9, 10, 11);
  const Float8 yb_low = __builtin_shufflevector(twist.y, twist.b, 0, 1, 2, 3, 8, 9, 10, 11);
  const Float8 zc_low = __builtin_shufflevector(twist.z, twist.c, 0, 1, 2, 3, 8, 9, 10, 11);
  const Float8 xa_high = __builtin_shufflevector(twist.x, twist.a, 4, 5, 6, 7, 12, 13, 14, 15);
  const Float8 yb_high = __builtin_shufflevector(twist.y, twist.b, 4, 5, 6, 7, 12, 13, 14, 15);
  const Float8 zc_high = __builtin_shufflevector(twist.z, twist.c, 4, 5, 6, 7, 12, 13, 14, 15);
  const auto quarter = [](const Float8& xa, const Float8& yb, const Float8& zc, Float8& r0, Float8& r1,
                          Float8& r2, Float8& r3) __attribute__((always_inline)) {
    const Float8 zero{};
    const Float8 t0 = __builtin_shufflevector(xa, yb, 0, 8, 1, 9, 4, 12, 5, 13);
    const Float8 t1 = __builtin_shufflevector(xa, yb, 2, 10, 3, 11, 6, 14, 7, 15);
    const Float8 t2 = __builtin_shufflevector(zc, zero, 0, 8, 1, 9, 4, 12, 5, 13);
    const Float8 t3 = __builtin_shufflevector(zc, zero, 2, 10, 3, 11, 6, 14, 7, 15);
    r0 = __builtin_shufflevector(t0, t2, 0, 1, 8, 9, 4, 5, 12, 13);
    r1 = __builtin_shufflevector(t0, t2, 2, 3, 10, 11, 6, 7, 14, 15);
    r2 = __builtin_shufflevector(t1, t3, 0, 1, 8, 9, 4, 5, 12, 13);
    r3 = __builtin_shufflevector(t1, t3, 2, 3, 10, 11, 6, 7, 14, 15);
  };
  quarter(xa_low, yb_low, zc_low, line[0], line[1], line[2], line[3]);
  quarter(xa_high, yb_high, zc_high, line[4], line[5], line[6], line[7]);
}

/// y = C v for eight symmetric 6x6 matrices, `upper` their upper triangles row by row, eight of each entry.
[[gnu::always_inline]] inline void multiply_symmetric(const float* upper, const Twist8& v, Twist8& y) {
  Float8 c[21];
  load8(upper + 0, c[0]);
  load8(upper + 8, c[1]);
  load8(upper + 16, c[2]);
  load8(upper + 24, c[3]);
  load8(upper + 32, c[4]);
  load8(upper + 40, c[5]);
  load8(upper + 48, c[6]);
  load8(upper + 56, c[7]);
  load8(upper + 64, c[8]);
  load8(upper + 72, c[9]);
  load8(upper + 80, c[10]);
  load8(upper + 88, c[11]);
  load8(upper + 96, c[12]);
  load8(upper + 104, c[13]);
  load8(upper + 112, c[14]);
  load8(upper + 120, c[15]);
  load8(upper + 128, c[16]);
  load8(upper + 136, c[17]);
  load8(upper + 144, c[18]);
  load8(upper + 152, c[19]);
  load8(upper + 160, c[20]);
  y.x = c[0] * v.x + c[1] * v.y + c[2] * v.z + c[3] * v.a + c[4] * v.b + c[5] * v.c;
  y.y = c[1] * v.x + c[6] * v.y + c[7] * v.z + c[8] * v.a + c[9] * v.b + c[10] * v.c;
  y.z = c[2] * v.x + c[7] * v.y + c[11] * v.z + c[12] * v.a + c[13] * v.b + c[14] * v.c;
  y.a = c[3] * v.x + c[8] * v.y + c[12] * v.z + c[15] * v.a + c[16] * v.b + c[17] * v.c;
  y.b = c[4] * v.x + c[9] * v.y + c[13] * v.z + c[16] * v.a + c[18] * v.b + c[19] * v.c;
  y.c = c[5] * v.x + c[10] * v.y + c[14] * v.z + c[17] * v.a + c[19] * v.b + c[20] * v.c;
}

/// Entry of the upper triangle where row and column of a symmetric 6x6 matrix are stored, row <= column.
constexpr int upper_entry(int row, int column) {
  return row * (11 - row) / 2 + column;
}

/// Ends of eight links and the middle of each.
struct Ends8 {
  std::array<float, 8> half_branch[3]; ///< from the first end to the middle
  std::array<std::uint32_t, 8> first, second;
};

/// Eight bonds between particles in single precision, 36 bytes each. With d the half branch and g, w the slip and turn
/// of its ends: force K_t g + stretch (d.g) d, moment B w + twist (d.w) d.
struct BondLinks : Ends8 {
  std::array<float, 8> tangential; ///< K_t
  std::array<float, 8> stretch;    ///< (K_n - K_t) / (L/2)^2
  std::array<float, 8> bending;    ///< B = E_mu I / L
  std::array<float, 8> twist;      ///< (S_n - B) / (L/2)^2

  /// Force and moment of each at its middle, on its first end.
  [[gnu::always_inline]] void pull(const Twist8& strain, Twist8& action) const {
    Float8 dx, dy, dz, k, factor;
    load8(half_branch[0].data(), dx);
    load8(half_branch[1].data(), dy);
    load8(half_branch[2].data(), dz);
    load8(tangential.data(), k);
    load8(stretch.data(), factor);
    const Float8 along = factor * (dx * strain.x + dy * strain.y + dz * strain.z);
    action.x = k * strain.x + along * dx;
    action.y = k * strain.y + along * dy;
    action.z = k * strain.z + along * dz;
    load8(bending.data(), k);
    load8(twist.data(), factor);
    const Float8 about = factor * (dx * strain.a + dy * strain.b + dz * strain.c);
    action.a = k * strain.a + about * dx;
    action.b = k * strain.b + about * dy;
    action.c = k * strain.c + about * dz;
  }
};
static_assert(sizeof(BondLinks) == 8 * 36);

/// Eight links between groups, each all the bonds between them as one stiffness at the middle of its branch: 104 bytes.
struct GroupLinks : Ends8 {
  std::array<float, 168> upper; ///< [21 x 8] see multiply_symmetric()

  [[gnu::always_inline]] void pull(const Twist8& strain, Twist8& action) const {
    multiply_symmetric(upper.data(), strain, action);
  }
};
static_assert(sizeof(GroupLinks) == 8 * 104);

/// Adds what eight links do to their ends.
///
/// @param x_first, x_second  the fields' lines that the numbers of the ends count from
/// @param force              lines that the numbers of the first ends, and of the second where `both`, count from
template <bool both, class Links>
[[gnu::always_inline]] inline void act(const Links& links, const float* x_first, const float* x_second,
                                       float* force) {
  Float8 line[8];
  Twist8 here, there, strain, action;
  for_eight([&](std::size_t k) __attribute__((always_inline)) {
    load8(x_first + 8 * std::size_t{links.first[k]}, line[k]);
  });
  from_lines(line, here);
  for_eight([&](std::size_t k) __attribute__((always_inline)) {
    load8(x_second + 8 * std::size_t{links.second[k]}, line[k]);
  });
  from_lines(line, there);
  Float8 dx, dy, dz;
  load8(links.half_branch[0].data(), dx);
  load8(links.half_branch[1].data(), dy);
  load8(links.half_branch[2].data(), dz);
  const Float8 a = here.a + there.a, b = here.b + there.b, c = here.c + there.c;
  strain.x = there.x - here.x - (b * dz - c * dy);
  strain.y = there.y - here.y - (c * dx - a * dz);
  strain.z = there.z - here.z - (a * dy - b * dx);
  strain.a = there.a - here.a;
  strain.b = there.b - here.b;
  strain.c = there.c - here.c;
  links.pull(strain, action);
  const Float8 couple_x = dy * action.z - dz * action.y, couple_y = dz * action.x - dx * action.z,
               couple_z = dx * action.y - dy * action.x;
  Twist8 end{action.x, action.y, action.z, action.a + couple_x, action.b + couple_y, action.c + couple_z};
  to_lines(end, line);
  for_eight([&](std::size_t k) __attribute__((always_inline)) {
    float* const place = force + 8 * std::size_t{links.first[k]};
    Float8 sum;
    load8(place, sum);
    sum += line[k];
    store8(sum, place);
  });
  if constexpr (both) {
    end.a = action.a - couple_x;
    end.b = action.b - couple_y;
    end.c = action.c - couple_z;
    to_lines(end, line);
    for_eight([&](std::size_t k) __attribute__((always_inline)) {
      float* const place = force + 8 * std::size_t{links.second[k]};
      Float8 sum;
      load8(place, sum);
      sum -= line[k];
      store8(sum, place);
    });
  }
}

/// The links of one block of nodes, in eights: first those within the block, whose ends are both counted from its first
/// node, then those that leave it, whose second end is counted from the level's first node.
template <class Links>
struct LinkBlock {
  const Links* begin;
  const Links* leaving;
  const Links* end;
};

/// Forces of a block's links on its nodes, added to `force`; `block_x` and `force` begin at the block's first node.
template <class Links>
[[gnu::always_inline]] inline void act_all(const LinkBlock<Links>& block, const float* x,
                                           const float* block_x, float* force) {
  constexpr std::ptrdiff_t ahead = 6;
  const auto fetch = [&](const Links* links, const float* from) __attribute__((always_inline)) {
    for_eight([&](std::size_t k) __attribute__((always_inline)) {
      __builtin_prefetch(from + 8 * std::size_t{links->second[k]});
    });
  };
  for (const Links* links = block.begin; links != block.leaving; ++links) {
    fetch(links + (block.leaving - links > ahead ? ahead : 0), block_x);
    act<true>(*links, block_x, block_x, force);
  }
  for (const Links* links = block.leaving; links != block.end; ++links) {
    fetch(links + (block.end - links > ahead ? ahead : 0), x);
    act<false>(*links, block_x, x, force);
  }
}

/// Lines of a field that a relaxation reads and writes, from a block's first node on.
struct RelaxedBlock {
  const float* inverse; ///< [eights x 21 x 8] inverse of the nodes' diagonal blocks
  const float* rhs;
  const float* force; ///< -K x; not read for x = 0
  const float* x;     ///< not read for x = 0
  float* result;
  std::size_t count; ///< nodes; up to seven lines after the last are read
  float gain;
};

/// result = x + gain D^-1 (rhs - K x), or the same from x = 0.
template <bool from_zero>
[[gnu::always_inline]] inline void relax_all(const RelaxedBlock& block) {
  for (std::size_t node = 0; node < block.count; node += 8) {
    Float8 line[8];
    for_eight([&](std::size_t k) __attribute__((always_inline)) {
      load8(block.rhs + 8 * (node + k), line[k]);
      if constexpr (!from_zero) {
        Float8 force;
        load8(block.force + 8 * (node + k), force);
        line[k] += force;
      }
    });
    Twist8 residual, moved;
    from_lines(line, residual);
    multiply_symmetric(block.inverse + 21 * node, residual, moved);
    to_lines(moved, line);
    for_eight([&](std::size_t k) __attribute__((always_inline)) {
      line[k] *= block.gain;
      if constexpr (!from_zero) {
        Float8 x;
        load8(block.x + 8 * (node + k), x);
        line[k] += x;
      }
    });
    for_eight([&](std::size_t k) __attribute__((always_inline)) {
      if (node + k < block.count)
        store8(line[k], block.result + 8 * (node + k));
    });
  }
}

/// The loops as compiled for any processor, and for AVX2.
struct AnyProcessor {
  template <class Links>
  static void act(const LinkBlock<Links>& block, const float* x, const float* block_x, float* force) {
    act_all(block, x, block_x, force);
  }
  static void relax(const RelaxedBlock& block) { relax_all<false>(block); }
  static void relax_zero(const RelaxedBlock& block) { relax_all<true>(block); }
};

#if defined(__x86_64__)
struct Avx2 {
  template <class Links>
  [[gnu::target("avx2")]] static void act(const LinkBlock<Links>& block, const float* x, const float* block_x,
                                          float* force) {
    act_all(block, x, block_x, force);
  }
  [[gnu::target("avx2")]] static void relax(const RelaxedBlock& block) { relax_all<false>(block); }
  [[gnu::target("avx2")]] static void relax_zero(const RelaxedBlock& block) { relax_all<true>(block); }
};

inline bool has_avx2() noexcept {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

/// Calls run with the loops for this processor.
template <class Run>
void with_loops(Run&& run) {
#if defined(__x86_64__)
  if (has_avx2())
    return run(Avx2{});
#endif
  run(AnyProcessor{});
}

} // namespace cdem::integrate::detail
