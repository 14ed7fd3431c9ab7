#pragma once

/// @file
/// E_a and nu of a packing at any r_mu, and the chart of a kind of packing from its generator.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/homogenize/calibration_fit.hpp>
#include <cdem/homogenize/periodic_stiffness.hpp>
#include <cdem/packing/packing_generator.hpp>
#include <cdem/simulation/specimen.hpp>

#include <string>
#include <utility>
#include <vector>

namespace cdem::homogenize {

/// What a chart is measured with.
struct CalibrationStudy {
  std::vector<double> radius_ratios{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}; ///< r_mu, [L17] figure 7
  double coordination = 6.2;                                                      ///< Z
  double micro_poissons_ratio = 0.3;                                              ///< nu_mu
};

/// The chart of the packings of a generator: each packed, bonded with its periodic images, and measured at each r_mu by
/// periodic_stiffness() with E_mu = 1 Pa; E and nu are those of the closest isotropic body.
///
/// Periodic bodies have no faces: no gauge length, and no layer of particles with fewer bonds, enters the chart.
/// io::kept_chart() keeps it in a file.
/// @param packings  parameters of the generator, periodic, one a packing: of one kind, with different seeds
/// @param chart     name and ecd, the rest is filled in
/// @throws what the generator, the solver, periodic_stiffness() and fit_chart() throw
/// @complexity six static solutions for each packing and r_mu
template <packing::PackingGenerator Generator, SolvesStaticsOf<bond::LinearForces> Solver>
CalibrationFit measure_chart(const std::vector<typename Generator::Parameters>& packings,
                             const CalibrationStudy& study, CalibrationChart chart, const Solver& solver,
                             core::ThreadPool& pool, const core::Monitor& monitor = {}) {
  core::expect(!packings.empty(), "number of packings to calibrate with", packings.size(),
               "1 or more is expected");
  std::vector<CalibrationPoint> points;
  for (std::size_t p = 0; p < packings.size(); ++p) {
    Generator generator(packings[p]);
    const auto packing = generator.pack(monitor);
    const auto body =
        simulation::make_periodic_specimen(packing.particles, packing.box, study.coordination, pool);
    chart.particles = static_cast<std::uint32_t>(body.particles.size());
    for (const double r : study.radius_ratios) {
      const bond::LinearForces forces(bond::Beam<>({.materials = {{1, r, study.micro_poissons_ratio}}}),
                                      body.particles, body.network);
      const IsotropicModuli moduli =
          periodic_stiffness(forces, body.box, solver, pool, monitor).stiffness.isotropic_part();
      points.push_back({p, r, moduli.youngs_modulus(), moduli.poissons_ratio()});
    }
  }
  chart.coordination = study.coordination;
  chart.micro_poissons_ratio = study.micro_poissons_ratio;
  return fit_chart(points, std::move(chart));
}

} // namespace cdem::homogenize
