#pragma once

// What calibration prints and writes.

#include <cdem/io/calibration_chart.hpp>
#include <cdem/io/output_directory.hpp>
#include <cdem/io/results.hpp>

#include "scenario.hpp"

namespace cdem::examples::calibration {

namespace detail {

inline void add_chart(io::Results& table, const KindResult& kind, const std::string& condition) {
  const homogenize::CalibrationChart& chart = kind.fit.chart;
  const auto add = [&](const std::string& name, const std::string& symbol, double value) {
    table.add({"chart." + name + "[" + condition + "]", symbol, value});
  };
  const auto add_polynomial = [&](const std::string& name, const std::string& symbol,
                                  const homogenize::Polynomial& polynomial,
                                  const homogenize::OrderChoice& choice) {
    add(name + ".order", "", polynomial.order());
    for (std::size_t k = 0; k < polynomial.coefficients.size(); ++k)
      table.add({"chart." + name + ".coefficient[k=" + std::to_string(k) + "," + condition + "]", symbol,
                 polynomial.coefficients[k]});
    for (std::size_t k = 0; k < choice.error.size(); ++k)
      table.add({"chart." + name + ".cross_validation[order=" + std::to_string(k + 1) + "," + condition + "]",
                 "", choice.error[k]});
  };
  add_polynomial("modulus", "P", chart.modulus, kind.fit.modulus);
  add_polynomial("poissons_ratio", "Q", chart.poissons_ratio, kind.fit.poissons_ratio);
  add("modulus.residual", "", chart.modulus_residual);
  add("modulus.scatter", "", chart.modulus_scatter);
  add("poissons_ratio.residual", "", chart.poissons_residual);
  add("poissons_ratio.scatter", "", chart.poissons_scatter);
  add("scatter_correlation", "", chart.scatter_correlation);
  add("poissons_ratio.highest", "nu_M", chart.poissons_ratio(chart.smallest_ratio));
  add("poissons_ratio.lowest", "nu_M", chart.poissons_ratio(chart.largest_ratio));
}

/// Other microscopic Poisson's ratios and other E_mu beside the study's.
inline void add_influences(io::Results& table, const KindResult& kind, const std::string& condition) {
  const auto add = [&](const Measurement& m, const std::string& what) {
    for (const Measurement& base : kind.points)
      if (base.seed == m.seed && base.radius_ratio == m.radius_ratio) {
        const std::string at = "[" + what + ",r_mu=" + core::to_text(m.radius_ratio) + "," + condition + "]";
        const std::string source = "nu_mu " + core::to_text(base.micro_ratio) + ", E_mu 1 Pa, same packing";
        table.add({"influence.relative_modulus" + at, "E_a", m.relative_modulus, "1", base.relative_modulus,
                   source});
        table.add(
            {"influence.poissons_ratio" + at, "nu_M", m.poissons_ratio, "1", base.poissons_ratio, source});
      }
  };
  for (const Measurement& m : kind.micro)
    add(m, "nu_mu=" + core::to_text(m.micro_ratio));
  for (const Measurement& m : kind.other_unit)
    add(m, "e_mu=" + core::to_text(m.micro_modulus));
}

inline void add_materials(io::Results& table, const KindResult& kind, const std::string& condition) {
  for (std::size_t k = 0; k < materials().size(); ++k) {
    const Material& material = materials()[k];
    const auto name = [&](const std::string& quantity) {
      return material.name + "." + quantity + "[" + condition + "]";
    };
    if (!kind.calibrated[k])
      continue;
    const homogenize::MicroParameters& micro = *kind.calibrated[k];
    table.add({name("micro_modulus"), "E_mu", micro.youngs_modulus, "Pa", material.printed_modulus,
               "[L17] section 2.4"});
    table.add({name("micro_modulus.deviation"), "", micro.youngs_modulus_deviation});
    table.add(
        {name("radius_ratio"), "r_mu", micro.radius_ratio, "1", material.printed_ratio, "[L17] section 2.4"});
    table.add({name("radius_ratio.deviation"), "", micro.radius_ratio_deviation});
    table.add({name("youngs_modulus.deviation"), "", micro.macro_modulus_deviation});
    table.add({name("poissons_ratio.deviation"), "", micro.macro_poissons_deviation});
    if (const auto& verified = kind.verified[k]) {
      const std::string source = "wanted; packing of seed " + std::to_string(verified->seed);
      table.add({name("youngs_modulus"), "E_M", verified->relative_modulus * verified->micro_modulus, "Pa",
                 material.macro.youngs_modulus, source});
      table.add({name("poissons_ratio"), "nu_M", verified->poissons_ratio, "1", material.macro.poissons_ratio,
                 source});
    }
  }
}

} // namespace detail

inline std::string condition_of(const KindResult& kind) {
  return kind.given ? "packing=given" : "cov=" + core::to_text(kind.kind.cov);
}

/// Every figure; what was wanted, and the paper's micro parameters, beside it.
inline io::Results tabulate(const Result& result) {
  io::Results table;
  for (const KindResult& kind : result.kinds) {
    detail::add_materials(table, kind, condition_of(kind));
    detail::add_chart(table, kind, condition_of(kind));
    detail::add_influences(table, kind, condition_of(kind));
  }
  return table;
}

/// Writes results.csv, the points, the fits, the paper's points and a chart a kind of packing.
inline void write(const Result& result, const io::OutputDirectory& out) {
  io::CsvWriter points(out.file("calibration_points.csv"),
                       {"cov", "seed", "radius_ratio", "relative_modulus", "poissons_ratio", "affine_modulus",
                        "affine_poissons_ratio", "distance_from_isotropy", "universal_anisotropy",
                        "seconds"});
  io::CsvWriter fits(out.file("calibration_fit.csv"),
                     {"cov", "radius_ratio", "relative_modulus", "poissons_ratio"});
  for (const KindResult& kind : result.kinds) {
    for (const Measurement& m : kind.points)
      points.row(m.cov, m.seed, m.radius_ratio, m.relative_modulus, m.poissons_ratio, m.affine_modulus,
                 m.affine_poissons, m.distance, m.anisotropy, m.seconds);
    const homogenize::CalibrationChart& chart = kind.fit.chart;
    constexpr int steps = 160;
    for (int k = 0; k <= steps; ++k) {
      const double r = chart.smallest_ratio + (chart.largest_ratio - chart.smallest_ratio) * k / steps;
      fits.row(kind.kind.cov, r, chart.relative_modulus(r), chart.poissons_ratio(r));
    }
    const std::string name = condition_of(kind);
    io::save_chart(out.file(name.substr(0, name.find('=')) + name.substr(name.find('=') + 1) + ".chart"),
                   chart);
  }
  points.commit();
  fits.commit();
  io::CsvWriter printed(out.file("calibration_printed.csv"),
                        {"material", "radius_ratio", "relative_modulus", "poissons_ratio"});
  for (const Material& m : materials())
    printed.row(m.name, m.printed_ratio, m.macro.youngs_modulus / m.printed_modulus, m.macro.poissons_ratio);
  printed.commit();
  tabulate(result).write_csv(out.file("results.csv")); // last: a folder with it is whole
}

} // namespace cdem::examples::calibration
