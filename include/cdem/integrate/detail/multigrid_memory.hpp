#pragma once

/// @file
/// Memory of the static multigrid's arrays.

#include <cdem/particles/spatial_field.hpp>

#include <algorithm>
#include <cstddef>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace cdem::integrate::detail {

/// Allocator of cache-line-aligned memory. On Linux an array of some megabytes asks for huge pages: the levels are
/// swept and gathered from hundreds of times, and small pages would cost a miss of the address cache at each gather.
template <class T>
struct LevelAllocator {
  using value_type = T;

  LevelAllocator() = default;
  template <class U>
  LevelAllocator(const LevelAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    void* const memory = ::operator new(bytes, alignment_of(bytes));
#ifdef __linux__
    if (bytes >= large)
      madvise(memory, bytes, MADV_HUGEPAGE); // a wish: whether it is granted changes the speed alone
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    ::operator delete(memory, alignment_of(count * sizeof(T)));
  }
  template <class U>
  bool operator==(const LevelAllocator<U>&) const noexcept {
    return true;
  }

private:
  static constexpr std::size_t huge_page = std::size_t{2} << 20, large = 2 * huge_page;
  static std::align_val_t alignment_of(std::size_t bytes) noexcept {
    return std::align_val_t{bytes >= large ? huge_page : std::max<std::size_t>(64, alignof(T))};
  }
};

template <class T>
using LevelArray = std::vector<T, LevelAllocator<T>>;

/// Translation and rotation of nodes in single precision, a line of 32 bytes each.
using Field = LevelArray<particles::Spatial<float>>;

} // namespace cdem::integrate::detail
