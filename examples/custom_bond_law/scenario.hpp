#pragma once

// A law of one's own in every integrator: one bond torn apart, and a cube of such bonds pulled until some soften.

#include <cdem/bond/bond_forces.hpp>
#include <cdem/boundary/symmetric_tension.hpp>
#include <cdem/homogenize/tension_gauge.hpp>
#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/rayleigh_quotient.hpp>
#include <cdem/integrate/static_multigrid.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/simulation/specimen.hpp>

#include <string>
#include <utility>
#include <vector>

#include "common/packings.hpp"
#include "softening_beam.hpp"

namespace cdem::examples::custom_bond_law {

enum class Method : std::uint8_t { verlet, relaxation, statics };

struct Params {
  packing::LubachevskyStillinger::Parameters packing = {.density = 0.6, .cov = 0.1};
  PackingSource source = {};
  double coordination = 6.2; ///< Z
  SofteningBeam::Parameters law = {
      .beam = {.materials = {{.youngs_modulus = 70e9, .radius_ratio = 0.6}}}, .onset = 1e-3, .rupture = 1e-2};
  double density = 2500; ///< kg/m^3
  double strain = 1e-3;  ///< of the cube
  std::vector<Method> methods = {Method::statics, Method::relaxation, Method::verlet};
  int load_steps = 20;         ///< of static and relaxation
  std::uint64_t steps = 20000; ///< of velocity Verlet
  int threads = 0;

