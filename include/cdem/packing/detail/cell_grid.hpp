#pragma once

/// @file
/// Points of the unit cube sorted into cubic cells, for searches around a point.

#include <cdem/core/huge_pages.hpp>
#include <cdem/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cdem::packing::detail {

/// No sphere: the end of a list.
inline constexpr ParticleIndex no_sphere = 0xffffffffU;

/// Whole number nearest to x, |x| < 2^51: adding 3 * 2^51 leaves no bits for the fraction. std::round would be a call.
inline double nearest_integer(double x) {
  constexpr double shift = 0x1.8p52;
  return (x + shift) - shift;
}

/// Vector between two points of the unit cube brought to the nearest periodic image.
inline Vec3 nearest_image(const Vec3& d) {
  return {d[0] - nearest_integer(d[0]), d[1] - nearest_integer(d[1]), d[2] - nearest_integer(d[2])};
}

/// Cells of the unit cube, each a doubly linked list of spheres: a sphere comes and goes in constant time.
class CellGrid {
public:
  /// @param spheres   numbers go from 0 to spheres - 1
  /// @param edge      wanted edge of a cell; the cells are a little larger
  /// @param periodic  whether a search goes on beyond a face at the opposite one
  CellGrid(std::size_t spheres, double edge, bool periodic)
      : periodic_(periodic), cells_(static_cast<int>(std::clamp(1 / edge, 1.0, 1000.0))), links_(spheres) {
    const auto n = static_cast<std::size_t>(cells_);
    first_.assign(n * n * n, no_sphere);
  }

  /// Number of the cell that holds a point of the unit cube; points a rounding outside belong to the nearest cell.
  std::size_t cell_of(const Vec3& point) const {
    return index(clamped(point[0]), clamped(point[1]), clamped(point[2]));
  }
  std::size_t size() const noexcept { return first_.size(); }

  /// Puts a sphere that is in no cell into that of `point`.
  void insert(ParticleIndex sphere, const Vec3& point) {
    ParticleIndex& first = first_[cell_of(point)];
    links_[sphere] = {first, no_sphere};
    if (first != no_sphere)
      links_[first].previous = sphere;
    first = sphere;
  }

  /// Takes out a sphere that was inserted at `point`.
  void remove(ParticleIndex sphere, const Vec3& point) {
    const Links links = links_[sphere];
    if (links.next != no_sphere)
      links_[links.next].previous = links.previous;
    if (links.previous != no_sphere)
      links_[links.previous].next = links.next;
    else
      first_[cell_of(point)] = links.next;
  }

  /// Takes out all the spheres.
  void clear() { std::fill(first_.begin(), first_.end(), no_sphere); }

  /// Calls visit(sphere) once for each sphere whose point may be closer than `reach` to `point` (and for some
  /// further ones), until a call returns false. @return whether no call did
  template <class Visit>
  bool visit_near(const Vec3& point, double reach, Visit&& visit) const {
    const Range x = range(point[0], reach), y = range(point[1], reach), z = range(point[2], reach);
    for (int c = z.begin; c != z.end; ++c)
      for (int b = y.begin; b != y.end; ++b)
        for (int a = x.begin; a != x.end; ++a)
          for (ParticleIndex s = first_[index(wrapped(a), wrapped(b), wrapped(c))]; s != no_sphere;
               s = links_[s].next)
            if (!visit(s))
              return false;
    return true;
  }

private:
  struct Links {
    ParticleIndex next, previous;
  };
  struct Range {
    int begin, end;
  };

  int clamped(double coordinate) const {
    return std::clamp(static_cast<int>(coordinate * cells_), 0, cells_ - 1);
  }
  int wrapped(int a) const { return a < 0 ? a + cells_ : (a >= cells_ ? a - cells_ : a); }
  std::size_t index(int a, int b, int c) const {
    const auto n = static_cast<std::size_t>(cells_);
    return (static_cast<std::size_t>(c) * n + static_cast<std::size_t>(b)) * n + static_cast<std::size_t>(a);
  }
  Range range(double coordinate, double reach) const {
    const int begin = static_cast<int>(std::floor(std::max((coordinate - reach) * cells_, -1.0 * cells_)));
    const int end = static_cast<int>(std::floor(std::min((coordinate + reach) * cells_, 2.0 * cells_))) + 1;
    if (!periodic_)
      return {std::clamp(begin, 0, cells_ - 1), std::clamp(end, 1, cells_)};
    return end - begin < cells_ ? Range{begin, end} : Range{0, cells_};
  }

  bool periodic_;
  int cells_;
  std::vector<ParticleIndex, core::HugePageAllocator<ParticleIndex>> first_; ///< [cells] a sphere of the cell
  std::vector<Links, core::HugePageAllocator<Links>> links_; ///< [spheres] the others of its cell
};

} // namespace cdem::packing::detail
