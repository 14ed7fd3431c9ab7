#pragma once

/// @file
/// The rectangular domain, periodic or walled in each direction.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <array>
#include <cmath>

namespace cdem::geometry {

/// Rectangular box [lower, upper], in m; each direction is periodic or bounded by two flat walls.
struct Box {
  Vec3 lower = Vec3::Zero();
  Vec3 upper = Vec3::Ones();
  std::array<bool, 3> periodic{false, false, false};

  /// Cube [0, side]^3.
  /// @throws core::InvalidInput if side is not a finite positive number
  static Box cube(double side, bool is_periodic) {
    core::expect_positive(side, "side of the box", "m");
    return {Vec3::Zero(), Vec3::Constant(side), {is_periodic, is_periodic, is_periodic}};
  }

  /// Edge lengths, m.
  Vec3 size() const { return upper - lower; }
  /// Volume, m^3.
  double volume() const { return size().prod(); }

  /// Vector `d` between two points brought to the nearest periodic image; unchanged in walled directions.
  Vec3 minimum_image(Vec3 d) const {
    for (int k = 0; k < 3; ++k)
      if (periodic[static_cast<std::size_t>(k)]) {
        const double length = upper[k] - lower[k];
        d[k] -= length * std::round(d[k] / length);
      }
    return d;
  }

  /// Point brought into [lower, upper) in the periodic directions.
  Vec3 wrap(Vec3 point) const {
    for (int k = 0; k < 3; ++k)
      if (periodic[static_cast<std::size_t>(k)]) {
        const double length = upper[k] - lower[k];
        point[k] -= length * std::floor((point[k] - lower[k]) / length);
        if (point[k] >= upper[k]) // rounding of a point just below `lower`
          point[k] = lower[k];
      }
    return point;
  }

  /// The same box with its six faces open: what is left when a body is cut out of a periodic packing.
  Box without_periodicity() const { return {lower, upper, {false, false, false}}; }

  /// @throws core::InvalidInput if an edge is not a finite positive length
  void validate() const {
    for (int k = 0; k < 3; ++k)
      core::expect_positive(upper[k] - lower[k], std::string("edge of the box along ") + "xyz"[k], "m");
  }
};

} // namespace cdem::geometry
