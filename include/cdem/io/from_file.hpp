#pragma once

/// @file
/// Packings that others made: a generator that reads a file.

#include <cdem/io/detail/read_lammps.hpp>
#include <cdem/io/detail/read_table.hpp>
#include <cdem/io/detail/read_vtu.hpp>
#include <cdem/io/packing_file.hpp>
#include <cdem/packing/packing_generator.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace cdem::io {

/// How a file that holds spheres is written.
enum class SphereFormat : std::uint8_t {
  automatic, ///< by its first bytes, and what its name ends in
  packing,   ///< cdem's own binary file, save_packing()
  table,     ///< CSV; YADE's export.text, export.textExt and SpherePack.save
  lammps_data, ///< LAMMPS read_data and write_data, atom styles sphere, bpm/sphere, atomic, bond, angle, molecular
  lammps_dump, ///< LAMMPS dump atom and dump custom, text
  vtk,         ///< VTK's legacy file, ASCII or binary: ParaView, YADE's VTKExporter and text2vtk
  vtu          ///< VTK's XML file (.vtu, .vtp): ParaView, YADE's VTKRecorder, write_particles_vtu()
};

/// "packing", "table", "LAMMPS data", "LAMMPS dump", "VTK", "VTK XML".
constexpr std::string_view to_string(SphereFormat format) {
  constexpr std::array<std::string_view, 7> names{"automatic",   "packing", "table",  "LAMMPS data",
                                                  "LAMMPS dump", "VTK",     "VTK XML"};
  return names[static_cast<std::size_t>(format)];
}

