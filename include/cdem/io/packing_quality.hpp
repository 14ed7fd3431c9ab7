#pragma once

/// @file
/// The account of a packing as figures and curves.

#include <cdem/io/output_directory.hpp>
#include <cdem/io/results.hpp>
#include <cdem/packing/quality.hpp>

#include <string>

namespace cdem::io {

/// Adds the figures of a packing to a table: packing.density, .cov, .mean_radius, .reduced_pressure (where known),
/// .contact_number, .backbone_number, .rattlers, .largest_overlap, .structure_factor (of the longest waves, by centres and by
/// volume), network.coordination, .eps, .anisotropy of each plane, and what chance alone leaves of it.
///
/// @param condition  put in the brackets of each quantity, such as "cov=0.3,particles=10000"; may be empty
inline void add_quality(Results& table, const packing::Quality& quality, const std::string& condition = "") {
  const auto name = [&](const std::string& quantity, const std::string& first = "") {
    const std::string inside = first + (first.empty() || condition.empty() ? "" : ",") + condition;
    return inside.empty() ? quantity : quantity + "[" + inside + "]";
  };
  const auto add = [&](const std::string& quantity, const char* symbol, double value,
                       const char* unit = "1") {
    table.add({.quantity = quantity, .symbol = symbol, .value = value, .unit = unit});
  };
  add(name("packing.density"), "phi", quality.density);
  add(name("packing.mean_radius"), "R", quality.radius.mean, "m");
  add(name("packing.cov"), "CoV", quality.radius.cov());
  if (quality.reduced_pressure)
    add(name("packing.reduced_pressure"), "PV/NkT", *quality.reduced_pressure);
  add(name("packing.contact_number"), "", quality.contact_number);
  add(name("packing.backbone_number"), "", quality.backbone_number);
  add(name("packing.rattlers"), "", static_cast<double>(quality.rattlers));
  add(name("packing.largest_overlap"), "", quality.largest_overlap);
  if (!quality.structure_factor.empty()) {
    add(name("packing.structure_factor", "of=centres"), "S", quality.structure_factor.front());
    add(name("packing.structure_factor", "of=volume"), "S_v", quality.volume_structure_factor.front());
  }
  add(name("network.coordination"), "Z", quality.coordination);
  add(name("network.eps"), "eps", quality.eps);
  const char* planes[3] = {"plane=yz", "plane=zx", "plane=xy"};
  for (std::size_t k = 0; k < 3; ++k)
    table.add({.quantity = name("network.anisotropy", planes[k]),
               .symbol = "E_k",
               .value = quality.anisotropy.deviation[k],
               .reference = quality.isotropic_deviation,
               .source = "chance alone, eq. 2 of so many bonds"});
}

/// Writes the bonds' angles in the three coordinate planes: `plane,class,angle_rad,fraction`.
inline void write_angles(const std::filesystem::path& path, const network::Anisotropy<>& anisotropy) {
  CsvWriter csv(path, {"plane", "class", "angle_rad", "fraction"});
  const char* planes[3] = {"yz", "zx", "xy"};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < anisotropy.fraction[k].size(); ++c)
      csv.row(planes[k], c, anisotropy.angle(c), anisotropy.fraction[k][c]);
  csv.commit();
}

/// Writes the curves of a packing, each into a file of the folder whose name begins with `prefix`:
///
///     <prefix>coordination.csv      gap_over_diameter, eps, coordination          Z against the widest gap bonded
///     <prefix>pair_correlation.csv  distance_over_diameter, pair_correlation      g(r) of the centres
///     <prefix>structure_factor.csv  wave_number_times_diameter, centres, volume, wave_vectors   (periodic boxes)
///     <prefix>contacts.csv          contacts_of_a_particle, particles
///     <prefix>angles.csv            plane, class, angle_rad, fraction             eq. 2
///
/// Diameters are means. @throws core::FileError if a file cannot be written
inline void write_quality(const OutputDirectory& folder, const packing::Quality& quality,
                          const std::string& prefix = "") {
  const double diameter = 2 * quality.radius.mean;
  CsvWriter coordination(folder.file(prefix + "coordination.csv"),
                         {"gap_over_diameter", "eps", "coordination"});
  for (std::size_t k = 0; k < quality.gap.size(); ++k)
    coordination.row(quality.gap[k] / diameter, quality.gap_eps[k], quality.gap_coordination[k]);
  coordination.commit();

  CsvWriter pairs(folder.file(prefix + "pair_correlation.csv"),
                  {"distance_over_diameter", "pair_correlation"});
  for (std::size_t k = 0; k < quality.distance.size(); ++k)
    pairs.row(quality.distance[k] / diameter, quality.pair_correlation[k]);
  pairs.commit();

  if (!quality.structure_factor.empty()) {
    CsvWriter waves(folder.file(prefix + "structure_factor.csv"),
                    {"wave_number_times_diameter", "centres", "volume", "wave_vectors"});
    for (std::size_t k = 0; k < quality.wave_number.size(); ++k)
      waves.row(quality.wave_number[k] * diameter, quality.structure_factor[k],
                quality.volume_structure_factor[k], quality.wave_vectors[k]);
    waves.commit();
  }

  CsvWriter contacts(folder.file(prefix + "contacts.csv"), {"contacts_of_a_particle", "particles"});
  for (std::size_t k = 0; k < quality.contacts_histogram.size(); ++k)
    contacts.row(k, quality.contacts_histogram[k]);
  contacts.commit();
  write_angles(folder.file(prefix + "angles.csv"), quality.anisotropy);
}

} // namespace cdem::io