  /// @throws core::InvalidInput for what no stage would accept, before anything is computed or written
  void validate() const {
    packing::LubachevskyStillinger{packing};
    SofteningBeam{law};
    core::expect_positive(coordination, "coordination");
    core::expect_positive(strain, "strain");
    core::expect(steps >= 1, "steps", steps, "at least 1 is expected");
  }
};

/// One bond of two spheres of radius 1 mm, stretched until nothing is left.
struct Tearing {
  std::vector<double> strain, load; ///< [steps] load in N
  double peak_load = 0;             ///< N
  double dissipated = 0;            ///< J
  double exact_peak_load = 0;       ///< K_n L onset
  double exact_dissipated = 0;      ///< K_n L^2 onset rupture / 2, the area under the triangle
};

/// What the cube came to by one method.
struct Pulled {
  Method method{};
  double youngs_modulus = 0; ///< Pa, stress over strain
  double dissipated = 0;     ///< J, by the bonds
  double elastic = 0;        ///< J
  std::size_t softened = 0;  ///< bonds past their onset
  std::vector<double> left;  ///< [bonds] of the stiffness
  std::vector<Vec3> forces;  ///< [bonds] N
  particles::Motion motion;
};

struct Result {
  simulation::Specimen specimen;
  Tearing tearing;
  double elastic_modulus = 0; ///< Pa, of the cube before anything softens
  std::vector<Pulled> pulled;
};

// [bond]
/// Tears one bond by advance(), what an explicit integrator does at every step.
inline Tearing tear(const SofteningBeam::Parameters& parameters, core::ThreadPool& pool) {
  particles::ParticleSet particles;
  particles.resize(2);
  particles.radius.assign(2, 1e-3);
  particles.position[1] = Vec3(2e-3, 0, 0);
  network::BondNetwork network;
  network.particle_count = 2;
  network.first.push_back(0);
  network.second.push_back(1);
  network.branch.push_back(particles.position[1]);

  bond::BondForces<SofteningBeam> forces(SofteningBeam(parameters), particles, network);
  Tearing tearing;
  const double length = forces.length(0), stiffness = forces.prepared(0).k.normal;
  particles::SpatialField<> displacement(2), force(2);
  constexpr int steps = 2000;
  for (int step = 0; step <= steps; ++step) {
    const double strain = 1.1 * parameters.rupture * step / steps;
    displacement[1].linear().x() = strain * length;
    forces.advance(displacement, force, pool);
    tearing.strain.push_back(strain);
    tearing.load.push_back(force[0].linear().x());
    tearing.peak_load = std::max(tearing.peak_load, force[0].linear().x());
  }
  tearing.dissipated = forces.dissipated_energy();
  tearing.exact_peak_load = stiffness * length * parameters.onset;
  tearing.exact_dissipated = 0.5 * stiffness * length * length * parameters.onset * parameters.rupture;
  return tearing;
}
// [bond]

namespace detail {

/// The cube pulled by one method. Only the call of the integrator differs.
inline Pulled pull(const SofteningBeam& law, Method method, const Params& params,
                   const simulation::Specimen& specimen, core::ThreadPool& pool,
                   const core::Monitor& monitor) {
  // [forces]
  bond::BondForces<SofteningBeam> forces(law, specimen.particles, specimen.network);
  // [forces]
  const auto inertia = particles::solid_spheres(specimen.particles, std::vector{params.density});
  const double way = params.strain * specimen.box.size().x();
  const auto setup_at = [&](double rate) {
    return boundary::SymmetricTension{Axis::x, rate, specimen.gap()}.apply(specimen.particles,
                                                                           specimen.network, specimen.box);
  };
  Pulled pulled;
  pulled.method = method;
  pulled.motion = particles::Motion::at_rest(specimen.particles.size());
  auto setup = setup_at(way); // statics: displacement at unit time
  using Problem = integrate::Problem<bond::BondForces<SofteningBeam>>;
  if (method == Method::verlet) {
    const double time_step = 0.5 * integrate::critical_time_step(forces, inertia).time_step;
    setup = setup_at(way / (time_step * static_cast<double>(params.steps)));
    // [verlet]
    const Problem problem{forces, inertia, setup.constraints};
    const double omega = integrate::first_axial_frequency(problem, specimen.particles, specimen.box.lower.x(),
                                                          specimen.box.upper.x(), Axis::x, pool);
    const integrate::VelocityVerlet verlet(
        {.time_step = time_step, .damping = integrate::Damping::of_mode(0.5, omega)});
    verlet.run(problem, pulled.motion, params.steps, pool, integrate::NoObserver{}, monitor);
    // [verlet]
  } else { // in steps, so that the energy lost on the way is seen
    for (int step = 1; step <= params.load_steps; ++step) {
      setup = setup_at(way * step / params.load_steps);
      // [statics]
      const Problem problem{forces, inertia, setup.constraints};
      if (method == Method::statics)
        integrate::StaticMultigrid({.relative_residual = 1e-7}).solve(problem, pulled.motion, pool, monitor);
      else
        integrate::DynamicRelaxation({.relative_residual = 1e-7})
            .solve(problem, pulled.motion, pool, monitor);
      // [statics]
    }
  }
  const Problem problem{forces, inertia, setup.constraints};
  const homogenize::TensionGauge gauge(specimen.particles, specimen.network, setup);
  pulled.youngs_modulus =
      gauge.faces(pulled.motion.displacement, integrate::static_reactions(problem, pulled.motion, pool))
          .youngs_modulus();
  pulled.elastic = forces.elastic_energy(pulled.motion.displacement, pool);
  pulled.dissipated = forces.dissipated_energy();
  for (const auto& state : forces.states()) {
    pulled.left.push_back(law.left(state.worst));
    if (pulled.left.back() < 1)
      ++pulled.softened;
  }
  forces.bond_forces(pulled.motion.displacement, pulled.forces, pool);
  return pulled;
}

} // namespace detail

/// Tears a bond, packs and pulls the cube by each method; every stage reports to the monitor.
inline Result run(const Params& params, const core::Monitor& monitor = {}) {
  params.validate();
  core::ThreadPool pool(params.threads);
  const auto accept_all = [](const packing::LubachevskyStillinger::Report&) {
  }; // a looser packing serves as well
  const auto packing = obtain_packing<packing::LubachevskyStillinger>(params.packing, params.source,
                                                                      accept_all, monitor, &pool)
                           .packing;
  Result result{simulation::make_specimen(packing.particles, packing.box, params.coordination, pool),
                tear(params.law, pool),
                0,
                {}};
  Params gently = params;
  gently.strain = 1e-6 * params.law.onset;
  gently.load_steps = 1;
  result.elastic_modulus =
      detail::pull(SofteningBeam(params.law), Method::statics, gently, result.specimen, pool, monitor)
          .youngs_modulus;
  for (const Method method : params.methods)
    result.pulled.push_back(
        detail::pull(SofteningBeam(params.law), method, params, result.specimen, pool, monitor));
  return result;
}

} // namespace cdem::examples::custom_bond_law
