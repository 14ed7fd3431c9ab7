#pragma once

// What stress_homogeneous prints and writes.

#include <cdem/io/csv.hpp>
#include <cdem/io/output_directory.hpp>
#include <cdem/io/results.hpp>
#include <cdem/io/specimens_vtu.hpp>

#include "scenario.hpp"

namespace cdem::examples::stress_homogeneous {

/// Particles a specimen that the paper names, and the CoV there: [L17] section 2.5.
inline constexpr std::array<std::pair<double, double>, 2> printed_crossings{{{80, 0.10}, {1200, 0.05}}};

namespace detail {

inline const char* source() {
  return "[L17] section 2.5";
}

inline std::string condition_of(const Tessellated& one) {
  return std::string("cells=") + name_of(one.cells) + ",specimens=" + std::to_string(one.specimens);
}

/// Thickness of a layer without stress under each of the two faces across an axis that would lower the outermost layers of
/// specimens as much as they are, in mean distances of particles.
inline double unloaded_layer(const Result& result, int axis) {
  const auto k = static_cast<std::size_t>(axis);
  const auto& layers = result.layers;
  double inner = 0;
  for (std::size_t n = 1; n + 1 < layers.size(); ++n)
    inner += layers[n].mean[k] / static_cast<double>(layers.size() - 2);
  const double missing = 1 - 0.5 * (layers.front().mean[k] + layers.back().mean[k]) / inner;
  return missing / static_cast<double>(layers.size()) *
         std::cbrt(static_cast<double>(result.tension.specimen.particles.size()));
}

inline void add_body(io::Results& table, const std::string& name, const Result& result) {
  const auto& m = result.material();
  table.add({"network.coordination", "Z", result.tension.specimen.network.coordination(), "1", 6.2,
             "[L17] section 2.1"});
  table.add({name + ".youngs_modulus", "E_M", m.moduli.youngs_modulus, "Pa", m.material.youngs_modulus,
             "[L17] section 2.3"});
  table.add({name + ".youngs_modulus[strain=interior]", "E_M", m.moduli.interior_youngs_modulus, "Pa",
             m.material.youngs_modulus, "[L17] section 2.3"});
  table.add({name + ".strain", "eps_L", result.strain});
  table.add({name + ".stress.of_faces", "F/S", result.face_stress, "Pa",
             result.strain * m.moduli.youngs_modulus, "E times strain of this packing"});
  table.add({name + ".stress.mean", "sigma_xx", result.mean_stress, "Pa", result.face_stress,
             "E times strain of this packing"});
  table.add({name + ".stress.mean[e=interior]", "sigma_xx", result.mean_stress, "Pa", result.interior_stress,
             "E of the interior times the strain of the faces"});
  table.add({name + ".stress.mean[e=printed]", "sigma_xx",
             result.mean_stress * m.material.youngs_modulus / m.moduli.youngs_modulus, "Pa", 243.3e6,
             source()});
  table.add({name + ".faces.distance", "", result.gauge_length, "m"});
  table.add({name + ".faces.distance[weight=force]", "", result.force_length, "m",
             result.mean_stress / result.face_stress *
                 result.tension.specimen.box.size()[core::index_of(result.axis())],
             "mean stress over F/S, times the side"});
  for (int k = 0; k < 3 && result.layers.size() > 2; ++k)
    table.add({name + ".stress.unloaded_layer[face=" + std::string(1, "xyz"[k]) + "]", "d",
               unloaded_layer(result, k), "spacing"});
  table.add({name + ".solver.outer_iterations", "", static_cast<double>(m.solver.iterations)});
  table.add({name + ".solver.relative_residual", "", m.solver.relative_residual});
}

inline void add_tessellation(io::Results& table, const std::string& name, const Result& result,
                             const Tessellated& one) {
  const std::string at = "[" + condition_of(one) + "]";
  const bool figure = one.cells == Cells::hexahedra && one.specimens == 3375;
  const auto printed = [&](double value) { return figure ? std::optional(value / 243.3e6) : std::nullopt; };
  const double mean = one.all.moments.mean;
  table.add({name + ".stress.particles_per_specimen" + at, "n", one.particles});
  table.add({name + ".stress.moment" + at, "sum V sigma", one.moment, "N m",
             result.mean_stress * result.tension.specimen.box.volume(), "sum F x of this run"});
  table.add({name + ".stress.relative_minimum" + at, "min/mean", one.all.minimum / mean, "1",
             printed(191.7e6), figure ? source() : ""});
  table.add({name + ".stress.relative_maximum" + at, "max/mean", one.all.maximum / mean, "1",
             printed(344.4e6), figure ? source() : ""});
  table.add({name + ".stress.cov" + at, "CoV", one.all.cov()});
  table.add({name + ".stress.cov[" + condition_of(one) + ",part=between_faces]", "CoV", one.surface});
  if (!one.interior)
    return;
  const std::string inside = "[" + condition_of(one) + ",body=interior]";
  table.add({name + ".stress.interior_mean" + inside, "sigma_xx", one.interior->moments.mean, "Pa",
             result.face_stress, "E times strain of this packing"});
  table.add({name + ".stress.cov" + inside, "CoV", one.interior->cov()});
}

inline void add_curve(io::Results& table, const Result& result, const std::string& condition,
                      const Curve& curve, bool compare) {
  if (curve.size() < 2)
    return;
  const std::string& name = result.material().material.name;
  const PowerLaw law = power_law(curve);
  table.add({name + ".stress.cov_exponent[" + condition + "]", "", law.exponent, "1", -0.5,
             "independent specimens"});
  table.add({name + ".stress.cov_exponent_error[" + condition + "]", "", law.error});
  if (compare) {
    const auto total = static_cast<double>(result.tension.specimen.particles.size());
    const TwoParts parts = two_parts(curve, total);
    const TwoParts printed = two_parts({printed_crossings.begin(), printed_crossings.end()}, paper_particles);
    const char* through = "through the two points of [L17] section 2.5";
    table.add({name + ".stress.bulk_cov[" + condition + "]", "", parts.bulk, "1", printed.bulk, through});
    table.add({name + ".stress.fitted_layer[" + condition + "]", "d", parts.layer, "spacing", printed.layer,
               through});
  }
  for (const auto& [particles, cov] : printed_crossings) {
    const Crossing found = crossing(curve, cov);
    table.add({name + ".stress.particles_at_cov[cov=" + core::to_text(cov) + "," + condition +
                   (found.interpolated ? "]" : ",extrapolated]"),
               "n", found.particles, "1", compare ? std::optional(particles) : std::nullopt,
               compare ? source() : ""});
  }
}

} // namespace detail

/// The body, and where the CoV of hexahedra falls to the levels of the paper.
inline io::Results headline(const Result& result) {
  io::Results table;
  const std::string& name = result.material().material.name;
  detail::add_body(table, name, result);
  for (const bool interior : {false, true})
    detail::add_curve(table, result, std::string("cells=hexahedra") + (interior ? ",body=interior" : ""),
                      result.curve(Cells::hexahedra, interior), true);
  return table;
}

/// Every figure beside the paper's, or beside what mechanics asks for.
inline io::Results tabulate(const Result& result) {
  io::Results table;
  const std::string& name = result.material().material.name;
  detail::add_body(table, name, result);
  for (const Tessellated& one : result.tessellations)
    detail::add_tessellation(table, name, result, one);
  for (const Cells cells : all_cells) {
    const std::string shape = std::string("cells=") + name_of(cells);
    const bool compare = cells == Cells::hexahedra || cells == Cells::hexahedra_by_contact;
    detail::add_curve(table, result, shape, result.curve(cells, false), compare);
    detail::add_curve(table, result, shape + ",body=interior", result.curve(cells, true), compare);
  }
  for (const Average& one : result.averages) {
    const std::string at = "[estimator=" + one.estimator + ",particles=" + core::to_text(one.particles) + "]";
    table.add({name + ".stress.cov" + at, "CoV", one.scatter.cov()});
    table.add({name + ".stress.cov_error" + at, "", one.scatter.moments.coefficient_error()});
  }
  for (const char* estimator : {"halo", "lucy", "gaussian"})
    detail::add_curve(table, result, std::string("estimator=") + estimator, result.curve(estimator), false);
  return table;
}

namespace detail {

/// A number for a table on a terminal.
inline std::string short_text(double value, const char* form = "%.3g") {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), form, value);
  return text.data();
}

