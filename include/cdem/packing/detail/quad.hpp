#pragma once

/// @file
/// Four numbers that fill a vector register.

#include <cdem/core/vector_registers.hpp>

namespace cdem::packing::detail {

/// Four numbers as they lie in memory: x, y, z and a fourth that goes with them.
template <class Real>
struct alignas(4 * sizeof(Real)) QuadOf {
  Real component[4] = {0, 0, 0, 0};

  Real& operator[](int k) { return component[k]; }
  Real operator[](int k) const { return component[k]; }
};

using Quad = QuadOf<double>;
/// For what need not be more precise than a part in 10^7 of itself: half the memory.
using ShortQuad = QuadOf<float>;

using core::load;
using core::store;

template <class Real>
[[gnu::always_inline]] inline void load(core::Four& to, const QuadOf<Real>& from) {
  load(to, from.component);
}
template <class Real>
[[gnu::always_inline]] inline void store(QuadOf<Real>& to, const core::Four& from) {
  store(to.component, from);
}

/// Brings each of the four differences of coordinates in the unit cube to the nearest periodic image.
[[gnu::always_inline]] inline void wrap(core::Four& difference) {
  constexpr double round = 0x1.8p52; // adding it leaves no bits for the fraction
  difference -= (difference + round) - round;
}

} // namespace cdem::packing::detail