/// What a file is by its first bytes; a text that is nothing else is LAMMPS data where the third line or an earlier one tells
/// a number of atoms, else a table.
/// @throws core::FileError if it cannot be read
inline SphereFormat detect_format(const std::filesystem::path& path) {
  std::ifstream in = detail::open_input(path);
  std::string start(1024, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  if (start.starts_with("\x89"
                        "cdem"))
    return SphereFormat::packing;
  if (start.starts_with("# vtk DataFile"))
    return SphereFormat::vtk;
  if (start.starts_with("<?xml") || start.starts_with("<VTKFile"))
    return SphereFormat::vtu;
  if (start.starts_with("ITEM:"))
    return SphereFormat::lammps_dump;
  for (std::size_t at = start.find('\n'), lines = 0; at != start.npos && lines < 10;
       at = start.find('\n', at + 1), ++lines) {
    const std::string_view line =
        detail::trimmed(std::string_view(start).substr(at + 1, start.find('\n', at + 1) - at - 1));
    if (line.ends_with(" atoms") && detail::number_in<std::uint64_t>(line.substr(0, line.find(' '))))
      return SphereFormat::lammps_data;
  }
  return SphereFormat::table;
}

/// A packing read from a file: a model of packing::PackingGenerator, so that a Simulation takes it as any other.
///
/// It stands in `io`, not in `packing`: it needs the readers, which stand below every layer whose data they read, and no
/// packing policy may include them. Nothing above needs to know of it.
/// @complexity  O(bytes of the file)
class FromFile {
public:
  struct Parameters {
    std::filesystem::path file = {};
    SphereFormat format = SphereFormat::automatic;
    double scale = 1;  ///< of the file's lengths, to m
    double radius = 0; ///< m, of the spheres of a file that gives none; 0: the file must give them
    /// m; taken instead of the file's. Where neither is there: the smallest walled box that holds all the spheres.
    std::optional<geometry::Box> box = {};
  };

  struct Report {
    double density = 0; ///< the spheres' volume over the box's; overlaps count twice
    SphereFormat format = SphereFormat::automatic; ///< found
    bool box_from_spheres = false;                 ///< no box was given: the bounding one is used
    std::string parameters;                        ///< of cdem's own file: how the packing was made
    std::string made;                              ///< of cdem's own file: the generator's report
  };

  /// @throws core::InvalidInput  for an empty name, a scale or radius that is not accepted, or a bad box
  explicit FromFile(Parameters parameters) : parameters_(std::move(parameters)) {
    core::expect(!parameters_.file.empty(), "file of the packing", "''", "a name is expected");
    core::expect(parameters_.format <= SphereFormat::vtu, "format", static_cast<int>(parameters_.format),
                 "0 to 6 is expected");
    core::expect_positive(parameters_.scale, "scale of the file's lengths");
    core::expect_not_negative(parameters_.radius, "radius of the spheres", "m");
    if (parameters_.box)
      parameters_.box->validate();
  }

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Reads the file. Centres outside the periodic directions of the box are brought into it.
  /// @throws core::FileError  naming the file and, where it has lines, the line: a missing, cut or damaged file, another number
  ///         of columns than expected, what is no finite number, a radius that is not above 0, no radii without one in the
  ///         parameters, a centre outside the walls of the box
  packing::Packing<Report> pack(const core::Monitor& = core::Monitor()) const {
    packing::Packing<Report> packing;
    Report& report = packing.report;
    report.format =
        parameters_.format == SphereFormat::automatic ? detect_format(parameters_.file) : parameters_.format;
    detail::SphereFile read = read_as(report);
    if (!read.has_radii && parameters_.radius == 0)
      fail("it gives no radii; one for all the spheres is needed");
    packing.particles = std::move(read.particles);
    for (std::size_t i = 0; i < packing.particles.size(); ++i) {
      packing.particles.position[i] *= parameters_.scale;
      double& radius = packing.particles.radius[i];
      radius = read.has_radii ? radius * parameters_.scale : parameters_.radius;
    }
    if (parameters_.box)
      packing.box = *parameters_.box;
    else if (read.box)
      packing.box = {read.box->lower * parameters_.scale, read.box->upper * parameters_.scale,
                     read.box->periodic};
    else
      packing.box = bounding_box(packing.particles);
    report.box_from_spheres = !parameters_.box && !read.box;
    try {
      packing.box.validate();
      packing.particles.validate();
    } catch (const core::InvalidInput& invalid) {
      fail(invalid.what());
    }
    bring_inside(packing.particles, packing.box);
    report.density = packing.particles.solid_volume() / packing.box.volume();
    return packing;
  }

private:
  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError("cannot read " + parameters_.file.string() + ": " + why);
  }

  detail::SphereFile read_as(Report& report) const {
    const std::filesystem::path& file = parameters_.file;
    switch (report.format) {
    case SphereFormat::packing: {
      PackingFile own = load_packing(file);
      report.parameters = std::move(own.parameters);
      report.made = std::move(own.report);
      return {std::move(own.particles), own.box, true};
    }
    case SphereFormat::lammps_data:
      return detail::read_lammps_data(file);
    case SphereFormat::lammps_dump:
      return detail::read_lammps_dump(file);
    case SphereFormat::vtk:
      return detail::LegacyVtk(file).read();
    case SphereFormat::vtu:
      return detail::XmlVtk(file).read();
    case SphereFormat::automatic:
    case SphereFormat::table:
      break;
    }
    return detail::read_table(file);
  }

  static geometry::Box bounding_box(const particles::ParticleSet& spheres) {
    geometry::Box box{spheres.position[0], spheres.position[0], {}};
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const Vec3 reach = Vec3::Constant(spheres.radius[i]);
      box.lower = box.lower.cwiseMin(spheres.position[i] - reach);
      box.upper = box.upper.cwiseMax(spheres.position[i] + reach);
    }
    return box;
  }

  void bring_inside(particles::ParticleSet& spheres, const geometry::Box& box) const {
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      Vec3& centre = spheres.position[i];
      centre = box.wrap(centre);
      for (int k = 0; k < 3; ++k)
        if (!(centre[k] >= box.lower[k] && centre[k] <= box.upper[k]))
          fail(std::string(1, "xyz"[k]) + " of sphere " + std::to_string(i) + " is " +
               core::to_text(centre[k]) + " m, outside the box, which goes from " +
               core::to_text(box.lower[k]) + " to " + core::to_text(box.upper[k]));
    }
  }

  Parameters parameters_;
};

static_assert(packing::PackingGenerator<FromFile>);

} // namespace cdem::io
