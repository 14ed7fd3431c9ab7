#pragma once

/// @file
/// A box cut into equal hexahedra, and each of these into six tetrahedra.

#include <cdem/stress/tessellation/detail/cut_hexahedra.hpp>

#include <utility>

namespace cdem::stress::tessellation {

namespace detail {

/// The planes x = y, y = z and x = z of a cell's coordinates: a tetrahedron for each order of the three.
struct KuhnCut {
  static constexpr std::size_t parts = 6;
  static constexpr std::size_t planes = 3;
  using Corners = std::array<std::uint32_t, 4>;

  std::array<double, planes> sides(const Vec3& local) const {
    return {local[0] - local[1], local[1] - local[2], local[0] - local[2]};
  }
  std::size_t part(const std::array<double, planes>& side) const {
    const bool xy = side[0] >= 0, yz = side[1] >= 0, xz = side[2] >= 0; // transitive, as >= is
    if (xy)
      return yz ? 0 : xz ? 1 : 2; // xyz, xzy, zxy
    return xz ? 3 : yz ? 4 : 5;   // yxz, yzx, zyx
  }

  /// From corner 0 along the axes in falling order of the coordinates, turned so that VTK_TETRA has a positive volume.
  Corners corners(std::size_t part, const std::array<std::uint32_t, 8>& hexahedron) const {
    static constexpr std::array<std::array<unsigned, 3>, parts> order{
        {{0, 1, 2}, {0, 2, 1}, {2, 0, 1}, {1, 0, 2}, {1, 2, 0}, {2, 1, 0}}};
    static constexpr std::array<bool, parts> odd{false, true, false, true, false, true};
    const unsigned one = 1U << order[part][0], two = one | 1U << order[part][1];
    Corners result{hexahedron[vtk_corner(0)], hexahedron[vtk_corner(one)], hexahedron[vtk_corner(two)],
                   hexahedron[vtk_corner(7)]};
    if (odd[part])
      std::swap(result[1], result[2]);
    return result;
  }
};

} // namespace detail

/// Structured tessellation in tetrahedra of one volume, those of [L17] sections 4 and 5 on a grid: every hexahedron cut in
/// six around its diagonal (Kuhn 1960). All hexahedra are cut alike, so that the faces of neighbours meet.
///
/// The tetrahedra of hexahedron h have the numbers 6h to 6h + 5, one for each order of the coordinates within it: xyz (x the
/// largest), xzy, zxy, yxz, yzx, zyx. A point where two are equal belongs to the order that has the earlier axis first.
class Tetrahedra : public detail::CutHexahedra<detail::KuhnCut> {
public:
  /// @param grid  such as Hexahedra::holding(box, particles, 480) for 80 particles a tetrahedron; periodic where its box is
  explicit Tetrahedra(Hexahedra grid) : detail::CutHexahedra<detail::KuhnCut>(std::move(grid), {}) {}
};

static_assert(Tessellation<Tetrahedra>);

} // namespace cdem::stress::tessellation
