#pragma once

/// @file
/// What a stress estimator asks of a tessellation: cells with a volume, that locate points and cut segments.

#include <cdem/geometry/segment.hpp>

#include <concepts>
#include <cstddef>
#include <optional>

namespace cdem::stress::tessellation {

namespace detail {
/// Stands for any callback of for_each_piece in the concept below.
struct AnyPieceCallback {
  void operator()(std::size_t cell, double begin, double end) const;
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

/// `for_each_piece(segment, callback)` calls callback(cell, begin, end) for each piece of the segment, from its start to its
/// end, `begin` < `end` being parts of the segment's length, and returns the part that lies in no cell. (Where a piece lies
/// matters as well as how long it is: a bond's moment varies along it.) Lengths and the returned part add up to 1 but for
/// rounding; a segment inside returns 0, not a rounding of it. A segment that is a point is one piece from 0 to 1.
template <class T>
concept CutsSegments = requires(const T& cells, const geometry::Segment& segment,
                                detail::AnyPieceCallback callback) {
  { cells.for_each_piece(segment, callback) } -> std::same_as<double>;
};

/// Cells (specimens) that fill a domain without overlap. Models: Hexahedra, Wedges, Tetrahedra (structured), Polyhedra
/// (of any mesh).
template <class T>
concept Tessellation = HasCells<T> && LocatesPoints<T> && CutsSegments<T>;

} // namespace cdem::stress::tessellation