/// What the tests say of a sample, in words.
inline std::string verdict(const Scatter& scatter) {
  if (!scatter.likelihood)
    return "not log-normal: a stress is not above 0";
  const double score = scatter.likelihood->score;
  const bool normal = scatter.normal.p_value >= 0.05, lognormal = scatter.lognormal->p_value >= 0.05;
  std::string text = score > 1.96    ? "log-normal is likelier"
                     : score < -1.96 ? "normal is likelier"
                                     : "no telling";
  if (!normal && !lognormal)
    text += ", neither fits";
  else if (!normal)
    text += ", normal is refused";
  else if (!lognormal)
    text += ", log-normal is refused";
  return text;
}

inline std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<bool> right(rows[0].size(), true);
  right.back() = false;
  return io::detail::aligned(rows, right);
}

} // namespace detail

/// Figures 9b and 9c as a table: hexahedra, all of them and those of the interior.
inline std::string variability_text(const Result& result) {
  std::vector<std::vector<std::string>> rows{{"specimens", "particles", "mean, MPa", "min", "max",
                                              "95 %: from", "to", "CoV %", "of faces", "interior: mean",
                                              "min", "max", "CoV %", "extremes at"}};
  const auto mpa = [](double pascal) { return detail::short_text(1e-6 * pascal, "%.1f"); };
  const auto percent = [](double part) { return detail::short_text(100 * part, "%.2f"); };
  for (const Tessellated* one : result.with(Cells::hexahedra)) {
    const double half = one->all.moments.prediction(), mean = one->all.moments.mean;
    std::vector<std::string> row{std::to_string(one->specimens),
                                 detail::short_text(one->particles, "%.1f"),
                                 mpa(mean),
                                 mpa(one->all.minimum),
                                 mpa(one->all.maximum),
                                 mpa(mean - half),
                                 mpa(mean + half),
                                 percent(one->all.cov()),
                                 percent(one->surface)};
    if (one->interior)
      row.insert(row.end(), {mpa(one->interior->moments.mean), mpa(one->interior->minimum),
                             mpa(one->interior->maximum), percent(one->interior->cov())});
    else
      row.resize(row.size() + 4);
    row.push_back(one->minimum.face + ", " + one->maximum.face);
    rows.push_back(row);
  }
  return detail::aligned(rows);
}

