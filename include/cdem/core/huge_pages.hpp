#pragma once

/// @file
/// Memory of large arrays that are read at random.

#include <algorithm>
#include <cstddef>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace cdem::core {

/// Allocator of cache-line-aligned memory. On Linux an array of some megabytes asks for pages of 2 MB: one that is read at
/// random would, in pages of 4 kB, miss the address cache at almost every read.
template <class T>
struct HugePageAllocator {
  using value_type = T;

  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>&) noexcept {}

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
  bool operator==(const HugePageAllocator<U>&) const noexcept {
    return true;
  }

private:
  static constexpr std::size_t huge_page = std::size_t{2} << 20, large = 2 * huge_page;
  static std::align_val_t alignment_of(std::size_t bytes) noexcept {
    return std::align_val_t{bytes >= large ? huge_page : std::max<std::size_t>(64, alignof(T))};
  }
};

} // namespace cdem::core
