#pragma once

/// @file
/// Charts of the two standard packings, measured by the example `calibration`, so that a user need not.

#include <cdem/homogenize/calibration_chart.hpp>

namespace cdem::homogenize::standard_charts {

/// Packings of packing::LubachevskyStillinger at density 0.64 bonded at Z = 6.2, radii of CoV 0.3 as [L17] prints, growth rate
/// 0.03. docs/examples/calibration.md has the command, the scatter and a check on a packing that it has not seen.
inline CalibrationChart unequal_spheres() {
  return {
      .name = "Lubachevsky-Stillinger, density 0.64, CoV 0.3, growth 0.03, Z 6.2, periodic",
      .ecd = "generator = lubachevsky_stillinger\n"
             "generation = 2\n"
             "particles = 100000\n"
             "density = 0.64\n"
             "cov = 0.3\n"
             "truncation = 3\n"
             "smallest_radius = 0.1\n"
             "growth_rate = 0.03\n"
             "fluid_growth_rate = 0.3\n"
             "late_growth_rate = 0\n"
             "late_pressure = 30\n"
             "pressure_limit = 1e+08\n"
             "side = 0.01\n"
             "boundary = periodic\n"
             "seed = 1\n"
             "packings = 5\n",
      .coordination = 6.2,
      .micro_poissons_ratio = 0.3,
      .particles = 100000,
      .packings = 5,
      .smallest_ratio = 0.1,
      .largest_ratio = 0.9,
      .modulus = {{0.1226163659056704, 0.9049455969426203, -0.22066072260384303, 0.08681512609126539}},
      .poissons_ratio = {{0.4055725605282729, -0.4211403982546561, 0.17160126353309785,
                          -0.07394325583270889}},
      .modulus_residual = 0.0002111495487234642,
      .poissons_residual = 0.00012061802148086677,
      .modulus_scatter = 0.0023131314885937006,
      .poissons_scatter = 0.00011317260456951735,
      .scatter_correlation = -0.46675766076314973,
  };
}

/// The same with nearly equal spheres, CoV 0.03, growth rate 0.02: close to jamming, and E_a nearer the paper's.
inline CalibrationChart nearly_equal_spheres() {
  return {
      .name = "Lubachevsky-Stillinger, density 0.64, CoV 0.03, growth 0.02, Z 6.2, periodic",
      .ecd = "generator = lubachevsky_stillinger\n"
             "generation = 2\n"
             "particles = 100000\n"
             "density = 0.64\n"
             "cov = 0.03\n"
             "truncation = 3\n"
             "smallest_radius = 0.1\n"
             "growth_rate = 0.02\n"
             "fluid_growth_rate = 0.3\n"
             "late_growth_rate = 0\n"
             "late_pressure = 30\n"
             "pressure_limit = 1e+08\n"
             "side = 0.01\n"
             "boundary = periodic\n"
             "seed = 1\n"
             "packings = 5\n",
      .coordination = 6.2,
      .micro_poissons_ratio = 0.3,
      .particles = 100000,
      .packings = 5,
      .smallest_ratio = 0.1,
      .largest_ratio = 0.9,
      .modulus = {{0.04132689030661081, 0.956269745454627, -0.4846056927664671, 0.3507751464205781,
                   -0.11165081218744546}},
      .poissons_ratio = {{0.46383820969340217, -0.6369286420435238, 0.5745427074960037, -0.4862978187808878,
                          0.1679580860186917}},
      .modulus_residual = 4.5295300612942985e-05,
      .poissons_residual = 7.369678771628148e-05,
      .modulus_scatter = 0.0006234534497744109,
      .poissons_scatter = 0.00011258175852478591,
      .scatter_correlation = -0.8707096730865806,
  };
}

} // namespace cdem::homogenize::standard_charts
