#pragma once

// What ecd_isotropy prints and writes.

#include <cdem/io/packing_quality.hpp>

#include <set>

#include "scenario.hpp"

namespace cdem::examples::ecd_isotropy {

/// What the paper prints for a number of particles, [L17] section 2.1.
inline std::optional<double> printed_eps(std::uint32_t particles) {
  return particles == 10000    ? std::optional(1.7e-4)
         : particles == 700000 ? std::optional(5.0e-5)
                               : std::nullopt;
}
inline std::optional<double> printed_anisotropy(std::uint32_t particles) {
  return particles == 10000     ? std::optional(1.3e-3)
         : particles == 1000000 ? std::optional(3.8e-4)
                                : std::nullopt;
}

/// Every figure; the paper's beside those it prints.
inline io::Results tabulate(const Result& result) {
  io::Results table;
  const std::string printed = "[L17] section 2.1";
  for (const Case& one : result.cases) {
    const auto eps = printed_eps(one.particles), anisotropy = printed_anisotropy(one.particles);
    table.add({"ecd.anisotropy[" + one.condition() + "]", "E_k", one.anisotropy(), "1",
               anisotropy ? anisotropy : one.quality.isotropic_deviation,
               anisotropy ? printed : "chance alone"});
    table.add({"ecd.eps[" + one.condition() + "]", "eps", one.quality.eps, "1", eps, eps ? printed : ""});
    table.add(
        {"ecd.eps[body=cut," + one.condition() + "]", "eps", one.eps_cut, "1", eps, eps ? printed : ""});
  }
  for (const Case& one : result.cases)
    io::add_quality(table, one.quality, one.condition());
  return table;
}

/// The table that is worth a look on a terminal: one line a case.
inline std::string summary(const Result& result) {
  std::vector<std::vector<std::string>> rows{{"CoV", "particles", "density", "PV/NkT", "Z", "eps", "eps, cut",
                                              "printed", "gap/d", "E_k", "chance", "printed"}};
  const auto text = [](std::optional<double> value) {
    return value ? io::detail::five_digits(*value) : std::string();
  };
  for (const Case& one : result.cases) {
    const packing::Quality& q = one.quality;
    const double gap =
        q.eps * std::cbrt(static_cast<double>(q.particles) / q.number_density) / (2 * q.radius.mean);
    rows.push_back({text(one.cov), std::to_string(one.particles), text(q.density), text(q.reduced_pressure),
                    text(q.coordination), text(q.eps), text(one.eps_cut), text(printed_eps(one.particles)),
                    text(gap), text(one.anisotropy()), text(q.isotropic_deviation),
                    text(printed_anisotropy(one.particles))});
  }
  return io::detail::aligned(rows, std::vector<bool>(rows[0].size(), true));
}

/// Writes results.csv, the curves against the number of particles, and those of the largest packing of each CoV; the angles of
/// the smallest too.
inline void write(const Result& result, const io::OutputDirectory& out) {
  io::CsvWriter curves(out.file("isotropy.csv"),
                       {"cov", "particles", "density", "reduced_pressure", "bonds", "anisotropy",
                        "anisotropy_yz", "anisotropy_zx", "anisotropy_xy", "anisotropy_chance",
                        "anisotropy_printed", "eps", "eps_cut", "eps_printed", "gap_over_diameter",
                        "backbone_number", "rattlers", "pack_seconds"});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::set<double> seen;
  for (const Case& one : result.cases) {
    const packing::Quality& q = one.quality;
    const auto& e = q.anisotropy.deviation;
    const double side = std::cbrt(static_cast<double>(q.particles) / q.number_density);
    curves.row(one.cov, one.particles, q.density, q.reduced_pressure.value_or(nan), q.anisotropy.bonds[0],
               one.anisotropy(), e[0], e[1], e[2], q.isotropic_deviation,
               printed_anisotropy(one.particles).value_or(nan), q.eps, one.eps_cut,
               printed_eps(one.particles).value_or(nan), q.eps * side / (2 * q.radius.mean),
               q.backbone_number, q.rattlers, one.pack_seconds);
    if (!seen.insert(one.cov).second)
      continue;
    const std::string prefix = "cov" + core::to_text(one.cov) + "_"; // the first of its CoV
    const Case& largest = result.largest(one.cov);
    io::write_quality(out, largest.quality, prefix + std::to_string(largest.particles) + "_");
    if (largest.particles != one.particles)
      io::write_angles(out.file(prefix + std::to_string(one.particles) + "_angles.csv"), q.anisotropy);
  }
  curves.commit();
  tabulate(result).write_csv(out.file("results.csv")); // last: a folder with it is whole
}

} // namespace cdem::examples::ecd_isotropy
