#pragma once

/// @file
/// A box cut into equal hexahedra, and each of these into two wedges (pentahedra).

#include <cdem/stress/tessellation/detail/cut_hexahedra.hpp>

#include <utility>

namespace cdem::stress::tessellation {

namespace detail {

/// One plane through two opposite edges along an axis: the wedges u >= v and u < v of the coordinates across it.
struct WedgeCut {
  Axis axis = Axis::z;

  static constexpr std::size_t parts = 2;
  static constexpr std::size_t planes = 1;
  using Corners = std::array<std::uint32_t, 6>;

  int first() const { return (index_of(axis) + 1) % 3; }
  int second() const { return (index_of(axis) + 2) % 3; }

  std::array<double, planes> sides(const Vec3& local) const { return {local[first()] - local[second()]}; }
  std::size_t part(const std::array<double, planes>& side) const { return side[0] >= 0 ? 0 : 1; }

  /// The triangle at the axis' lower end, its normal pointing out of the wedge as VTK_WEDGE has it, then the upper one.
  Corners corners(std::size_t part, const std::array<std::uint32_t, 8>& hexahedron) const {
    const unsigned u = 1U << first(), v = 1U << second(), up = 1U << index_of(axis);
    const std::array<unsigned, 3> triangle = part == 0 ? std::array{0U, u | v, u} : std::array{0U, v, u | v};
    Corners result{};
    for (std::size_t k = 0; k < 3; ++k) {
      result[k] = hexahedron[vtk_corner(triangle[k])];
      result[k + 3] = hexahedron[vtk_corner(triangle[k] | up)];
    }
    return result;
  }
};

} // namespace detail

/// Structured tessellation in equal wedges, the pentahedra of [L17] section 3: every hexahedron of a grid cut in two by a
/// plane along one axis.
///
/// The wedges of hexahedron h have the numbers 2h and 2h + 1. With the axis z the plane goes through the corners where x
/// and y are both low or both high (cyclic for the others). A point of the plane belongs to the wedge 2h.
class Wedges : public detail::CutHexahedra<detail::WedgeCut> {
public:
  /// @param grid  such as Hexahedra::holding(box, particles, 160) for 80 particles a wedge; periodic where its box is
  /// @param axis  the wedges' triangles lie across it
  explicit Wedges(Hexahedra grid, Axis axis = Axis::z)
      : detail::CutHexahedra<detail::WedgeCut>(std::move(grid), detail::WedgeCut{axis}) {}

  Axis axis() const noexcept { return cut().axis; }
};

static_assert(Tessellation<Wedges>);

} // namespace cdem::stress::tessellation
