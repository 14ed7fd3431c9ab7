#pragma once

/// @file
/// What the event-driven dynamics remembers of each sphere, and the memory it lies in.

#include <cdem/core/huge_pages.hpp>
#include <cdem/core/types.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

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

/// Array with one element a sphere.
template <class T>
using SphereArray = std::vector<T, core::HugePageAllocator<T>>;

} // namespace cdem::packing::detail
