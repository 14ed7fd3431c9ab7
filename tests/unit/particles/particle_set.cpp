#include <cdem/particles/particle_set.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace {

using namespace cdem;
using core::InvalidInput;
using particles::ParticleSet;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

ParticleSet three() {
  ParticleSet particles;
  particles.resize(3);
  particles.position = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  particles.radius = {0.1, 0.2, 0.3};
  return particles;
}

} // namespace

TEST_CASE("volume and mean radius") {
  const ParticleSet particles = three();
  CHECK(particles.size() == 3);
  CHECK(particles.mean_radius() == doctest::Approx(0.2));
  CHECK(particles.solid_volume() == doctest::Approx(4 * std::numbers::pi / 3 * (0.001 + 0.008 + 0.027)));
  CHECK(ParticleSet{}.mean_radius() == 0);
  CHECK(ParticleSet{}.solid_volume() == 0);
}

TEST_CASE("new particles are of phase 0") {
  ParticleSet particles = three();
  particles.phase[1] = 7;
  particles.resize(5);
  CHECK(particles.phase == std::vector<PhaseIndex>{0, 7, 0, 0, 0});
  CHECK(particles.radius.size() == 5);
  CHECK(particles.position[4] == Vec3::Zero());
}

TEST_CASE("validate names the first bad particle") {
  ParticleSet particles = three();
  particles.validate();
  SUBCASE("empty") {
    CHECK_THROWS_WITH_AS(ParticleSet{}.validate(),
                         "number of particles = 0 is not accepted: at least 1 is expected", InvalidInput);
  }
  SUBCASE("lengths") {
    particles.radius.pop_back();
    CHECK_THROWS_WITH_AS(particles.validate(),
                         "number of radii = 2 is not accepted: one per position (3) is expected",
                         InvalidInput);
  }
  SUBCASE("phases") {
    particles.phase.push_back(0);
    CHECK_THROWS_WITH_AS(particles.validate(),
                         "number of phases = 4 is not accepted: one per position (3) is expected",
                         InvalidInput);
  }
  SUBCASE("position") {
    particles.position[1][2] = not_a_number;
    particles.position[2][0] = infinity;
    CHECK_THROWS_WITH_AS(particles.validate(),
                         "position z of particle 1 = nan is not accepted: a finite number is expected",
                         InvalidInput);
    particles.position[1][2] = 0;
    CHECK_THROWS_WITH_AS(particles.validate(),
                         "position x of particle 2 = inf is not accepted: a finite number is expected",
                         InvalidInput);
  }
  SUBCASE("radius") {
    for (const double bad : {0.0, -1.0, not_a_number, infinity}) {
      particles.radius[2] = bad;
      CHECK_THROWS_WITH_AS(particles.validate(),
                           ("radius of particle 2 = " + core::to_text(bad) +
                            " is not accepted: a finite number above 0 m is expected")
                               .c_str(),
                           InvalidInput);
    }
  }
}
