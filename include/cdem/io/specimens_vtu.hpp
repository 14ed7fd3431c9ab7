#pragma once

/// @file
/// The specimens of a tessellation with their stress.

#include <cdem/geometry/mesh.hpp>
#include <cdem/io/vtu.hpp>
#include <cdem/stress/statistics.hpp>
#include <cdem/stress/stress_estimator.hpp>

namespace cdem::io {

/// What to write about the specimens; what is left empty is left out.
struct SpecimenFields {
  std::span<const Mat3> stress = {};             ///< [specimens] Pa, tension positive
  std::span<const double> volume = {};           ///< [specimens] m^3
  std::span<const std::uint32_t> particles = {}; ///< [specimens] number of centres inside
  std::vector<DataArray> extra = {};             ///< any other array of one value a specimen
  double time = 0;                               ///< s
  std::string title = {};
  std::span<const Mat3> couple_stress = {}; ///< [specimens] N/m
};

/// The fields of an estimator's result.
/// @param field  must live until the file is written
inline SpecimenFields fields_of(const stress::StressField& field) {
  return {field.stress, field.volume, field.particles, {}, 0, {}, field.couple_stress};
}
SpecimenFields fields_of(stress::StressField&&) = delete;

/// Cell type of a specimen by its number of corners.
template <std::size_t Corners>
constexpr CellType specimen_type() {
  static_assert(Corners == 8 || Corners == 6 || Corners == 4, "hexahedra, wedges or tetrahedra are expected");
  return Corners == 8 ? CellType::hexahedron : Corners == 6 ? CellType::wedge : CellType::tetrahedron;
}

namespace detail {

template <std::size_t Corners>
void add_specimens(Vtu& grid, const std::vector<std::array<std::uint32_t, Corners>>& cells) {
  grid.cells(specimen_type<Corners>(), cells.size(),
             [&](std::size_t k) { return cells[k / Corners][k % Corners]; });
}

/// Adds the fields to a grid of which each cell is a specimen, and writes it.
inline void write_specimen_grid(const std::filesystem::path& path, Vtu& grid, const SpecimenFields& fields) {
  if (!fields.stress.empty()) {
    grid.cell_data({"stress [Pa]", fields.stress});
    grid.cell_data({"von Mises stress [Pa]", fields.stress.size(),
                    [&](std::size_t s) { return stress::von_mises(fields.stress[s]); }});
  }
  if (!fields.couple_stress.empty())
    grid.cell_data({"couple stress [N/m]", fields.couple_stress});
  if (!fields.volume.empty())
    grid.cell_data({"volume [m^3]", fields.volume});
  if (!fields.particles.empty())
    grid.cell_data({"particles", fields.particles});
  for (const DataArray& array : fields.extra)
    grid.cell_data(array);
  grid.field_data("TimeValue", fields.time);
  if (!fields.title.empty())
    grid.field_data("title", fields.title);
  grid.write(path);
}

} // namespace detail

/// Writes a tessellation of hexahedra, wedges or tetrahedra as a `.vtu` file: cell data "stress [Pa]" (xx xy xz yx yy
/// yz zx zy zz; row = force, column = branch), "von Mises stress [Pa]" (of its symmetric part), "couple stress [N/m]" (row =
/// moment), "volume [m^3]" and "particles".
///
/// @param corners  [corners] m
/// @param cells    [specimens] numbers of their 8, 6 or 4 corners, in VTK's order
/// @throws core::InvalidInput for an array that does not have one value a specimen, or a corner that is missing
/// @throws core::FileError    if the file cannot be written; nothing is left behind
/// @complexity O(specimens), no copy of the data
template <std::size_t Corners>
void write_specimens_vtu(const std::filesystem::path& path, const std::vector<Vec3>& corners,
                         const std::vector<std::array<std::uint32_t, Corners>>& cells,
                         const SpecimenFields& fields) {
  Vtu grid(corners);
  detail::add_specimens(grid, cells);
  detail::write_specimen_grid(path, grid, fields);
}

/// The same for a tessellation that lists its corner_points() and cell_corners(): stress::tessellation::Hexahedra, whose cells also
/// stand for the points of a coarse-grained grid, Wedges and Tetrahedra.
template <class Tessellation>
requires requires(const Tessellation& tessellation) {
  tessellation.corner_points();
  tessellation.cell_corners();
}
void write_specimens_vtu(const std::filesystem::path& path, const Tessellation& tessellation,
                         const SpecimenFields& fields) {
  write_specimens_vtu(path, tessellation.corner_points(), tessellation.cell_corners(), fields);
}

/// The same for the cells of a mesh, of stress::tessellation::Polyhedra.
inline void write_specimens_vtu(const std::filesystem::path& path, const geometry::Mesh& mesh,
                                const SpecimenFields& fields) {
  Vtu grid(mesh.nodes);
  detail::add_specimens(grid, mesh.tetrahedra);
  detail::add_specimens(grid, mesh.wedges);
  detail::add_specimens(grid, mesh.hexahedra);
  detail::write_specimen_grid(path, grid, fields);
}

/// The same for points, of stress::Halo or stress::CoarseGraining, each a vertex.
inline void write_specimens_vtu(const std::filesystem::path& path, const std::vector<Vec3>& points,
                                const SpecimenFields& fields) {
  Vtu grid(points);
  grid.vertices();
  detail::write_specimen_grid(path, grid, fields);
}

} // namespace cdem::io
