#pragma once

/// @file
/// The force kernel: four bonds at a time, in 256-bit registers where the processor has them.

#include <cdem/bond/detail/bond_group.hpp>
#include <cdem/core/vector_registers.hpp>

#include <cstddef>
#include <cstring>

namespace cdem::bond::detail {

using core::Four;
using core::load;
using core::store;

// Groups ahead of the one computed that are fetched from memory, and those whose second ends are: the time of one to
// reach the cache (120 ns) is that of some six groups; twice as many are asked for.
inline constexpr std::size_t groups_ahead = 24, ends_ahead = 12;

/// The bonds that act on one block of particles [begin, begin + size).
///
/// A bond with both ends in the block stands in its groups once; one that joins two blocks stands in the groups of both,
/// its first end inside each time. A block takes what falls on its own particles alone: no block waits for another,
/// and sums do not depend on threads.
template <class StiffnessReal>
struct BondBlock {
  const BondGroup<StiffnessReal>* groups; ///< `ends_ahead` more follow, of the next block or idle
  std::size_t count;
  ParticleIndex begin, size;
};

[[gnu::always_inline]] inline void increase(double* place, const Four& by) {
  Four value;
  load(value, place);
  value += by;
  store(place, value);
}

[[gnu::always_inline]] inline void decrease(double* place, const Four& by) {
  Four value;
  load(value, place);
  value -= by;
  store(place, value);
}

/// Three components of four bonds: x, y, z, a lane a bond.
struct Lanes {
  Four x, y, z;
};

[[gnu::always_inline]] inline void add(Lanes& to, const Lanes& a, const Lanes& b) {
  to.x = a.x + b.x, to.y = a.y + b.y, to.z = a.z + b.z;
}
[[gnu::always_inline]] inline void subtract(Lanes& to, const Lanes& a, const Lanes& b) {
  to.x = a.x - b.x, to.y = a.y - b.y, to.z = a.z - b.z;
}
[[gnu::always_inline]] inline void cross(Lanes& to, const Lanes& a, const Lanes& b) {
  to.x = a.y * b.z - a.z * b.y, to.y = a.z * b.x - a.x * b.z, to.z = a.x * b.y - a.y * b.x;
}
/// to = a v + (b (d.v)) d
[[gnu::always_inline]] inline void stretch(Lanes& to, const Four& a, const Four& b, const Lanes& d,
                                           const Lanes& v) {
  const Four along = b * (d.x * v.x + d.y * v.y + d.z * v.z);
  to.x = a * v.x + along * d.x, to.y = a * v.y + along * d.y, to.z = a * v.z + along * d.z;
}

/// Lines of memory (x, y, z, 0) of four particles become lanes.
[[gnu::always_inline]] inline void gather(Lanes& to, const double* a, const double* b, const double* c,
                                          const double* d) {
  using Two = core::Vector<double, 2>;
  const auto pair = [](Four & both, const double* low, const double* high) __attribute__((always_inline)) {
    Two first, second;
    std::memcpy(&first, low, sizeof(first));
    std::memcpy(&second, high, sizeof(second));
    both = __builtin_shufflevector(first, second, 0, 1, 2, 3);
  };
  Four even, odd;
  pair(even, a, c);
  pair(odd, b, d);
  to.x = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
  to.y = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
  pair(even, a + 2, c + 2);
  pair(odd, b + 2, d + 2);
  to.z = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
}

/// Lanes become lines (x, y, z, 0).
[[gnu::always_inline]] inline void spread(Four line[4], const Lanes& from) {
  const Four zero = {0, 0, 0, 0};
  const Four xy_even = __builtin_shufflevector(from.x, from.y, 0, 4, 2, 6);
  const Four xy_odd = __builtin_shufflevector(from.x, from.y, 1, 5, 3, 7);
  const Four z_even = __builtin_shufflevector(from.z, zero, 0, 4, 2, 6);
  const Four z_odd = __builtin_shufflevector(from.z, zero, 1, 5, 3, 7);
  line[0] = __builtin_shufflevector(xy_even, z_even, 0, 1, 4, 5);
  line[1] = __builtin_shufflevector(xy_odd, z_odd, 0, 1, 4, 5);
  line[2] = __builtin_shufflevector(xy_even, z_even, 2, 3, 6, 7);
  line[3] = __builtin_shufflevector(xy_odd, z_odd, 2, 3, 6, 7);
}

/// Calls body(0) to body(3); written out, as compilers do not unroll such a loop at -O2.
template <class Body>
[[gnu::always_inline]] inline void for_each_lane(Body&& body) {
  body(0), body(1), body(2), body(3);
}

/// Asks for an object's memory ahead of its use.
template <class T>
[[gnu::always_inline]] inline void prefetch(const T* object) {
  for (std::size_t line = 0; line < sizeof(T); line += 64)
    __builtin_prefetch(reinterpret_cast<const char*>(object) + line);
}

/// Adds the bonds' forces on a block's particles.
///
/// @param force  [size] N, N m, added to
template <class StiffnessReal>
[[gnu::always_inline]] inline void add_forces_inline(const BondBlock<StiffnessReal>& block,
                                                     const particles::Spatial<>* displacement,
                                                     particles::Spatial<>* force) {
  constexpr int angular = 4;      // where rotations and moments begin in a Spatial
  particles::Spatial<> elsewhere; // takes what falls on other blocks
  const BondGroup<StiffnessReal>* const end = block.groups + block.count;
  for (const BondGroup<StiffnessReal>* group = block.groups; group != end; ++group) {
    const BondGroup<StiffnessReal>& bonds = *group;
    prefetch(group + groups_ahead); // beyond the end of the array, nothing happens
    const BondGroup<StiffnessReal>& ahead = group[ends_ahead];
    const double* u[4];
    const double* v[4];
    for_each_lane([&](int lane) __attribute__((always_inline)) {
      __builtin_prefetch(displacement + ahead.second[lane]);
      u[lane] = displacement[bonds.first[lane]].component;
      v[lane] = displacement[bonds.second[lane]].component;
    });
    Lanes d, from, to, slip, turn, sum, lever;
    load(d.x, bonds.half_branch[0]);
    load(d.y, bonds.half_branch[1]);
    load(d.z, bonds.half_branch[2]);
    gather(from, u[0] + angular, u[1] + angular, u[2] + angular, u[3] + angular);
    gather(to, v[0] + angular, v[1] + angular, v[2] + angular, v[3] + angular);
    add(sum, from, to);
    subtract(turn, to, from);
    gather(from, u[0], u[1], u[2], u[3]);
    gather(to, v[0], v[1], v[2], v[3]);
    subtract(slip, to, from);
    cross(lever, sum, d);
    subtract(slip, slip, lever);

    Four tangential, along, bending, twist;
    load(tangential, bonds.tangential);
    load(along, bonds.stretch);
    load(bending, bonds.bending);
    load(twist, bonds.twist);
    Lanes pull, moment, couple, on_first, on_second;
    stretch(pull, tangential, along, d, slip);
    stretch(moment, bending, twist, d, turn);
    const Lanes shear{tangential * slip.x, tangential * slip.y, tangential * slip.z};
    cross(couple, d, shear);
    add(on_first, couple, moment);
    subtract(on_second, couple, moment);

    Four pulls[4], moments_first[4], moments_second[4];
    spread(pulls, pull);
    spread(moments_first, on_first);
    spread(moments_second, on_second);
    for_each_lane([&](int lane) __attribute__((always_inline)) {
      const ParticleIndex second = bonds.second[lane] - block.begin; // wraps around for one before the block
      double* const i = force[bonds.first[lane] - block.begin].component;
      double* const j = (second < block.size ? force + second : &elsewhere)->component;
      increase(i, pulls[lane]);
      increase(i + angular, moments_first[lane]);
      decrease(j, pulls[lane]);
      increase(j + angular, moments_second[lane]);
    });
  }
}

/// add_forces_inline() for any processor.
template <class StiffnessReal>
void add_forces_portable(const BondBlock<StiffnessReal>& block, const particles::Spatial<>* displacement,
                         particles::Spatial<>* force) {
  add_forces_inline(block, displacement, force);
}

#if defined(__x86_64__)

/// add_forces_inline() for AVX2.
template <class StiffnessReal>
[[gnu::target("avx2")]] void add_forces_avx2(const BondBlock<StiffnessReal>& block,
                                             const particles::Spatial<>* displacement,
                                             particles::Spatial<>* force) {
  add_forces_inline(block, displacement, force);
}

#endif

/// add_forces_inline() by the best means of this processor.
template <class StiffnessReal>
void add_forces(const BondBlock<StiffnessReal>& block, const particles::Spatial<>* displacement,
                particles::Spatial<>* force) {
#if defined(__x86_64__)
  if (core::has_avx2())
    return add_forces_avx2(block, displacement, force);
#endif
  add_forces_portable(block, displacement, force);
}

} // namespace cdem::bond::detail
