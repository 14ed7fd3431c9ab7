#pragma once

// What custom_bond_law prints and writes.

#include <cdem/io/bonds_vtu.hpp>
#include <cdem/io/csv.hpp>
#include <cdem/io/output_directory.hpp>
#include <cdem/io/results.hpp>

#include "scenario.hpp"

namespace cdem::examples::custom_bond_law {

inline std::string name_of(Method method) {
  return method == Method::statics ? "static" : method == Method::relaxation ? "relaxation" : "verlet";
}

/// Every figure beside its closed form, or beside the first method's.
inline io::Results tabulate(const Result& result) {
  io::Results table;
  const Tearing& tearing = result.tearing;
  table.add({"bond.peak_load", "F", tearing.peak_load, "N", tearing.exact_peak_load, "K_n L onset"});
  table.add({"bond.dissipated_energy", "", tearing.dissipated, "J", tearing.exact_dissipated,
             "K_n L^2 onset rupture/2"});
  table.add({"cube.youngs_modulus[strain=0]", "E_M", result.elastic_modulus, "Pa"});
  const Pulled& first = result.pulled.front();
  const auto add = [&](const std::string& quantity, const Pulled& pulled, double value, double reference,
                       const std::string& unit) {
    io::Result line{quantity + "[method=" + name_of(pulled.method) + "]", "", value, unit, {}, {}};
    if (&pulled != &first) {
      line.reference = reference;
      line.source = name_of(first.method) + " of this run";
    }
    table.add(line);
  };
  const auto bonds = static_cast<double>(result.specimen.network.size());
  for (const Pulled& pulled : result.pulled) {
    add("cube.secant_modulus", pulled, pulled.youngs_modulus, first.youngs_modulus, "Pa");
    add("cube.softened_bonds", pulled, static_cast<double>(pulled.softened) / bonds,
        static_cast<double>(first.softened) / bonds, "1");
    add("cube.elastic_energy", pulled, pulled.elastic, first.elastic, "J");
    add("cube.dissipated_energy", pulled, pulled.dissipated, first.dissipated, "J");
  }
  return table;
}

/// Writes the curve of the bond, the bonds of the cube and results.csv.
inline void write(const Result& result, const io::OutputDirectory& out) {
  io::CsvWriter curve(out.file("bond_load.csv"), {"strain", "load_n"});
  for (std::size_t k = 0; k < result.tearing.strain.size(); ++k)
    curve.row(result.tearing.strain[k], result.tearing.load[k]);
  curve.commit();
  for (const Pulled& pulled : result.pulled) {
    io::BondFields fields;
    fields.force = pulled.forces;
    fields.extra.push_back({"stiffness_left", pulled.left});
    fields.title = "cube of softening beams in tension, by " + name_of(pulled.method);
    io::write_bonds_vtu(out.file(name_of(pulled.method) + "_bonds.vtu"), result.specimen.particles,
                        result.specimen.network, fields);
  }
  tabulate(result).write_csv(out.file("results.csv")); // last: a folder with it is whole
}

} // namespace cdem::examples::custom_bond_law
