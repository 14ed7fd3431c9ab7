#pragma once

// Law and integrator chosen when the program runs, among combinations that were compiled: std::variant in place of
// virtual functions, so that the loop over the bonds knows its law.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/finite_rotation.hpp>
#include <cdem/bond/spring.hpp>
#include <cdem/homogenize/tension_gauge.hpp>
#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/simulation/simulation.hpp>
#include <cdem/stress/love_weber.hpp>

#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "common/packings.hpp"

namespace cdem::examples::runtime_choice {

/// A packing that is there already, for a Simulation that packs.
class Given {
public:
  struct Parameters {
    const packing::Packing<packing::LubachevskyStillinger::Report>* packing = nullptr;
  };
  using Report = packing::LubachevskyStillinger::Report;
  explicit Given(Parameters parameters) : parameters_(parameters) {}
  packing::Packing<Report> pack(const core::Monitor& = {}) const { return *parameters_.packing; }

private:
  Parameters parameters_;
};
static_assert(packing::PackingGenerator<Given>);

// [variants]
/// The laws and the integrators to choose from, by their parameters. One line each.
using AnyLaw = std::variant<std::type_identity<bond::Beam<>>, std::type_identity<bond::Spring<>>,
                            std::type_identity<bond::FiniteRotation<bond::Beam<>>>>;
using AnyIntegrator = std::variant<std::type_identity<integrate::DynamicRelaxation>,
                                   std::type_identity<integrate::VelocityVerlet>>;

inline AnyLaw law_named(const std::string& name) {
  if (name == "beam")
    return std::type_identity<bond::Beam<>>{};
  if (name == "spring")
    return std::type_identity<bond::Spring<>>{};
  core::expect(name == "rotating_beam", "law", name, "beam, spring or rotating_beam is expected");
  return std::type_identity<bond::FiniteRotation<bond::Beam<>>>{};
}
inline AnyIntegrator integrator_named(const std::string& name) {
  if (name == "relaxation")
    return std::type_identity<integrate::DynamicRelaxation>{};
  core::expect(name == "verlet", "method", name, "relaxation or verlet is expected");
  return std::type_identity<integrate::VelocityVerlet>{};
}
// [variants]

struct Params {
  packing::LubachevskyStillinger::Parameters packing = {.density = 0.6, .cov = 0.1};
  PackingSource source = {};
  std::string law = "beam";
  std::string method = "relaxation";
  double coordination = 6.2; ///< Z
  bond::Material material = {.youngs_modulus = 70e9, .radius_ratio = 0.6};
  double density = 2500;       ///< kg/m^3
  double strain = 1e-5;        ///< of the cube
  std::uint64_t steps = 20000; ///< of velocity Verlet
  int threads = 0;

  /// @throws core::InvalidInput for what no stage would accept, before anything is computed or written
  void validate() const {
    packing::LubachevskyStillinger{packing};
    law_named(law);
    integrator_named(method);
    core::expect_positive(strain, "strain");
    core::expect(steps >= 1, "steps", steps, "at least 1 is expected");
  }
};

struct Result {
  double youngs_modulus = 0; ///< Pa
  double poissons_ratio = 0;
  double elastic_energy = 0; ///< J
};

namespace detail {

/// One combination, all of its types known.
template <class Law, class IntegratorType>
Result pull(const Params& params, const packing::Packing<packing::LubachevskyStillinger::Report>& packing) {
  using Cube = simulation::Simulation<Given, Law, IntegratorType, stress::LoveWeber<>>;
  constexpr bool in_time = integrate::AdvancesMotion<IntegratorType>;
  const geometry::Box box = packing.box.without_periodicity();
  const stress::LoveWeber<> stress(stress::tessellation::Hexahedra(box, {1, 1, 1}));
  const double way = params.strain * box.size().x();
  typename Cube::Parameters parameters{.packing = {&packing},
                                       .coordination = params.coordination,
                                       .law = {.materials = {params.material}},
                                       .density = {params.density},
                                       .integrator = {},
                                       .boundary = {.velocity = way},
                                       .threads = params.threads};
  if constexpr (in_time) { // the step follows from the body, so one is made to ask it
    parameters.integrator.time_step = 1;
    Cube cube(parameters, stress);
    const double time_step = 0.5 * integrate::critical_time_step(cube.forces(), cube.inertia()).time_step;
    parameters.integrator = {.time_step = time_step,
                             .damping = {.alpha = 0.1 / (time_step * std::cbrt(packing.particles.size()))}};
    parameters.boundary.velocity = way / (time_step * static_cast<double>(params.steps));
  }
  Cube cube(parameters, stress);
  if constexpr (in_time)
    cube.run(params.steps);
  else
    cube.solve();
  const homogenize::TensionGauge gauge(cube.specimen().particles, cube.specimen().network, cube.setup());
  const auto reading = gauge.faces(cube.motion().displacement, cube.reactions());
  return {reading.youngs_modulus(), reading.poissons_ratio(), cube.energies().elastic};
}

} // namespace detail

// [visit]
/// Packs, and pulls with the law and the integrator asked for.
inline Result run(const Params& params, const core::Monitor& monitor = {}) {
  params.validate();
  const auto accept_all = [](const packing::LubachevskyStillinger::Report&) {};
  core::ThreadPool pool(params.threads);
  const auto packing = obtain_packing<packing::LubachevskyStillinger>(params.packing, params.source,
                                                                      accept_all, monitor, &pool)
                           .packing;
  return std::visit(
      [&]<class Law, class IntegratorType>(std::type_identity<Law>, std::type_identity<IntegratorType>) {
        return detail::pull<Law, IntegratorType>(params, packing);
      },
      law_named(params.law), integrator_named(params.method));
}
// [visit]

} // namespace cdem::examples::runtime_choice
