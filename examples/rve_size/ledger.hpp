#pragma once

// The table of samples that a run keeps, so that the next goes on where it stopped.

#include <cdem/io/csv.hpp>
#include <cdem/io/output_directory.hpp>

#include "scenario.hpp"

namespace cdem::examples::rve_size {

namespace detail {

/// What all samples of one table share; columns of the table, so that a row speaks for itself.
inline std::vector<std::pair<std::string, double>> shared_columns(const Params& params) {
  return {{"wanted_density", params.packing.density},
          {"cov", params.packing.cov},
          {"growth_rate", params.packing.growth_rate},
          {"coordination", params.coordination},
          {"axis", static_cast<double>(core::index_of(params.axis))}};
}

} // namespace detail

/// Writes every sample, a row each. The old table stays until the new one is whole.
inline void write_samples(const Params& params, const std::vector<Sample>& samples,
                          const std::filesystem::path& path) {
  std::vector<std::string> columns{"particles", "seed", "material"};
  for (const Measure measure : all_measures)
    columns.push_back(std::string("youngs_modulus_") + name_of(measure) + "_pa");
  for (const Measure measure : all_measures)
    columns.push_back(std::string("poissons_ratio_") + name_of(measure));
  for (const char* name :
       {"anisotropy", "density", "reduced_pressure", "eps", "eps_periodic", "solve_seconds"})
    columns.push_back(name);
  for (const auto& [name, value] : detail::shared_columns(params))
    columns.push_back(name);
  io::CsvWriter table(path, columns);
  const auto shared = detail::shared_columns(params);
  for (const Sample& s : samples)
    table.row(s.particles, s.seed, s.material, s.moduli.by[0].youngs_modulus, s.moduli.by[1].youngs_modulus,
              s.moduli.by[2].youngs_modulus, s.moduli.by[3].youngs_modulus, s.moduli.by[0].poissons_ratio,
              s.moduli.by[1].poissons_ratio, s.moduli.by[2].poissons_ratio, s.moduli.by[3].poissons_ratio,
              s.anisotropy, s.density, s.pressure, s.eps, s.eps_periodic, s.solve_seconds, shared[0].second,
              shared[1].second, shared[2].second, shared[3].second, shared[4].second);
  table.commit();
}

/// The samples of an earlier run; none if there is no table.
/// @throws core::FileError     for a table that is damaged
/// @throws core::InvalidInput  for one of other parameters; names the parameter
inline std::vector<Sample> read_samples(const Params& params, const std::filesystem::path& path) {
  if (!std::filesystem::exists(path))
    return {};
  const io::CsvTable table = io::read_csv(path);
  for (const auto& [name, wanted] : detail::shared_columns(params))
    for (const double kept : table.numbers(name))
      core::expect(kept == wanted, name, wanted,
                   core::to_text(kept) + " is expected, as in " + path.string() +
                       ": another folder for other parameters");
  std::vector<Sample> samples(table.rows.size());
  const auto take = [&](const std::string& name, auto&& put) {
    const std::vector<double> values = table.numbers(name);
    for (std::size_t r = 0; r < samples.size(); ++r)
      put(samples[r], values[r]);
  };
  take("particles", [](Sample& s, double v) { s.particles = static_cast<std::uint32_t>(v); });
  take("seed", [](Sample& s, double v) { s.seed = static_cast<std::uint64_t>(v); });
  const std::size_t material = table.column("material");
  for (std::size_t r = 0; r < samples.size(); ++r)
    samples[r].material = table.rows[r][material];
  for (std::size_t m = 0; m < all_measures.size(); ++m) {
    const std::string measure = name_of(all_measures[m]);
    take("youngs_modulus_" + measure + "_pa",
         [m](Sample& s, double v) { s.moduli.by[m].youngs_modulus = v; });
    take("poissons_ratio_" + measure, [m](Sample& s, double v) { s.moduli.by[m].poissons_ratio = v; });
  }
  take("anisotropy", [](Sample& s, double v) { s.anisotropy = v; });
  take("density", [](Sample& s, double v) { s.density = v; });
  take("reduced_pressure", [](Sample& s, double v) { s.pressure = v; });
  take("eps", [](Sample& s, double v) { s.eps = v; });
  take("eps_periodic", [](Sample& s, double v) { s.eps_periodic = v; });
  take("solve_seconds", [](Sample& s, double v) { s.solve_seconds = v; });
  return samples;
}

} // namespace cdem::examples::rve_size
