#pragma once

// What rve_convergence prints and writes.

#include <cmath>

#include "rve_tension/report.hpp"
#include "scenario.hpp"

namespace cdem::examples::rve_convergence {

/// Error below which the paper calls a modulus converged, [L17] section 2.3.
constexpr double wanted_error = 1e-3;
/// Part of the steps for which a modulus must have stayed within it.
constexpr std::uint64_t lasting_part = 10;

inline const char* name_of(Modulus modulus) {
  return modulus == Modulus::youngs_modulus ? "youngs_modulus" : "poissons_ratio";
}
inline const char* name_of(Average average) {
  return average == Average::none ? "none" : average == Average::all ? "all" : "steady";
}

/// Steps that the paper needed for E within 1e-3 of the asymptotic value, averaged over all of them and suddenly loaded.
inline std::optional<double> printed_steps(const std::string& material, const std::string& loading,
                                           Modulus modulus, Average average) {
  if (loading != "sudden" || modulus != Modulus::youngs_modulus || average != Average::all)
    return std::nullopt;
  return material == "alumina" ? 17600 : 5200;
}

namespace detail {

inline double or_nan(const std::optional<std::uint64_t>& step) {
  return step ? static_cast<double>(*step) : std::numeric_limits<double>::quiet_NaN();
}

/// One modulus of one march: where its values end, and when they had come so far.
inline void add_modulus(io::Results& table, const Params& params, const Approach& approach,
                        const March& march, Modulus modulus) {
  const std::string& material = march.run.material.name;
  const std::string name = material + "." + name_of(modulus), which = "[loading=" + march.loading;
  const bool youngs = modulus == Modulus::youngs_modulus;
  const double asymptote = approach.asymptote(modulus);
  for (const Average average : averages) {
    const std::vector<double> values = march.curve(modulus, average);
    const std::string conditions = which + ",average=" + name_of(average) + "]";
    const double last = values.empty() ? std::numeric_limits<double>::quiet_NaN() : values.back();
    table.add({name + conditions, youngs ? "E_M" : "nu_M", last, youngs ? "Pa" : "1", asymptote,
               "static solution of this run"});
    const auto printed = printed_steps(material, march.loading, modulus, average);
    table.add({name + ".steps" + conditions, "",
               or_nan(homogenize::settled_from(march.steps, values, asymptote, wanted_error,
                                               march.run.motion.step / lasting_part)),
               "1", printed, printed ? "[L17] section 2.3" : ""});
  }
  table.add({name + ".steps" + which + ",criterion=paper]", "",
             or_nan(homogenize::met_at(homogenize::ConvergenceRule(params.convergence), march.steps,
                                       march.curve(modulus, Average::all)))});
}

inline void add_march(io::Results& table, const Params& params, const Approach& approach,
                      const March& march) {
  for (const Modulus modulus : moduli)
    add_modulus(table, params, approach, march, modulus);
  const std::string& name = march.run.material.name;
  const std::string which = "[loading=" + march.loading + "]";
  table.add({name + ".ramp" + which, "T", march.run.loading.ramp, "s"});
  table.add({name + ".steady_from" + which, "", static_cast<double>(march.run.steady_from)});
  table.add({name + ".vibration" + which, "", march.vibration(approach.asymptote(Modulus::youngs_modulus))});
  table.add({name + ".reaction[face=loaded,loading=" + march.loading + "]", "F", march.run.force_loaded, "N",
             march.run.force_fixed, "fixed face of this run"});
  const integrate::EnergyLedger& energy = march.run.energy;
  table.add({name + ".energy.accounted" + which, "W", energy.kinetic + energy.elastic + energy.dissipated,
             "J", energy.external_work + energy.initial, "external work of this run"});
}

} // namespace detail

/// The moduli by every way, and the steps they took, beside the static solution and the paper.
inline io::Results tabulate(const Params& params, const Result& result) {
  io::Results table;
  rve::add_body(table, params, result.body);
  for (const Approach& approach : result.materials) {
    const rve::MaterialResult& statics = approach.statics;
    const std::string& name = statics.material.name;
    const std::string source = "[L17] section 2.3";
    table.add({name + ".youngs_modulus[method=static]", "E_M", statics.moduli.youngs_modulus, "Pa",
               statics.material.youngs_modulus, source});
    table.add({name + ".poissons_ratio[method=static]", "nu_M", statics.moduli.poissons_ratio, "1",
               statics.material.poissons_ratio, source});
    table.add({name + ".solver.relative_residual", "", statics.solver.relative_residual});
    table.add({name + ".solver.time", "", statics.solver.seconds, "s"});
    const rve::MaterialResult& run = approach.marches.front().run;
    table.add({name + ".time_step", "dt", run.material.time_step, "s", run.material.time_step, source});
    table.add({name + ".mass_factor", "", run.scaling.mass_factor});
    table.add({name + ".first_axial_period", "", 2 * std::numbers::pi / run.first_frequency, "s"});
    for (const March& march : approach.marches)
      detail::add_march(table, params, approach, march);
  }
  return table;
}

/// Writes results.csv and the curves.
inline void write(const Params& params, const Result& result, const io::OutputDirectory& out) {
  for (const Approach& approach : result.materials)
    for (const March& march : approach.marches)
      rve::write_curve(march.run,
                       out.file(march.run.material.name + "_" + march.loading + "_convergence.csv"));
  tabulate(params, result).write_csv(out.file("results.csv")); // last: a folder with it is whole
}

} // namespace cdem::examples::rve_convergence
