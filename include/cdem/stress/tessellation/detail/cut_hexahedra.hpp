#pragma once

/// @file
/// The hexahedra of a grid, each cut alike by planes through its corners.

#include <cdem/stress/tessellation/hexahedra.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace cdem::stress::tessellation::detail {

/// Where Hexahedra::cell_corners() lists the corner whose bits say which of x (1), y (2), z (4) are high.
constexpr std::size_t vtk_corner(unsigned bits) {
  constexpr std::array<std::size_t, 8> place{0, 1, 3, 2, 4, 5, 7, 6};
  return place[bits];
}

/// Cells of equal volume, `Cut::parts` to a hexahedron, found from the side on which a point lies of each of the cut's planes.
///
/// No list of cells is kept and none is searched: the grid gives a segment's pieces, the planes cut each of these further. So
/// the pieces add up as those of the grid do, and a segment may re-enter through periodic faces.
/// @tparam Cut  parts, planes, and of the coordinates within a hexahedron: sides(local), linear; part(sides); corners(part, ...)
template <class Cut>
class CutHexahedra {
public:
  CutHexahedra(Hexahedra grid, Cut cut) : grid_(std::move(grid)), cut_(cut) {}

  /// The hexahedra that are cut.
  const Hexahedra& grid() const noexcept { return grid_; }
  std::size_t cell_count() const noexcept { return Cut::parts * grid_.cell_count(); }
  /// Volume of a cell, m^3: the same for all.
  double volume(std::size_t) const noexcept { return grid_.volume(0) / double{Cut::parts}; }

  /// Mean specimen length: the largest distance between two corners of a cell, in units of the cube root of the box's volume,
  /// [L17] section 2.5. A diagonal of the hexahedron belongs to every part of it.
  double mean_specimen_length() const { return grid_.mean_specimen_length(); }

  /// Cell that holds a point; none for a point outside the walls (or not finite).
  std::optional<std::size_t> locate(const Vec3& point) const {
    const std::optional<std::size_t> whole = grid_.locate(point);
    if (!whole)
      return std::nullopt;
    return Cut::parts * *whole + cut_.part(cut_.sides(grid_.local(*whole, point)));
  }

  /// Calls callback(cell, begin, end) for each piece of the segment, and returns the part outside the walls; see
  /// CutsSegments. A piece in a plane of the cut goes to the part that holds the plane.
  /// @complexity O(cells met)
  template <class Callback>
  double for_each_piece(const geometry::Segment& segment, Callback&& callback) const {
    return grid_.for_each_piece(segment, [&](std::size_t whole, double begin, double end) {
      // The middle tells which periodic image this is; the ends may lie on a face, which belongs to two.
      const Vec3 middle = grid_.local(whole, segment.at(0.5 * (begin + end)));
      const Vec3 half = (0.5 * (end - begin)) * segment.extent.cwiseQuotient(grid_.cell_size());
      cut_piece(Cut::parts * whole, cut_.sides(middle - half), cut_.sides(middle + half), begin, end,
                callback);
    });
  }

  /// Corners of the cells, m, each once: those of the hexahedra.
  std::vector<Vec3> corner_points() const { return grid_.corner_points(); }

  /// [cells] numbers of each cell's corners in corner_points(), in VTK's order.
  std::vector<typename Cut::Corners> cell_corners() const {
    std::vector<typename Cut::Corners> cells;
    cells.reserve(cell_count());
    for (const auto& hexahedron : grid_.cell_corners())
      for (std::size_t part = 0; part < Cut::parts; ++part)
        cells.push_back(cut_.corners(part, hexahedron));
    return cells;
  }

protected:
  const Cut& cut() const noexcept { return cut_; }

private:
  using Sides = std::array<double, Cut::planes>;

  /// Cuts a piece of a hexahedron, from the side of each plane at its two ends.
  template <class Callback>
  void cut_piece(std::size_t first, const Sides& start, const Sides& stop, double begin, double end,
                 Callback& callback) const {
    std::array<double, Cut::planes + 1> crossing{}; // parts of the piece, in order, and 1
    std::size_t count = 0;
    for (std::size_t k = 0; k < Cut::planes; ++k)
      if ((start[k] < 0) != (stop[k] < 0))
        crossing[count++] = std::clamp(start[k] / (start[k] - stop[k]), 0.0, 1.0);
    std::sort(crossing.begin(), crossing.begin() + static_cast<std::ptrdiff_t>(count));
    crossing[count++] = 1;
    double done = 0, from = begin;
    for (std::size_t k = 0; k < count; ++k) {
      const double to = crossing[k] == 1 ? end : std::min(end, begin + crossing[k] * (end - begin));
      if (!(to > from)) // several planes meet here
        continue;
      const double middle = 0.5 * (done + crossing[k]);
      Sides side{};
      for (std::size_t plane = 0; plane < Cut::planes; ++plane)
        side[plane] = start[plane] + middle * (stop[plane] - start[plane]);
      callback(first + cut_.part(side), from, to);
      done = crossing[k];
      from = to;
    }
  }

  Hexahedra grid_;
  Cut cut_;
};

} // namespace cdem::stress::tessellation::detail
