#pragma once

/// @file
/// The paper's tension test without time: moduli of a body in equilibrium.

#include <cdem/core/parallel.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/homogenize/tension_gauge.hpp>
#include <cdem/integrate/integrator.hpp>
#include <cdem/simulation/specimen.hpp>

#include <vector>

namespace cdem::homogenize {

/// What a static tension test gives.
struct StaticTensionReading {
  FaceReading faces;        ///< forces and motions of the faces
  InteriorReading interior; ///< slope of the displacement within
  double work = 0;          ///< of the pull, J: half of the sum of reaction times way

  /// E_M from the slope within, Pa: the faces' stress over the interior's strain.
  double interior_youngs_modulus() const { return interior.youngs_modulus(faces.stress); }
};

/// Pulls a body along one axis under boundary::SymmetricTension and reads it in equilibrium.    [L17] section 2.3
///
/// What the explicit test tends to, without its vibrations.
struct StaticTension {
  Axis axis = Axis::x;
  double strain = 1e-3; ///< nominal: way of the loaded face over the side of the box; below 0 compresses
  TensionGauge::Parameters gauge = {}; ///< the interior

  /// @param solver  any with `solve(problem, motion, pool, monitor)`, such as integrate::StaticMultigrid
  /// @param forces  of the body: bond::LinearForces or others
  /// @throws core::InvalidInput for a strain that is zero or not finite, and as SymmetricTension, TensionGauge and the
  ///         solver do
  /// @complexity one static solution
  template <class Solver, integrate::InternalForces Forces>
  StaticTensionReading measure(const Solver& solver, const Forces& forces, const simulation::Specimen& body,
                               core::ThreadPool& pool, const core::Monitor& monitor = {}) const {
    core::expect(std::isfinite(strain) && strain != 0, "strain of the tension test", strain,
                 "a finite number other than 0 is expected");
    const double way = strain * body.box.size()[core::index_of(axis)];
    const auto setup =
        boundary::SymmetricTension{axis, way, body.gap()}.apply(body.particles, body.network, body.box);
    const TensionGauge reader(body.particles, body.network, setup, gauge);
    const particles::Inertia inertia =
        particles::solid_spheres(body.particles, std::vector{1.0}); // unused at rest
    const integrate::Problem<Forces> problem{forces, inertia, setup.constraints};
    particles::Motion motion = particles::Motion::at_rest(body.particles.size());
    solver.solve(problem, motion, pool, monitor);
    const std::vector<double> reaction = integrate::static_reactions(problem, motion, pool);
    StaticTensionReading reading{reader.faces(motion.displacement, reaction),
                                 reader.interior(motion.displacement)};
    for (std::size_t c = 0; c < reaction.size(); ++c)
      reading.work += 0.5 * reaction[c] * setup.constraints.list()[c].rate;
    return reading;
  }
};

} // namespace cdem::homogenize
