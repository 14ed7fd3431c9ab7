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

/// Points in the order of the bins that hold them, each bin's in increasing order: finding them does not depend on threads.
class PointBins {
public:
  /// @param box    the bins fill it; points beyond a wall count to the bins there, in a periodic direction they are wrapped
  /// @param reach  how far will be searched, m: the bins are made for it, with one point each or more in the mean
  /// @param point  point(i) for i < count
  /// @complexity   O(points), 8 bytes a point and a bin
  template <class Point>
  PointBins(const geometry::Box& box, std::size_t count, double reach, Point&& point) : box_(box) {
    const double spacing = std::cbrt(box.volume() / static_cast<double>(std::max<std::size_t>(count, 1)));
    const double edge = std::max(reach / 4, spacing);
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = box.size()[static_cast<Eigen::Index>(k)];
      bins_[k] = static_cast<std::int64_t>(std::clamp(std::floor(length / edge), 1.0, 1e5));
      scale_[k] = static_cast<double>(bins_[k]) / length;
    }
    begin_.assign(static_cast<std::size_t>(bins_[0] * bins_[1] * bins_[2]) + 1, 0);
    const auto bin_of = [&](std::size_t i) {
      const Vec3 x = point(i);
      return index(in_grid(0, place_of(0, x[0])), in_grid(1, place_of(1, x[1])),
                   in_grid(2, place_of(2, x[2])));
    };
    for (std::size_t i = 0; i < count; ++i)
      ++begin_[bin_of(i) + 1];
    for (std::size_t b = 1; b < begin_.size(); ++b)
      begin_[b] += begin_[b - 1];
    order_.resize(count);
    std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < count; ++i)
      order_[next[bin_of(i)]++] = i;
  }

  /// [points] which point comes at each place of the order.
  const std::vector<std::uint64_t>& order() const noexcept { return order_; }

  /// Calls visit(begin, end) for stretches of the order that hold, each once, all the points within `reach` of a place, and some
  /// others. In a periodic direction any image counts.
  template <class Visit>
  void for_each_stretch(const Vec3& place, double reach, Visit&& visit) const {
    const Range rows = range_of(1, place[1], reach), layers = range_of(2, place[2], reach);
    for (std::int64_t z = layers.first; z <= layers.last; ++z) {
      const double across = layers.whole ? 0 : distance(2, z, place[2]);
      for (std::int64_t y = rows.first; y <= rows.last; ++y) {
        const double along = rows.whole ? 0 : distance(1, y, place[1]);
        const double square = reach * reach * (1 + 1e-12) - across * across - along * along;
        if (square < 0)
          continue;
        const Range row = range_of(0, place[0], std::sqrt(square));
        const std::int64_t first = in_grid(0, row.first), count = row.last - row.first + 1;
        const std::int64_t before_end = std::min(count, bins_[0] - first); // the rest begins the row again
        const std::size_t start = index(0, in_grid(1, y), in_grid(2, z));
        const auto stretch = [&](std::int64_t from, std::int64_t bins) {
          const std::size_t bin = start + static_cast<std::size_t>(from);
          visit(begin_[bin], begin_[bin + static_cast<std::size_t>(bins)]);
        };
        stretch(first, before_end);
        if (count > before_end)
          stretch(0, count - before_end);
      }
    }
  }

private:
  /// Bins along an axis; not yet brought into the grid where it is periodic.
  struct Range {
    std::int64_t first, last;
    bool whole; ///< all of a periodic direction
  };

  Range range_of(std::size_t k, double x, double reach) const {
    Range range{place_of(k, x - reach), place_of(k, x + reach), false};
    if (!box_.periodic[k])
      return {in_grid(k, range.first), in_grid(k, range.last), false};
    if (range.last >= range.first + bins_[k] - 1)
      return {range.first, range.first + bins_[k] - 1, true};
    return range;
  }
  /// From a coordinate to a bin; those at a wall hold what lies behind it too.
  double distance(std::size_t k, std::int64_t bin, double x) const {
    const double below = box_.lower[static_cast<Eigen::Index>(k)] + static_cast<double>(bin) / scale_[k];
    const double above = below + 1 / scale_[k];
    const bool open_below = !box_.periodic[k] && bin == 0,
               open_above = !box_.periodic[k] && bin == bins_[k] - 1;
    return std::max({0.0, open_below ? 0.0 : below - x, open_above ? 0.0 : x - above});
  }
  std::int64_t place_of(std::size_t k, double x) const {
    const double place = (x - box_.lower[static_cast<Eigen::Index>(k)]) * scale_[k];
    return static_cast<std::int64_t>(std::clamp(std::floor(place), -1e15, 1e15));
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
  std::array<double, 3> scale_{};    ///< bins a metre
  std::vector<std::uint64_t> begin_; ///< [bins + 1] into order_
  std::vector<std::uint64_t> order_;
};

} // namespace cdem::stress::detail
