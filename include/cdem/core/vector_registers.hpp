#pragma once

/// @file
/// Four doubles side by side, and whether this processor has registers for them. With the vector types of GCC and
/// Clang, code is written once and compiled for any processor and, by [[gnu::target("avx2")]], for AVX2, whatever
/// the flags of the translation unit. No fused multiply-add is asked for: both give the same bits, unless the whole unit
/// is compiled for it (-march=native), when the compiler may fuse and last digits change.

#include <cstddef>
#include <cstring>

namespace cdem::core {

template <class Real, std::size_t count>
using Vector [[gnu::vector_size(count * sizeof(Real))]] = Real;

/// One 256-bit register.
using Four = Vector<double, 4>;

// By reference: a function that returns such a type has another calling convention on processors without AVX.

/// @param from  4 numbers, anywhere
[[gnu::always_inline]] inline void load(Four& to, const double* from) {
  std::memcpy(&to, from, sizeof(to));
}
[[gnu::always_inline]] inline void load(Four& to, const float* from) {
  Vector<float, 4> narrow;
  std::memcpy(&narrow, from, sizeof(narrow));
  to = __builtin_convertvector(narrow, Four);
}
[[gnu::always_inline]] inline void store(double* to, const Four& from) {
  std::memcpy(to, &from, sizeof(from));
}
[[gnu::always_inline]] inline void store(float* to, const Four& from) {
  const Vector<float, 4> narrow = __builtin_convertvector(from, Vector<float, 4>);
  std::memcpy(to, &narrow, sizeof(narrow));
}

/// Sum of the four, pairs first.
[[gnu::always_inline]] inline double sum(const Four& v) {
  return (v[0] + v[1]) + (v[2] + v[3]);
}

#if defined(__x86_64__)
/// Whether this processor has AVX2.
inline bool has_avx2() noexcept {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

} // namespace cdem::core
