#pragma once

/// @file
/// Meshes from Gmsh's files (.msh).

#include <cdem/geometry/mesh.hpp>
#include <cdem/io/detail/gmsh_reader.hpp>

#include <filesystem>

namespace cdem::io {

/// Reads the volume elements of a mesh file of Gmsh: tetrahedra, wedges (prisms) and hexahedra of first order, mixed at will.
///
/// Formats: MSH 4.1, text and binary (of this machine's byte order), and MSH 2.2, text: `gmsh -3 body.geo -format msh41 [-bin]`.
/// Points, lines, faces and the sections that say nothing of nodes or elements are passed over; nodes of no volume element are
/// left out. Elements keep their order within a kind. See geometry::Mesh for the numbering, stress::tessellation::Polyhedra for
/// what specimens they make.
/// @param scale  m in one unit of the file, such as 1e-3 for mm
/// @throws core::InvalidInput for a scale that is not a finite number above 0
/// @throws core::FileError    "cannot read <file>: line <n>: <what is there>, <what is expected>" ("after byte <n>" in
///         binary files) for a file that is missing, cut, damaged, of another format, or holds other volume elements or none
/// @complexity O(bytes of the file), of which it holds a copy
inline geometry::Mesh read_gmsh(const std::filesystem::path& path, double scale = 1) {
  core::expect_positive(scale, "scale of the mesh", "m a unit");
  geometry::Mesh mesh = detail::GmshReader(path).read();
  for (Vec3& node : mesh.nodes)
    node *= scale;
  return mesh;
}

} // namespace cdem::io
