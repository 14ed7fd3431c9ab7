// The law of examples/custom_bond_law: check_law() and the physics of one bond against its closed form.

#include <cdem/bond/check_law.hpp>

#include <doctest/doctest.h>

#include "custom_bond_law/softening_beam.hpp"
#include "unit/bond/body.hpp"

using namespace cdem;

namespace {

SofteningBeam::Parameters parameters() {
  return {.beam = {.materials = {{.youngs_modulus = 70e9, .radius_ratio = 0.6},
                                 {.youngs_modulus = 3e9, .radius_ratio = 0.4}}},
          .onset = 1e-3,
          .rupture = 1e-2};
}

/// Largest force on one bond of length 2 mm that is deformed along a straight path, and what it loses.
struct Torn {
  double peak = 0, lost = 0;
  bond::ChannelStiffness stiffness;
};
Torn tear(const Vec3& way) {
  const body::Body pair = body::row(2, Vec3(1, 2, 2) / 3, 2e-3, 1e-3);
  bond::BondForces<SofteningBeam> forces(SofteningBeam(parameters()), pair.particles, pair.network);
  core::ThreadPool pool;
  body::SpatialField displacement(2), force(2);
  Torn torn{0, 0, forces.prepared(0).k};
  constexpr int steps = 4000;
  for (int step = 0; step <= steps; ++step) {
    displacement[1].linear() = way * step / steps;
    forces.advance(displacement, force, pool);
    torn.peak = std::max(torn.peak, force[0].linear().norm());
  }
  CHECK(forces.elastic_energy(displacement, pool) == 0);
  torn.lost = forces.dissipated_energy();
  return torn;
}

} // namespace

TEST_CASE("the law of the example passes check_law() before, in and after softening") {
  // [check]
  for (const double strain : {1e-4, 3e-3, 3e-2}) {
    const bond::LawReport report =
        bond::check_law(SofteningBeam(parameters()), {.strain = strain, .angle = strain, .phases = {0, 1}});
    CHECK_MESSAGE(report.passed(), report.to_string());
  }
  // [check]
}

TEST_CASE("one bond bears K_n L onset and loses the area of the triangle when it is torn") {
  const auto [onset, rupture] = std::pair{parameters().onset, parameters().rupture};
  const double length = 2e-3;
  const Vec3 n = Vec3(1, 2, 2) / 3, across = Vec3(2, 1, -2) / 3;
  { // in tension
    const Torn torn = tear(1.05 * rupture * length * n);
    CHECK(torn.peak == doctest::Approx(torn.stiffness.normal * length * onset).epsilon(1e-3));
    const double area = 0.5 * torn.stiffness.normal * length * length * onset * rupture;
    CHECK(torn.lost == doctest::Approx(area).epsilon(1e-5));
  }
  { // in shear: K_t s^2 takes the place of K_n s^2, so that the energy lost is the same
    const double factor = std::sqrt(12 * 0.25) * 0.6 * 1e-3 / length; // sqrt(K_t/K_n) of a beam: sqrt(3) a/L
    const Torn torn = tear(1.05 * rupture * length / factor * across);
    CHECK(torn.peak == doctest::Approx(torn.stiffness.normal * length * onset * factor).epsilon(1e-3));
    const double area = 0.5 * torn.stiffness.normal * length * length * onset * rupture;
    CHECK(torn.lost == doctest::Approx(area).epsilon(1e-5));
  }
}

TEST_CASE("a parameter of the law that is not accepted is named") {
  auto bad = parameters();
  bad.onset = 0;
  CHECK_THROWS_WITH_AS(SofteningBeam{bad}, doctest::Contains("onset of softening = 0"), core::InvalidInput);
  bad = parameters();
  bad.rupture = bad.onset;
  CHECK_THROWS_WITH_AS(SofteningBeam{bad}, doctest::Contains("rupture = 0.001"), core::InvalidInput);
}
