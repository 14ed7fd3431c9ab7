// The four policies composed give what the stages give one by one.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/finite_rotation.hpp>
#include <cdem/bond/spring.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/simulation/simulation.hpp>
#include <cdem/stress/closure.hpp>
#include <cdem/stress/love_weber.hpp>

#include <doctest/doctest.h>

using namespace cdem;

namespace {

template <class Law>
using Cube = simulation::Simulation<packing::LubachevskyStillinger, Law, integrate::VelocityVerlet,
                                    stress::LoveWeber<>>;

stress::LoveWeber<> eight_specimens() {
  return stress::LoveWeber<>(stress::tessellation::Hexahedra(geometry::Box::cube(0.01, false), {2, 2, 2}));
}

} // namespace

TEST_CASE("a composed simulation runs from packing to stress, the same for any number of threads") {
  stress::StressField first;
  for (const int threads : {1, 3}) {
    Cube<bond::Beam<>> cube({.packing = {.particles = 600, .density = 0.6, .cov = 0.1, .seed = 4},
                             .law = {.materials = {{.youngs_modulus = 220.2e9, .radius_ratio = 0.722}}},
                             .density = {2200},
                             .integrator = {.time_step = 1e-9, .damping = {}},
                             .threads = threads},
                            eight_specimens());
    CHECK(cube.packing_report().reached());
    CHECK(cube.specimen().network.coordination() == doctest::Approx(6.2).epsilon(1e-3));
    const auto report = cube.run(200);
    CHECK(report.steps == 200);
    const stress::StressField field = cube.stress();

    // every stage by hand, from the same specimen
    const auto& s = cube.specimen();
    std::vector<Vec3> forces;
    cube.forces().bond_forces(cube.motion().displacement, forces, cube.pool());
    Mat3 sum = Mat3::Zero();
    for (std::size_t b = 0; b < forces.size(); ++b)
      sum += forces[b] * s.network.branch[b].transpose();
    CHECK((stress::moment_of_stress(field) - sum).norm() < 1e-12 * sum.norm());
    CHECK(std::abs(cube.energies().imbalance()) < 1e-2 * cube.energies().external_work);

    if (first.size() == 0)
      first = field;
    for (std::size_t c = 0; c < field.size(); ++c)
      CHECK((field.stress[c].array() == first.stress[c].array()).all());
  }
}

TEST_CASE("another law takes the place of the first with no other change") {
  Cube<bond::Spring<>> cube(
      {.packing = {.particles = 600, .density = 0.6, .cov = 0, .seed = 4},
       .law = {.materials = {{.youngs_modulus = 220.2e9, .radius_ratio = 0.722}}, .tangential_ratio = 0.3},
       .density = {2200},
       .integrator = {.time_step = 1e-9, .damping = {}}},
      eight_specimens());
  cube.run(50);
  CHECK(cube.energies().elastic > 0);
  CHECK(cube.reactions().size() == cube.setup().constraints.size());
}

TEST_CASE("a law with finite rotations moves as the linear one while rotations are small") {
  const auto pulled = [](auto law) {
    Cube<decltype(law)> cube({.packing = {.particles = 600, .density = 0.6, .cov = 0, .seed = 4},
                              .law = {.materials = {{.youngs_modulus = 220.2e9, .radius_ratio = 0.722}}},
                              .density = {2200},
                              .integrator = {.time_step = 1e-9, .damping = {}}},
                             eight_specimens());
    cube.run(200);
    const stress::StressField field = cube.stress();
    return std::pair{cube.energies(), stress::moment_of_stress(field)};
  };
  const bond::Beam<> beam({.materials = {{.youngs_modulus = 1, .radius_ratio = 1}}});
  const auto [energy, moment] = pulled(beam);
  const auto [finite_energy, finite_moment] = pulled(bond::FiniteRotation<bond::Beam<>>(beam));
  CHECK(finite_energy.elastic == doctest::Approx(energy.elastic).epsilon(1e-5));
  CHECK(finite_energy.kinetic == doctest::Approx(energy.kinetic).epsilon(1e-5));
  CHECK((finite_moment - moment).norm() < 1e-5 * moment.norm());
}

TEST_CASE("a bad parameter of any stage is named") {
  const auto with = [](double density, double radius_ratio, double time_step) {
    Cube<bond::Beam<>> cube(
        {.packing = {.particles = 600, .density = density, .cov = 0.1},
         .law = {.materials = {{.youngs_modulus = 220.2e9, .radius_ratio = radius_ratio}}},
         .density = {2200},
         .integrator = {.time_step = time_step, .damping = {}}},
        eight_specimens());
  };
  CHECK_THROWS_WITH_AS(with(1.2, 0.5, 1e-9), doctest::Contains("density"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(with(0.5, 1.5, 1e-9), doctest::Contains("r_mu of phase 0 = 1.5"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(with(0.5, 0.5, 0), doctest::Contains("time_step = 0"), core::InvalidInput);
}
