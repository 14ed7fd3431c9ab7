#pragma once

// What rve_size prints and writes.

#include <cdem/io/csv.hpp>
#include <cdem/io/output_directory.hpp>
#include <cdem/io/results.hpp>

#include "ledger.hpp"

namespace cdem::examples::rve_size {

/// Every figure: by size, then the limits; the paper's beside those it prints.
inline io::Results tabulate(const Result& result) {
  io::Results table;
  const std::string printed = "[L17] section 2.3";
  for (const PaperMaterial& material : {alumina(), silica()}) {
    for (const std::uint32_t size : result.sizes())
      for (const Measure measure : all_measures) {
        const std::string condition =
            std::string("[measure=") + name_of(measure) + ",particles=" + std::to_string(size) + "]";
        const auto E = result.youngs_modulus(size, material.name, measure);
        if (E.count == 0)
          continue;
        table.add({material.name + ".youngs_modulus" + condition, "E_M", E.mean, "Pa",
                   material.youngs_modulus, printed});
        if (E.count >= 2)
          table.add(
              {material.name + ".youngs_modulus.prediction" + condition, "+-", E.prediction() / E.mean, "1"});
        if (const auto nu = result.poissons_ratio(size, material.name, measure); nu.count > 0) {
          table.add({material.name + ".poissons_ratio" + condition, "nu_M", nu.mean, "1",
                     material.poissons_ratio, printed});
          if (nu.count >= 2)
            table.add({material.name + ".poissons_ratio.prediction" + condition, "+-", nu.prediction(), "1"});
        }
      }
    // what all measures should agree on where the faces no longer count
    std::optional<double> periodic;
    for (const std::uint32_t size : result.sizes()) // the largest measured
      if (const auto E = result.youngs_modulus(size, material.name, Measure::periodic); E.count > 0)
        periodic = E.mean;
    for (const Measure measure : all_measures)
      if (const auto line = result.limit(material.name, measure)) {
        const std::string name = material.name + ".youngs_modulus";
        const std::string condition = std::string("[measure=") + name_of(measure) + ",particles=infinite]";
        table.add({name + condition, "E_M", line->intercept, "Pa",
                   measure == Measure::periodic ? std::nullopt : periodic, "largest periodic cell"});
        table.add({name + ".error" + condition, "+-", line->intercept_error / line->intercept, "1"});
      }
  }
  return table;
}

/// The table that is worth a look on a terminal: one line a size and material.
inline std::string summary(const Result& result) {
  std::vector<std::vector<std::string>> rows{{"material", "particles", "packings", "E faces, GPa", "+- 95 %",
                                              "E interior", "+- 95 %", "E periodic", "nu faces", "+- 95 %",
                                              "nu interior", "nu periodic"}};
  const auto text = [](double value) {
    return std::isfinite(value) ? io::detail::five_digits(value) : std::string("-");
  };
  const auto percent = [&](const homogenize::SampleStatistics& s) {
    return std::isfinite(s.prediction()) ? text(100 * s.prediction() / s.mean) + " %" : std::string("-");
  };
  for (const PaperMaterial& material : {alumina(), silica()})
    for (const std::uint32_t size : result.sizes()) {
      const auto E = [&](Measure m) { return result.youngs_modulus(size, material.name, m); };
      const auto nu = [&](Measure m) { return result.poissons_ratio(size, material.name, m); };
      rows.push_back({material.name, std::to_string(size), std::to_string(E(Measure::faces).count),
                      text(1e-9 * E(Measure::faces).mean), percent(E(Measure::faces)),
                      text(1e-9 * E(Measure::interior).mean), percent(E(Measure::interior)),
                      text(1e-9 * E(Measure::periodic).mean), text(nu(Measure::faces).mean),
                      text(nu(Measure::faces).prediction()), text(nu(Measure::interior).mean),
                      text(nu(Measure::periodic).mean)});
    }
  std::vector<bool> right(rows[0].size(), true);
  right[0] = false;
  return io::detail::aligned(rows, right);
}

/// Writes results.csv and the curves of figure 6; the samples are written as they come.
inline void write(const Result& result, const io::OutputDirectory& out) {
  for (const PaperMaterial& material : {alumina(), silica()}) {
    io::CsvWriter curves(out.file(material.name + "_sizes.csv"),
                         {"measure", "particles", "packings", "youngs_modulus_pa",
                          "youngs_modulus_prediction_pa", "poissons_ratio", "poissons_ratio_prediction"});
    for (const Measure measure : all_measures)
      for (const std::uint32_t size : result.sizes()) {
        const auto E = result.youngs_modulus(size, material.name, measure);
        const auto nu = result.poissons_ratio(size, material.name, measure);
        if (E.count > 0)
          curves.row(name_of(measure), size, E.count, E.mean, E.prediction(), nu.mean, nu.prediction());
      }
    curves.commit();
  }
  tabulate(result).write_csv(out.file("results.csv")); // last: a folder with it is whole
}

} // namespace cdem::examples::rve_size
