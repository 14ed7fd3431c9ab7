#pragma once

// What micro_parameters prints and writes.

#include <cdem/io/csv.hpp>
#include <cdem/io/output_directory.hpp>
#include <cdem/io/results.hpp>

#include "scenario.hpp"

namespace cdem::examples::micro_parameters {

inline std::string condition_of(const Case& one) {
  return "[" + one.kind.name() + ",z=" + core::to_text(one.coordination) +
         (one.law == Law::beam ? "" : std::string(",law=") + name_of(one.law)) +
         ",measure=" + name_of(one.measure) + "]";
}

/// E_a and nu of every case beside the paper's.
inline io::Results tabulate(const Result& result) {
  io::Results table;
  for (const KindResult& kind : result.kinds) {
    const std::string condition = "[" + kind.kind.name() + "]";
    table.add({"packing.density" + condition, "phi", kind.density.mean, "1", 0.64, "[L17] section 2.1"});
    table.add({"packing.reduced_pressure" + condition, "PV/NkT", kind.pressure.mean});
  }
  for (const Case& one : result.cases) {
    for (std::size_t m = 0; m < 3; ++m) {
      const PaperMaterial material = materials()[m];
      const std::string source = material.name == "aluminium" ? "[L17] section 3.2" : "[L17] section 2.3";
      table.add({material.name + ".relative_modulus" + condition_of(one), "E_a", one.relative_modulus[m].mean,
                 "1", material.youngs_modulus / material.micro.youngs_modulus, source});
      if (m == 0 && one.law == Law::beam && one.measure != Measure::nominal &&
          one.measure != Measure::interior)
        table.add({"network.eps" + condition_of(one), "eps", one.eps});
      if (one.poissons_ratio[m].count > 0)
        table.add({material.name + ".poissons_ratio" + condition_of(one), "nu_M", one.poissons_ratio[m].mean,
                   "1", material.poissons_ratio, source});
    }
    if (std::isfinite(one.deviation()))
      table.add({"paper.deviation" + condition_of(one), "rms", one.deviation()});
  }
  return table;
}

/// One line a case on a terminal: deviations from the paper in per cent.
inline std::string lines(const std::vector<Case>& cases) {
  std::vector<std::vector<std::string>> rows{{"packing", "Z", "law", "measure", "eps", "E_a 0.169", "dev. %",
                                              "E_a 0.545", "dev. %", "E_a 0.722", "dev. %", "nu 0.169",
                                              "dev. %", "nu 0.545", "dev. %", "nu 0.722", "dev. %", "rms %"}};
  const auto percent = [](double value, double reference) {
    std::array<char, 16> text;
    std::snprintf(text.data(), text.size(), "%+.1f", 100 * (value / reference - 1));
    return std::string(text.data());
  };
  for (const Case& one : cases) {
    std::vector<std::string> row{one.kind.name(), core::to_text(one.coordination), name_of(one.law),
                                 name_of(one.measure), io::detail::five_digits(one.eps)};
    for (std::size_t m = 0; m < 3; ++m) {
      const PaperMaterial material = materials()[m];
      row.push_back(io::detail::five_digits(one.relative_modulus[m].mean));
      row.push_back(
          percent(one.relative_modulus[m].mean, material.youngs_modulus / material.micro.youngs_modulus));
    }
    for (std::size_t m = 0; m < 3; ++m) {
      row.push_back(io::detail::five_digits(one.poissons_ratio[m].mean));
      row.push_back(percent(one.poissons_ratio[m].mean, materials()[m].poissons_ratio));
    }
    row.push_back(io::detail::five_digits(100 * one.deviation()));
    rows.push_back(std::move(row));
  }
  std::vector<bool> right(rows[0].size(), true);
  right[0] = right[2] = right[3] = false;
  return io::detail::aligned(rows, right);
}

/// What a terminal shows: the kinds of packing, the closest cases, and the closest of each kind as the paper says it was.
inline std::string summary(const Result& result) {
  std::vector<std::vector<std::string>> kinds{{"packing", "density", "PV/NkT"}};
  for (const KindResult& kind : result.kinds)
    kinds.push_back({kind.kind.name(), io::detail::five_digits(kind.density.mean),
                     io::detail::five_digits(kind.pressure.mean)});
  const auto sorted = result.closest();
  const auto pick = [&](std::size_t most, const std::function<bool(const Case&)>& wanted) {
    std::vector<Case> found;
    for (const Case& one : sorted)
      if (wanted(one) && found.size() < most)
        found.push_back(one);
    return found;
  };
  std::string text = io::detail::aligned(kinds, {false, true, true});
  text += "\nClosest to the paper's six values, with the beam of the paper:\n" +
          lines(pick(10, [](const Case& one) { return one.law == Law::beam; }));
  text += "\nAt the paper's Z = 6.2 with the beam of the paper:\n" +
          lines(pick(12, [](const Case& one) { return one.law == Law::beam && one.coordination == 6.2; }));
  for (const Law law : {Law::timoshenko, Law::two_thirds})
    if (const auto found = pick(8, [law](const Case& one) { return one.law == law; }); !found.empty())
      text += std::string("\nClosest with the law ") + name_of(law) + ":\n" + lines(found);
  return text;
}

/// Writes every case as a row, and results.csv.
inline void write(const Result& result, const io::OutputDirectory& out) {
  io::CsvWriter table(out.file("coordinations.csv"),
                      {"cov", "boundary", "state", "density", "reduced_pressure", "coordination", "law",
                       "measure", "eps", "material", "radius_ratio", "packings", "relative_modulus",
                       "relative_modulus_deviation", "relative_modulus_printed", "poissons_ratio",
                       "poissons_ratio_deviation", "poissons_ratio_printed", "rms_from_paper"});
  for (const Case& one : result.cases) {
    const auto kind = std::find_if(result.kinds.begin(), result.kinds.end(), [&](const KindResult& each) {
      return each.kind.name() == one.kind.name();
    });
    for (std::size_t m = 0; m < 3; ++m) {
      const PaperMaterial material = materials()[m];
      table.row(one.kind.cov, one.kind.boundary == packing::Boundary::periodic ? "periodic" : "walls",
                one.kind.jammed ? "jammed" : "at_density", kind->density.mean, kind->pressure.mean,
                one.coordination, name_of(one.law), name_of(one.measure), one.eps, material.name,
                material.micro.radius_ratio, one.relative_modulus[m].count, one.relative_modulus[m].mean,
                one.relative_modulus[m].deviation, material.youngs_modulus / material.micro.youngs_modulus,
                one.poissons_ratio[m].mean, one.poissons_ratio[m].deviation, material.poissons_ratio,
                one.deviation());
    }
  }
  table.commit();
  tabulate(result).write_csv(out.file("results.csv")); // last: a folder with it is whole
}

} // namespace cdem::examples::micro_parameters
