#pragma once

// What rve_tension prints and writes.

#include <cdem/io/bonds_vtu.hpp>
#include <cdem/io/csv.hpp>
#include <cdem/io/output_directory.hpp>
#include <cdem/io/packing_quality.hpp>
#include <cdem/io/particles_vtu.hpp>
#include <cdem/io/results.hpp>
#include <cdem/io/specimens_vtu.hpp>

#include <cstdio>

#include "scenario.hpp"

namespace cdem::examples::rve_tension {

/// Reduced pressure above which contacts can be told from gaps.
constexpr double jammed = 1e4;

/// Says in a line each what a packing is not.
inline void remark(const Params& params, const Result& result) {
  if (!result.packing_reported)
    return;
  if (!result.packing.reached())
    std::printf("The packing jammed at a density of %.4f, below the %.4g asked for: walls and equal sizes "
                "keep spheres apart; --growth below %g packs denser.\n",
                result.packing.density, params.packing.density, params.packing.growth_rate);
  if (result.packing.pressure < jammed)
    std::printf("The packing is not jammed (reduced pressure %.0f): hardly any spheres touch, so no "
                "rattlers are counted.\n",
                result.packing.pressure);
}

/// The packing and its bonds, beside the paper's.
inline void add_body(io::Results& table, const Params& params, const Result& result) {
  const std::string printed = "[L17] section 2.1";
  const auto at_size = [&](std::uint32_t particles, double value) {
    return result.specimen.particles.size() == particles ? std::optional(value) : std::nullopt;
  };
  const auto or_else = [](std::optional<double> a, std::optional<double> b) { return a ? a : b; };

  table.add({"packing.density", "phi", result.specimen.density(), "1", 0.64, printed});
  if (result.packing_reported) {
    table.add({"packing.reduced_pressure", "PV/NkT", result.packing.pressure});
    table.add({"packing.largest_overlap", "", result.packing.largest_overlap});
    if (result.packing.pressure >=
        jammed) // before, spheres hardly touch and rattlers are not told from the others
      table.add({"packing.rattlers", "", static_cast<double>(result.packing.rattlers)});
    table.add(
        {"packing.cov", "CoV", result.packing.cov, "1", params.packing.cov, "asked for, before truncation"});
  }
  table.add({"network.eps", "eps", result.specimen.eps, "1",
             or_else(at_size(10000, 1.7e-4), at_size(700000, 5.0e-5)), printed});
  table.add({"network.coordination", "Z", result.specimen.network.coordination(), "1", 6.2, printed});
  const char* planes[3] = {"yz", "zx", "xy"};
  for (std::size_t k = 0; k < 3; ++k)
    table.add({std::string("network.anisotropy[plane=") + planes[k] + "]", "E_k",
               result.anisotropy.deviation[k], "1", at_size(10000, 1.3e-3), printed});
  table.add(
      {"network.anisotropy[chance]", "E_k", network::isotropic_deviation(result.specimen.network.size())});
  table.add({"network.hanging_on_nothing", "", static_cast<double>(result.outside_largest)});
}

/// Every figure beside the paper's, or beside what mechanics asks for.
inline io::Results tabulate(const Params& params, const Result& result) {
  io::Results table;
  add_body(table, params, result);
  for (const MaterialResult& m : result.materials) {
    const std::string& name = m.material.name;
    const std::string source = "[L17] section 2.3";
    const double E = m.material.youngs_modulus, nu = m.material.poissons_ratio;
    table.add({name + ".youngs_modulus", "E_M", m.moduli.youngs_modulus, "Pa", E, source});
    table.add(
        {name + ".youngs_modulus[strain=nominal]", "E_M", m.moduli.nominal_youngs_modulus, "Pa", E, source});
    table.add({name + ".youngs_modulus[strain=interior]", "E_M", m.moduli.interior_youngs_modulus, "Pa", E,
               source});
    table.add({name + ".poissons_ratio", "nu_M", m.moduli.poissons_ratio, "1", nu, source});
    table.add({name + ".poissons_ratio[strain=interior]", "nu_M", m.moduli.interior_poissons_ratio, "1", nu,
               source});
    table.add({name + ".relative_modulus", "E_a", m.moduli.youngs_modulus / m.material.micro.youngs_modulus,
               "1", E / m.material.micro.youngs_modulus, source});
    if (params.method == Method::verlet) {
      table.add({name + ".time_step", "dt", m.material.time_step, "s", m.material.time_step, source});
      table.add({name + ".critical_time_step[density=real]", "dt_crit", m.critical.time_step, "s"});
      table.add({name + ".mass_factor", "", m.scaling.mass_factor});
      table.add({name + ".steps", "", static_cast<double>(m.motion.step)});
    } else {
      table.add({name + (params.method == Method::statics ? ".solver.outer_iterations" : ".solver.steps"), "",
                 static_cast<double>(m.solver.iterations)});
      table.add({name + ".solver.relative_residual", "", m.solver.relative_residual});
      table.add({name + ".solver.work", "K u", m.solver.work});
      table.add({name + ".solver.time", "", m.solver.seconds, "s"});
    }
    table.add({name + ".strain", "eps_L", m.strain});
    const auto component = stress::statistics(m.stress, params.axis, params.axis);
    const char axis = core::name_of(params.axis);
    const std::string sigma = std::string("sigma_") + axis + axis;
    table.add(
        {name + ".stress.mean", sigma, component.mean, "Pa", m.force_fixed / m.section, "F/S of this run"});
    table.add({name + ".stress.minimum", sigma, component.minimum, "Pa"});
    table.add({name + ".stress.maximum", sigma, component.maximum, "Pa"});
    table.add({name + ".stress.cov", "CoV", component.coefficient_of_variation()});
    const int k = core::index_of(params.axis);
    table.add({name + ".stress.moment", "sum V sigma", stress::moment_of_stress(m.stress)(k, k), "N m",
               m.moment_of_reactions, "sum F x of this run"});
    table.add(
        {name + ".reaction[face=loaded]", "F", m.force_loaded, "N", m.force_fixed, "fixed face of this run"});
    table.add({name + ".energy.accounted", "W", m.energy.kinetic + m.energy.elastic + m.energy.dissipated,
               "J", m.energy.external_work + m.energy.initial, "external work of this run"});
  }
  return table;
}

/// The curves of figure 5 and the energies.
inline void write_curve(const MaterialResult& m, const std::filesystem::path& path) {
  io::CsvWriter curve(path, {"step", "time_s", "youngs_modulus_pa", "youngs_modulus_average_pa",
                             "youngs_modulus_steady_pa", "poissons_ratio", "poissons_ratio_average",
                             "poissons_ratio_steady", "reaction_fixed_n", "reaction_loaded_n", "kinetic_j",
                             "elastic_j", "external_work_j", "dissipated_j"});
  for (const auto& s : m.samples)
    curve.row(static_cast<std::uint64_t>(s.step), s.time, s.youngs_modulus, s.youngs_modulus_average,
              s.youngs_modulus_steady, s.poissons_ratio, s.poissons_ratio_average, s.poissons_ratio_steady,
              s.force_fixed, s.force_loaded, s.kinetic, s.elastic, s.external_work, s.dissipated);
  curve.commit();
}

/// Writes results.csv, the curves, the angles and the fields.
inline void write(const Params& params, const Result& result, const io::OutputDirectory& out) {
  io::write_angles(out.file("angles.csv"), result.anisotropy);

  io::CsvWriter degrees(out.file("degrees.csv"), {"bonds_of_a_particle", "particles"});
  for (std::size_t d = 0; d < result.degrees.particles.size(); ++d)
    degrees.row(d, result.degrees.particles[d]);
  degrees.commit();

  for (const MaterialResult& m : result.materials) {
    const std::string& name = m.material.name;
    if (m.samples.empty()) // a static solution has no history
      std::filesystem::remove(out.file(name + "_convergence.csv"));
    else
      write_curve(m, out.file(name + "_convergence.csv"));

    const std::string title = name + " in tension along " + core::name_of(params.axis);
    io::ParticleFields fields = io::fields_of(m.motion);
    fields.title = title;
    io::write_particles_vtu(out.file(name + "_particles.vtu"), result.specimen.particles, fields);
    io::BondFields bonds;
    bonds.force = m.bond_forces;
    bonds.time = m.motion.time;
    bonds.title = title + ", bond forces averaged over time";
    io::write_bonds_vtu(out.file(name + "_bonds.vtu"), result.specimen.particles, result.specimen.network,
                        bonds);
    io::SpecimenFields specimens = io::fields_of(m.stress);
    specimens.time = m.motion.time;
    specimens.title = title + ", stress averaged over time";
    io::write_specimens_vtu(out.file(name + "_specimens.vtu"), result.tessellation.corner_points(),
                            result.tessellation.cell_corners(), specimens);
  }
  tabulate(params, result).write_csv(out.file("results.csv")); // last: a folder with it is whole
}

} // namespace cdem::examples::rve_tension
