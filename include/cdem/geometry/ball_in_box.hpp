#pragma once

/// @file
/// Volume of a ball cut by the walls of a box.

#include <cdem/geometry/box.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace cdem::geometry {

namespace detail {

/// Volume of {u > x, v > y, w > 0} in a ball of radius R around the origin, x, y >= 0: an antiderivative of the area of the slices
/// across u, between x and sqrt(R^2 - y^2).
inline double beyond_edge(double R, double x, double y) {
  const double square = R * R - y * y; // of the largest u
  if (!(x * x < square))
    return 0;
  const double s = std::sqrt(square - x * x), rho = std::sqrt(R * R - x * x);
  const double plane = y * (R * R - y * y / 3), ball = 2.0 / 3 * R * R * R;
  const double at_end = (ball - plane) * std::numbers::pi / 2;
  const double at_x = (R * R - x * x / 3) * x * std::acos(std::min(1.0, y / rho)) - 2.0 / 3 * x * y * s -
                      plane * std::asin(std::min(1.0, x / std::sqrt(square))) +
                      ball * std::atan2(x * y, R * s);
  return 0.5 * (at_end - at_x);
}

/// Volume of [0, x] x [0, y] x [0, z] in a ball of radius R around the origin: an eighth of the ball without the parts beyond the
/// three planes, where those beyond two of them have been taken away twice.
inline double octant(double R, double x, double y, double z) {
  if (x * x + y * y + z * z <= R * R)
    return x * y * z;
  const auto beyond_plane = [R](double distance) {
    const double height = std::max(0.0, R - distance);
    return std::numbers::pi / 12 * height * height * (2 * R + distance);
  };
  return std::numbers::pi / 6 * R * R * R - beyond_plane(x) - beyond_plane(y) - beyond_plane(z) +
         beyond_edge(R, x, y) + beyond_edge(R, y, z) + beyond_edge(R, z, x);
}

} // namespace detail

/// Volume of the part of a ball that lies between the walls of a box, m^3; periodic directions have none. Exact, but for rounding.
///
/// @param centre  inside the walls
/// @param radius  above 0, m
inline double volume_in_box(const Vec3& centre, double radius, const Box& box) {
  std::array<std::array<double, 2>, 3> distance{}; // of the walls
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    distance[k] = {centre[axis] - box.lower[axis], box.upper[axis] - centre[axis]};
    for (double& d : distance[k])
      d = box.periodic[k] ? radius : std::clamp(d, 0.0, radius);
  }
  double volume = 0;
  for (const double x : distance[0])
    for (const double y : distance[1])
      for (const double z : distance[2])
        volume += detail::octant(radius, x, y, z);
  return volume;
}

} // namespace cdem::geometry
