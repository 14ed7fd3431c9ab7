#pragma once

/// @file
/// What the event-driven dynamics remembers of each sphere, and the memory it lies in.

#include <cdem/core/types.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace cdem::packing::detail {

inline constexpr double never = std::numeric_limits<double>::infinity();

/// A sphere's next event. One with a sphere holds if that sphere's next event is the same; otherwise the sphere looks
/// again when the time has come.
struct Event {
  double time = never;
  ParticleIndex partner = 0xffffffffU; ///< a sphere, or one of the numbers in SphereCollisions
};

/// What predictions read of a sphere: one cache line.
///
/// The centre is where the sphere would have been at time 0 on its present path, so that no local time is needed.
struct alignas(64) Body {
  Vec3 origin;         ///< centre at time 0
  double next = never; ///< time of its next event
  Vec3 velocity;
  double size = 0; ///< radius at scale 1

  Vec3 centre_at(double now) const { return origin + velocity * now; }
  /// Changes the velocity, the centre at `now` staying where it is.
  void push(const Vec3& change, double now) {
    velocity += change;
    origin -= change * now;
  }
};

/// Allocates large arrays in pages of 2 MB where Linux has them: they are read at random, and a page table of 4 kB
/// pages would be read with them.
template <class T>
struct HugePages {
  using value_type = T;
  static constexpr std::size_t page = std::size_t{1} << 21;

  HugePages() = default;
  template <class U>
  HugePages(const HugePages<U>&) noexcept {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    void* const memory = ::operator new(bytes, alignment(bytes));
#ifdef __linux__
    if (bytes >= page)
      ::madvise(memory, bytes, MADV_HUGEPAGE); // a wish: nothing is lost if it is not granted
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    ::operator delete(memory, alignment(count * sizeof(T)));
  }
  friend bool operator==(const HugePages&, const HugePages&) noexcept {
    return true;
  }

private:
  static std::align_val_t alignment(std::size_t bytes) {
    return std::align_val_t{bytes >= page ? page : std::size_t{64}};
  }
};

/// Array with one element a sphere.
template <class T>
using SphereArray = std::vector<T, HugePages<T>>;

} // namespace cdem::packing::detail
