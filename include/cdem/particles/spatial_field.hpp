#pragma once

/// @file
/// Six components a particle: translation and rotation, or force and moment.

#include <cdem/core/types.hpp>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace cdem::particles {

/// A linear and an angular vector of one particle, each padded to four so that one particle fills whole
/// vector registers (one 64-byte cache line in double precision). The padding is zero and stays zero.
///
/// Used for displacement and rotation (m, rad), velocity and angular velocity (m/s, rad/s), force and moment
/// (N, N m).
template <class Real = double>
struct alignas(8 * sizeof(Real)) Spatial {
  Real component[8] = {};

  using Vector = core::Vector3<Real>;

  /// Translation, velocity or force: components 0 to 2.
  Eigen::Map<Vector> linear() noexcept { return Eigen::Map<Vector>(component); }
  Eigen::Map<const Vector> linear() const noexcept { return Eigen::Map<const Vector>(component); }
  /// Rotation, angular velocity or moment.
  Eigen::Map<Vector> angular() noexcept { return Eigen::Map<Vector>(component + 4); }
  Eigen::Map<const Vector> angular() const noexcept { return Eigen::Map<const Vector>(component + 4); }

  /// Degree of freedom `dof`: 0, 1, 2 translate along x, y, z; 3, 4, 5 rotate about x, y, z.
  Real& operator[](int dof) noexcept { return component[slot(dof)]; }
  Real operator[](int dof) const noexcept { return component[slot(dof)]; }

private:
  static constexpr int slot(int dof) noexcept { return dof < 3 ? dof : dof + 1; }
};

/// Allocator of cache-line-aligned memory.
template <class T>
struct CacheAlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{alignof(T) > 64 ? alignof(T) : 64};

  CacheAlignedAllocator() = default;
  template <class U>
  CacheAlignedAllocator(const CacheAlignedAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), alignment)); }
  void deallocate(T* memory, std::size_t) noexcept { ::operator delete(memory, alignment); }
  template <class U>
  bool operator==(const CacheAlignedAllocator<U>&) const noexcept {
    return true;
  }
};

/// [particles] of Spatial, zero when made.
template <class Real = double>
using SpatialField = std::vector<Spatial<Real>, CacheAlignedAllocator<Spatial<Real>>>;

} // namespace cdem::particles
