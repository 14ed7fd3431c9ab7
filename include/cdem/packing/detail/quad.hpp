#pragma once

/// @file
/// Four numbers that fill a vector register.

#include <cdem/core/vector_registers.hpp>

namespace cdem::packing::detail {

/// Four numbers as they lie in memory: x, y, z and a fourth that goes with them.
struct alignas(32) Quad {
  double component[4] = {0, 0, 0, 0};

  double& operator[](int k) { return component[k]; }
  double operator[](int k) const { return component[k]; }
};

using core::Four;
using core::load;
using core::store;

[[gnu::always_inline]] inline void load(Four& to, const Quad& from) {
  load(to, from.component);
}
[[gnu::always_inline]] inline void store(Quad& to, const Four& from) {
  store(to.component, from);
}

/// Brings each of the four differences of coordinates in the unit cube to the nearest periodic image.
[[gnu::always_inline]] inline void wrap(Four& difference) {
  constexpr double round = 0x1.8p52; // adding it leaves no bits for the fraction
  difference -= (difference + round) - round;
}

} // namespace cdem::packing::detail
