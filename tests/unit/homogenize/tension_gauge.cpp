#include <cdem/homogenize/tension_gauge.hpp>

#include <doctest/doctest.h>

#include "integration/bodies.hpp"

using namespace cdem;

TEST_CASE("even strain is read exactly by faces and interior, along every axis") {
  const auto body = bodies::shaken_cube(6, 1e-3, 6.2, 1);
  constexpr double axial = 3e-4, first = -1e-4, second = -0.5e-4;
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    const auto setup =
        boundary::SymmetricTension{axis, 1e-5, body.gap()}.apply(body.particles, body.network, body.box);
    particles::SpatialField<> u(body.particles.size());
    const int k = core::index_of(axis);
    Vec3 strain;
    strain[k] = axial;
    strain[(k + 1) % 3] = first;
    strain[(k + 2) % 3] = second;
    for (std::size_t i = 0; i < u.size(); ++i)
      u[i].linear() = strain.cwiseProduct(body.particles.position[i]) + Vec3(1e-6, 2e-6, 3e-6);
    const homogenize::TensionGauge gauge(body.particles, body.network, setup, {.margin = 0.2});
    const auto interior = gauge.interior(u);
    CHECK(interior.axial_strain == doctest::Approx(axial).epsilon(1e-10));
    CHECK(interior.transverse_strain == doctest::Approx(0.5 * (first + second)).epsilon(1e-10));
    CHECK(interior.poissons_ratio() == doctest::Approx(0.25).epsilon(1e-10));

    // unit forces on all prescribed degrees of freedom count the particles of the two faces
    const std::vector<double> reaction(setup.constraints.size(), 1.0);
    const auto faces = gauge.faces(u, reaction);
    CHECK(faces.axial_strain == doctest::Approx(axial).epsilon(1e-10));
    CHECK(faces.transverse_strain == doctest::Approx(0.5 * (first + second)).epsilon(1e-10));
    CHECK(faces.nominal_strain ==
          doctest::Approx(axial * setup.faces.gauge_length(axis) / 6e-3).epsilon(1e-10));
    CHECK(faces.force_fixed == -static_cast<double>(setup.faces.lower(axis).particles.size()));
    CHECK(faces.force_loaded == static_cast<double>(setup.faces.upper(axis).particles.size()));
    CHECK(faces.stress == doctest::Approx(faces.force_fixed / 36e-6).epsilon(1e-12));
  }
}

TEST_CASE("an interior that is empty or a margin that is not a part of the side is refused") {
  const auto body = bodies::cubic_lattice(4, 1e-3);
  const auto setup =
      boundary::SymmetricTension{Axis::x, 1e-5, 1e-9}.apply(body.particles, body.network, body.box);
  const auto gauge = [&](double margin) {
    return homogenize::TensionGauge(body.particles, body.network, setup, {.margin = margin});
  };
  CHECK_THROWS_WITH_AS(gauge(-0.1), doctest::Contains("margin of the interior = -0.1"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(gauge(0.5), doctest::Contains("margin of the interior = 0.5"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(gauge(0.45), doctest::Contains("number of particles in the interior"),
                       core::InvalidInput);
}