/// Normal or log-normal, for the interior of each tessellation in hexahedra and for every other specimen of it.
inline std::string distribution_text(const Result& result) {
  std::vector<std::vector<std::string>> rows{{"particles", "sample", "n", "skewness", "+-", "log-normal's",
                                              "kurtosis", "+-", "A2 normal", "p", "A2 log", "p", "ln L ratio",
                                              "score", "verdict"}};
  for (const Tessellated* one : result.with(Cells::hexahedra))
    for (const auto& [sample, scatter] : {std::pair("interior", &one->interior), {"thinned", &one->thinned}})
      if (*scatter) {
        const Scatter& s = **scatter;
        std::vector<std::string> row{detail::short_text(one->particles, "%.1f"),
                                     sample,
                                     std::to_string(s.moments.count),
                                     detail::short_text(s.moments.skewness),
                                     detail::short_text(s.moments.skewness_error()),
                                     detail::short_text(s.cov() * (3 + s.cov() * s.cov())),
                                     detail::short_text(s.moments.excess_kurtosis),
                                     detail::short_text(s.moments.kurtosis_error()),
                                     detail::short_text(s.normal.modified),
                                     detail::short_text(s.normal.p_value)};
        if (s.likelihood)
          row.insert(row.end(),
                     {detail::short_text(s.lognormal->modified), detail::short_text(s.lognormal->p_value),
                      detail::short_text(s.likelihood->in_favour_of_lognormal()),
                      detail::short_text(s.likelihood->score)});
        else
          row.resize(row.size() + 4);
        row.push_back(detail::verdict(s));
        rows.push_back(row);
      }
  return rows.size() == 1 ? std::string() : detail::aligned(rows);
}

/// The estimators over volumes of one size.
inline std::string estimators_text(const Result& result) {
  std::vector<std::vector<std::string>> rows{{"particles", "places", "CoV %", "+-", "skewness", "estimator"}};
  for (const Average& one : result.averages)
    rows.push_back({core::to_text(one.particles), std::to_string(one.scatter.moments.count),
                    detail::short_text(100 * one.scatter.cov(), "%.2f"),
                    detail::short_text(100 * one.scatter.moments.coefficient_error(), "%.2f"),
                    detail::short_text(one.scatter.moments.skewness), one.estimator});
  return rows.size() == 1 ? std::string() : detail::aligned(rows);
}

