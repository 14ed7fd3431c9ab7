#include <cdem/boundary/symmetric_tension.hpp>

#include <doctest/doctest.h>

#include <limits>

#include "integration/bodies.hpp"

using namespace cdem;

TEST_CASE("the faces of a walled lattice are its outer layers") {
  const auto body = bodies::cubic_lattice(4, 1e-3);
  const auto faces = boundary::find_faces(body.particles, body.network, body.box, 1e-9);
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    CHECK(faces.lower(axis).particles.size() == 16);
    CHECK(faces.upper(axis).particles.size() == 16);
    for (const ParticleIndex i : faces.upper(axis).particles)
      CHECK(body.particles.position[i][core::index_of(axis)] == doctest::Approx(3.5e-3));
    CHECK(faces.gauge_length(axis) == doctest::Approx(3e-3));
  }
}

TEST_CASE("a particle belongs to a face if its sphere comes within the tolerance, and hangs on the body") {
  auto body = bodies::cubic_lattice(3, 1e-3);
  body.particles.position[0].x() += 2e-5; // now 2e-5 m off the lower x wall
  CHECK(boundary::find_faces(body.particles, body.network, body.box, 1e-5).lower(Axis::x).particles.size() ==
        8);
  CHECK(boundary::find_faces(body.particles, body.network, body.box, 3e-5).lower(Axis::x).particles.size() ==
        9);

  // a sphere that nothing holds, in the middle of the face
  body.particles.position.push_back({1e-5, 1.5e-3, 1.5e-3});
  body.particles.radius.push_back(1e-4);
  body.particles.phase.push_back(0);
  ++body.network.particle_count;
  CHECK(boundary::find_faces(body.particles, body.network, body.box, 3e-5).lower(Axis::x).particles.size() ==
        9);
}

TEST_CASE("symmetric tension holds three faces, moves one and leaves two free") {
  const auto body = bodies::cubic_lattice(3, 1e-3);
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    const auto setup =
        boundary::SymmetricTension{axis, 2e-5, 1e-9}.apply(body.particles, body.network, body.box);
    CHECK(setup.constraints.size() == 4 * 9);
    std::size_t moved = 0;
    for (const auto& c : setup.constraints.list()) {
      CHECK(c.dof < 3); // no rotation is held
      const double x = body.particles.position[c.particle][c.dof];
      if (c.rate != 0) {
        ++moved;
        CHECK(c.rate == 2e-5);
        CHECK(int{c.dof} == core::index_of(axis));
        CHECK(x == doctest::Approx(2.5e-3));
      } else {
        CHECK(x == doctest::Approx(0.5e-3));
      }
    }
    CHECK(moved == 9);
  }
}

TEST_CASE("what cannot be pulled is refused by name") {
  const auto body = bodies::cubic_lattice(3, 1e-3);
  const auto pull = [&](double velocity, double tolerance) {
    return boundary::SymmetricTension{Axis::x, velocity, tolerance}.apply(body.particles, body.network,
                                                                          body.box);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(pull(0, 0), doctest::Contains("velocity of the loaded face = 0"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(pull(nan, 0), doctest::Contains("velocity of the loaded face = nan"),
                       core::InvalidInput);
  CHECK_THROWS_WITH_AS(pull(1e-5, -1), doctest::Contains("tolerance of the faces = -1"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(pull(1e-5, nan), doctest::Contains("tolerance of the faces"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(pull(1e-5, 1), doctest::Contains("distance of the two faces along x"),
                       core::InvalidInput);
  auto far = body;
  far.box.lower.x() -= 1e-3; // no sphere comes near this wall
  CHECK_THROWS_WITH_AS(boundary::find_faces(far.particles, far.network, far.box, 1e-9),
                       doctest::Contains("lower x face"), core::InvalidInput);
  auto other = body.network;
  ++other.particle_count;
  CHECK_THROWS_WITH_AS(boundary::find_faces(body.particles, other, body.box, 0),
                       doctest::Contains("number of particles of the network"), core::InvalidInput);
}

TEST_CASE("a particle that reaches both faces of the axis is refused") {
  // one big sphere from wall to wall among the layers of a lattice
  auto body = bodies::cubic_lattice(3, 1e-3);
  body.particles.radius[13] = 1.5e-3; // the middle one
  CHECK_THROWS_WITH_AS(
      (boundary::SymmetricTension{Axis::x, 1e-5, 1e-9}.apply(body.particles, body.network, body.box)),
      doctest::Contains("already prescribed"), core::InvalidInput);
}
