#pragma once

/// @file
/// Nodes, and cells between them: tetrahedra, wedges, hexahedra.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cdem::geometry {

/// A conforming mesh: two cells share a whole face, an edge, a node, or nothing.
///
/// Cells are numbered through: the tetrahedra first, then the wedges, then the hexahedra. Corners are in VTK's order; of a wedge
/// one triangle, then the other, of a hexahedron one quadrangle around, then the opposite one.
struct Mesh {
  using Node = std::uint32_t;

  std::vector<Vec3> nodes; ///< m
  std::vector<std::array<Node, 4>> tetrahedra;
  std::vector<std::array<Node, 6>> wedges;
  std::vector<std::array<Node, 8>> hexahedra;

  std::size_t cell_count() const noexcept { return tetrahedra.size() + wedges.size() + hexahedra.size(); }

  /// Nodes at the corners of a cell: 4, 6 or 8.
  std::span<const Node> corners(std::size_t cell) const {
    if (cell < tetrahedra.size())
      return tetrahedra[cell];
    cell -= tetrahedra.size();
    if (cell < wedges.size())
      return wedges[cell];
    return hexahedra[cell - wedges.size()];
  }

  /// @throws core::InvalidInput for a mesh without cells, of 2^32 nodes or more, a coordinate that is not finite, or a corner that
  ///         is no node; names the first such node or cell
  void validate() const {
    core::expect(cell_count() > 0, "number of cells of the mesh", cell_count(), "1 or more is expected");
    core::expect(nodes.size() <= 0xffffffffU, "number of nodes of the mesh", nodes.size(),
                 "at most 2^32 - 1 is expected");
    for (std::size_t node = 0; node < nodes.size(); ++node)
      for (int k = 0; k < 3; ++k)
        if (!std::isfinite(nodes[node][k]))
          core::reject(std::string("coordinate ") + "xyz"[k] + " of node " + std::to_string(node),
                       nodes[node][k], "a finite number is expected");
    for (std::size_t cell = 0; cell < cell_count(); ++cell)
      for (const Node node : corners(cell))
        if (node >= nodes.size())
          core::reject("corner of cell " + std::to_string(cell), node,
                       "the number of a node, below " + std::to_string(nodes.size()) + ", is expected");
  }
};

namespace detail {

/// Calls use(corners) for each face of a cell of 4, 6 or 8 corners, the corners (numbers within the cell) in turn around it,
/// all faces in the same sense as seen from outside.
template <class Use>
void for_each_face(std::size_t corner_count, Use&& use) {
  using Face = std::span<const std::uint8_t>;
  static constexpr std::uint8_t tetrahedron[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  static constexpr std::uint8_t triangles[2][3] = {{0, 2, 1}, {3, 4, 5}};
  static constexpr std::uint8_t sides[3][4] = {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
  static constexpr std::uint8_t hexahedron[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                    {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  const auto each = [&](const auto& faces) {
    for (const auto& face : faces)
      use(Face(face));
  };
  if (corner_count == 4)
    each(tetrahedron);
  else if (corner_count == 8)
    each(hexahedron);
  else
    each(triangles), each(sides);
}

} // namespace detail

/// Cuts a cell into tetrahedra between its corners, calling use(a, b, c, d) with four nodes for each: 1, 3 or 6 of a
/// tetrahedron, a wedge, a hexahedron.
///
/// Every face is cut from its corner of the lowest number, and the cell from its own lowest corner to the faces that it does not
/// lie on (a pulling triangulation). Two neighbours thus cut the face between them alike, plane or not, and the
/// tetrahedra of all the cells make a conforming mesh. Those of one cell have volumes of one sign unless it is tangled.
template <class Use>
void cut_to_tetrahedra(std::span<const Mesh::Node> corners, Use&& use) {
  std::size_t lowest = 0;
  for (std::size_t k = 1; k < corners.size(); ++k)
    if (corners[k] < corners[lowest])
      lowest = k;
  detail::for_each_face(corners.size(), [&](std::span<const std::uint8_t> face) {
    std::size_t start = 0;
    for (std::size_t k = 0; k < face.size(); ++k) {
      if (face[k] == lowest)
        return;
      if (corners[face[k]] < corners[face[start]])
        start = k;
    }
    const auto node = [&](std::size_t k) { return corners[face[(start + k) % face.size()]]; };
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      use(corners[lowest], node(0), node(k), node(k + 1));
  });
}

} // namespace cdem::geometry
