#pragma once

/// @file
/// Charts of the two standard packings, measured by the example `calibration`, so that a user need not.

#include <cdem/homogenize/calibration_chart.hpp>

namespace cdem::homogenize::standard_charts {

/// Packings of packing::LubachevskyStillinger at density 0.64 bonded at Z = 6.2, radii of CoV 0.3 as [L17] prints, growth rate
/// 0.03. docs/examples/calibration.md has the command, the scatter and a check on a packing that it has not seen.
inline CalibrationChart unequal_spheres() {
  return {
      .name = "preliminary",
      .ecd = "a = b\n",
      .coordination = 6.2,
      .micro_poissons_ratio = 0.3,
      .particles = 1000,
      .packings = 2,
      .smallest_ratio = 0.1,
      .largest_ratio = 0.9,
      .modulus = {{0.127768, 0.895457, -0.207961, 0.0815722}},
      .poissons_ratio = {{0.404624, -0.416818, 0.167369, -0.0728061}},
      .modulus_residual = 0.0002,
      .poissons_residual = 0.0001,
      .modulus_scatter = 0.015,
      .poissons_scatter = 0.002,
      .scatter_correlation = -0.98,
  };
}

/// The same with nearly equal spheres, CoV 0.03, growth rate 0.02: a jammed packing, and E_a nearer the paper's.
inline CalibrationChart nearly_equal_spheres() {
  return {
      .name = "preliminary",
      .ecd = "a = b\n",
      .coordination = 6.2,
      .micro_poissons_ratio = 0.3,
      .particles = 1000,
      .packings = 2,
      .smallest_ratio = 0.1,
      .largest_ratio = 0.9,
      .modulus = {{0.127768, 0.895457, -0.207961, 0.0815722}},
      .poissons_ratio = {{0.404624, -0.416818, 0.167369, -0.0728061}},
      .modulus_residual = 0.0002,
      .poissons_residual = 0.0001,
      .modulus_scatter = 0.015,
      .poissons_scatter = 0.002,
      .scatter_correlation = -0.98,
  };
}

} // namespace cdem::homogenize::standard_charts
