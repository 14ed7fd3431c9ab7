#pragma once

/// @file
/// Four numbers that fill a vector register.

namespace cdem::packing::detail {

/// Four numbers as they lie in memory: x, y, z and a fourth that goes with them.
struct alignas(32) Quad {
  double component[4] = {0, 0, 0, 0};

  double& operator[](int k) { return component[k]; }
  double operator[](int k) const { return component[k]; }
};

/// Four numbers in a register (two of 128 bits where the processor has no longer ones).
typedef double Lanes __attribute__((vector_size(32))); // NOLINT: an attribute of a type cannot follow `using`

} // namespace cdem::packing::detail
