#pragma once

/// @file
/// A straight piece between two points.

#include <cdem/core/types.hpp>

namespace cdem::geometry {

/// Segment from `start` to `start + extent`, in m; at(0) and at(1) are its ends.
struct Segment {
  Vec3 start = Vec3::Zero();
  Vec3 extent = Vec3::Zero();

  Vec3 at(double parameter) const { return start + parameter * extent; }
};

} // namespace cdem::geometry
