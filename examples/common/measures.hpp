#pragma once

// The ways in which E and nu of one packing are measured.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/homogenize/periodic_stiffness.hpp>
#include <cdem/homogenize/static_tension.hpp>
#include <cdem/simulation/specimen.hpp>

#include <array>
#include <cmath>
#include <limits>

#include "static_solver.hpp"

namespace cdem::examples {

/// How the strain of a body is taken.
enum class Measure : std::uint8_t {
  faces,    ///< tension of the walled or cut cube, the faces' motion over the distance of their mean centres
  nominal,  ///< the same over the side of the cube, as the paper defines it; nu has no such measure
  interior, ///< the same by the slope of displacement over the interior
  periodic, ///< mean strain on the periodic network, isotropic part of the 6x6 stiffness
};
inline constexpr std::array all_measures{Measure::faces, Measure::nominal, Measure::interior,
                                         Measure::periodic};

inline const char* name_of(Measure measure) {
  constexpr std::array names{"faces", "nominal", "interior", "periodic"};
  return names[static_cast<std::size_t>(measure)];
}

/// E and nu by each measure; NaN where they were not measured.
struct MeasuredModuli {
  struct Moduli {
    double youngs_modulus = std::numeric_limits<double>::quiet_NaN(); ///< Pa
    double poissons_ratio = std::numeric_limits<double>::quiet_NaN();
  };
  std::array<Moduli, all_measures.size()> by = {};

  Moduli& operator[](Measure measure) { return by[static_cast<std::size_t>(measure)]; }
  const Moduli& operator[](Measure measure) const { return by[static_cast<std::size_t>(measure)]; }
  bool has(Measure measure) const { return std::isfinite((*this)[measure].youngs_modulus); }
};

/// Measures a body by the static tension test: faces, nominal and interior.
template <bond::BondLaw Law>
void measure_tension(MeasuredModuli& moduli, const Law& law, const simulation::Specimen& body, Axis axis,
                     const StaticSolver& solver, core::ThreadPool& pool, const core::Monitor& monitor) {
  const auto tension = homogenize::StaticTension{.axis = axis}.measure(
      solver, bond::LinearForces(law, body.particles, body.network), body, pool, monitor);
  moduli[Measure::faces] = {tension.faces.youngs_modulus(), tension.faces.poissons_ratio()};
  moduli[Measure::nominal].youngs_modulus = tension.faces.nominal_youngs_modulus();
  moduli[Measure::interior] = {tension.interior_youngs_modulus(), tension.interior.poissons_ratio()};
}

/// Measures a periodic body under six mean strains, each solved to a relative residual of 1e-6: the stiffness is symmetric
/// to less.
template <bond::BondLaw Law>
homogenize::Stiffness measure_periodic(MeasuredModuli& moduli, const Law& law,
                                       const simulation::Specimen& cell, core::ThreadPool& pool,
                                       const core::Monitor& monitor) {
  const StaticSolver solver{.relative_residual = 1e-6};
  const auto found = homogenize::periodic_stiffness(bond::LinearForces(law, cell.particles, cell.network),
                                                    cell.box, solver, pool, monitor);
  moduli[Measure::periodic] = {found.stiffness.youngs_modulus(), found.stiffness.poissons_ratio()};
  return found.stiffness;
}

} // namespace cdem::examples