namespace detail {

/// A table whose rows begin with what a sample is and go on with how it scatters.
class ScatterTable {
public:
  ScatterTable(const std::filesystem::path& path, std::vector<std::string> columns)
      : csv_(path, with_scatter(std::move(columns))) {}

  template <class... Fields>
  void row(const Scatter& s, const Fields&... fields) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto& m = s.moments;
    const double half = m.prediction();
    csv_.row(fields..., m.count, m.mean, s.minimum, s.maximum, s.cov(), m.coefficient_error(), m.mean - half,
             m.mean + half, m.skewness, m.skewness_error(), m.excess_kurtosis, m.kurtosis_error(),
             s.normal.modified, s.normal.p_value, s.lognormal ? s.lognormal->modified : nan,
             s.lognormal ? s.lognormal->p_value : nan,
             s.likelihood ? s.likelihood->in_favour_of_lognormal() : nan,
             s.likelihood ? s.likelihood->score : nan);
  }
  void commit() { csv_.commit(); }

private:
  static std::vector<std::string> with_scatter(std::vector<std::string> columns) {
    for (const char* column :
         {"count", "mean_pa", "minimum_pa", "maximum_pa", "cov", "cov_error", "prediction_low_pa",
          "prediction_high_pa", "skewness", "skewness_error", "excess_kurtosis", "kurtosis_error",
          "a2_normal", "p_normal", "a2_lognormal", "p_lognormal", "log_likelihood_ratio", "vuong_score"})
      columns.emplace_back(column);
    return columns;
  }
  io::CsvWriter csv_;
};

inline void write_variability(const std::filesystem::path& path, const Result& result) {
  ScatterTable table(path, {"cells", "body", "specimens", "particles", "particles_cov", "cov_between_faces"});
  for (const Tessellated& one : result.tessellations)
    for (const auto& [body, scatter] : {std::pair<const char*, const Scatter*>("all", &one.all),
                                        {"interior", one.interior ? &*one.interior : nullptr},
                                        {"thinned", one.thinned ? &*one.thinned : nullptr}})
      if (scatter)
        table.row(*scatter, name_of(one.cells), body, one.specimens, one.particles, one.particles_cov,
                  one.surface);
  table.commit();
}

inline void write_estimators(const std::filesystem::path& path, const Result& result) {
  ScatterTable table(path, {"estimator", "particles"});
  for (const Average& one : result.averages)
    table.row(one.scatter, one.estimator, one.particles);
  table.commit();
}

/// Where the extremes lie, and how neighbours are correlated.
inline void write_extremes(const std::filesystem::path& path, const Result& result) {
  io::CsvWriter csv(path, {"cells", "specimens", "particles", "extreme", "stress_pa", "face", "x", "y", "z",
                           "correlation_along", "correlation_across"});
  const geometry::Box& box = result.tension.specimen.box;
  for (const Tessellated& one : result.tessellations)
    for (const auto& [name, extreme] : {std::pair("minimum", &one.minimum), {"maximum", &one.maximum}}) {
      const Vec3 place = (extreme->centre - box.lower).cwiseQuotient(box.size());
      csv.row(name_of(one.cells), one.specimens, one.particles, name, extreme->stress, extreme->face,
              place.x(), place.y(), place.z(), one.along, one.across);
    }
  csv.commit();
}

inline void write_layers(const std::filesystem::path& path, const Result& result) {
  io::CsvWriter csv(path, {"position", "mean_across_x", "mean_across_y", "mean_across_z"});
  for (const Layer& layer : result.layers)
    csv.row(layer.position, layer.mean[0], layer.mean[1], layer.mean[2]);
  csv.commit();
}

} // namespace detail

/// Writes results.csv, the curves and the stress of the specimens of figure 9a.
inline void write(const Result& result, const io::OutputDirectory& out) {
  detail::write_variability(out.file("variability.csv"), result);
  detail::write_estimators(out.file("estimators.csv"), result);
  detail::write_extremes(out.file("extremes.csv"), result);
  detail::write_layers(out.file("layers.csv"), result);
  const std::string& name = result.material().material.name;
  io::SpecimenFields fields = io::fields_of(result.slice);
  fields.title = name + " in tension along " + core::name_of(result.axis());
  io::write_specimens_vtu(out.file(name + "_specimens.vtu"), result.slice_cells, fields);
  tabulate(result).write_csv(out.file("results.csv")); // last: a folder with it is whole
}

} // namespace cdem::examples::stress_homogeneous
