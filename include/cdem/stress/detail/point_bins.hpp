#pragma once

/// @file
/// Points sorted into the cells of a uniform grid, to find those near a place.

#include <cdem/geometry/box.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cdem::stress::detail {

/// Numbers of points by the bin that holds them, each bin's in increasing order: finding them does not depend on threads.
class PointBins {
public:
  /// @param box    the bins fill it; points beyond a wall count to the bins there, in a periodic direction they are wrapped
  /// @param reach  how far will be searched, m: the bins are made for it, about one point a bin at least
  /// @param point  point(i) for i < count
  /// @complexity   O(points), 8 bytes a point and a bin
  template <class Point>
  PointBins(const geometry::Box& box, std::size_t count, double reach, Point&& point) : box_(box) {
    const double spacing = std::cbrt(box.volume() / static_cast<double>(std::max<std::size_t>(count, 1)));
    const double edge = std::max(reach / 4, spacing);
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = box.size()[static_cast<Eigen::Index>(k)];
      bins_[k] = static_cast<std::int64_t>(std::clamp(std::floor(length / edge), 1.0, 1e5));
      scale_[static_cast<Eigen::Index>(k)] = static_cast<double>(bins_[k]) / length;
    }
    begin_.assign(static_cast<std::size_t>(bins_[0] * bins_[1] * bins_[2]) + 1, 0);
    const auto bin_of = [&](std::size_t i) {
      std::array<std::int64_t, 3> place{};
      const Vec3 x = point(i);
      for (std::size_t k = 0; k < 3; ++k)
        place[k] = in_grid(k, place_of(k, x[static_cast<Eigen::Index>(k)]));
      return index(place[0], place[1], place[2]);
    };
    for (std::size_t i = 0; i < count; ++i)
      ++begin_[bin_of(i) + 1];
    for (std::size_t b = 1; b < begin_.size(); ++b)
      begin_[b] += begin_[b - 1];
    points_.resize(count);
    std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < count; ++i)
      points_[next[bin_of(i)]++] = i;
  }

  /// Calls visit(i) once for each point of the bins that come within `reach` of a place: all the points so near, and others.
  template <class Visit>
  void for_each_near(const Vec3& place, double reach, Visit&& visit) const {
    std::array<std::int64_t, 3> first{}, last{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = place[static_cast<Eigen::Index>(k)];
      first[k] = place_of(k, x - reach);
      last[k] = place_of(k, x + reach);
      if (box_.periodic[k])
        last[k] = std::min(last[k], first[k] + bins_[k] - 1); // each once
      else
        first[k] = in_grid(k, first[k]), last[k] = in_grid(k, last[k]);
    }
    for (std::int64_t z = first[2]; z <= last[2]; ++z)
      for (std::int64_t y = first[1]; y <= last[1]; ++y)
        for (std::int64_t x = first[0]; x <= last[0]; ++x) {
          const std::size_t bin = index(in_grid(0, x), in_grid(1, y), in_grid(2, z));
          for (std::uint64_t k = begin_[bin]; k < begin_[bin + 1]; ++k)
            visit(static_cast<std::size_t>(points_[k]));
        }
  }

private:
  std::int64_t place_of(std::size_t k, double x) const {
    const auto axis = static_cast<Eigen::Index>(k);
    return static_cast<std::int64_t>(
        std::clamp(std::floor((x - box_.lower[axis]) * scale_[axis]), -1e15, 1e15));
  }
  std::int64_t in_grid(std::size_t k, std::int64_t place) const {
    if (!box_.periodic[k])
      return std::clamp(place, std::int64_t{0}, bins_[k] - 1);
    const std::int64_t rest = place % bins_[k];
    return rest < 0 ? rest + bins_[k] : rest;
  }
  std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>(x + bins_[0] * (y + bins_[1] * z));
  }

  geometry::Box box_;
  std::array<std::int64_t, 3> bins_{};
  Vec3 scale_ = Vec3::Ones();        ///< bins a metre
  std::vector<std::uint64_t> begin_; ///< [bins + 1] into points_
  std::vector<std::uint64_t> points_;
};

} // namespace cdem::stress::detail
