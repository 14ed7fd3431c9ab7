#pragma once

/// @file
/// What a stress estimator asks of a tessellation: cells with a volume, that locate points and share
/// segments.

#include <cdem/geometry/segment.hpp>

#include <concepts>
#include <cstddef>
#include <optional>

namespace cdem::stress::tessellation {

namespace detail {
/// Stands for any callback of for_each_share in the concept below.
struct AnyShareCallback {
  void operator()(std::size_t cell, double fraction) const;
};
} // namespace detail

/// `cell_count()` cells, of `volume(cell)` in m^3.
template <class T>
concept HasCells = requires(const T& cells, std::size_t cell) {
  { cells.cell_count() } -> std::same_as<std::size_t>;
  { cells.volume(cell) } -> std::same_as<double>;
};

/// `locate(point)` names the cell that holds the point, or none. A point on a face shared by several cells
/// belongs to one of them, always the same; a point on the outer face belongs to a cell.
template <class T>
concept LocatesPoints = requires(const T& cells, const Vec3& point) {
  { cells.locate(point) } -> std::same_as<std::optional<std::size_t>>;
};

/// `for_each_share(segment, callback)` calls callback(cell, fraction) for each piece of the segment, fraction
/// being its part of the segment's length, and returns the fraction that lies in no cell. Fractions and the
/// returned part add up to 1 but for rounding; a segment inside returns 0, not a rounding of it. A segment
/// that is a point has the fraction 1.
template <class T>
concept SharesSegments = requires(const T& cells, const geometry::Segment& segment,
                                  detail::AnyShareCallback callback) {
  { cells.for_each_share(segment, callback) } -> std::same_as<double>;
};

/// Cells (specimens) that fill a domain without overlap. Models: Hexahedra.
template <class T>
concept Tessellation = HasCells<T> && LocatesPoints<T> && SharesSegments<T>;

} // namespace cdem::stress::tessellation
