#include <cdem/particles/inertia.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <vector>

using namespace cdem;
using core::InvalidInput;
using particles::Inertia;
using particles::solid_spheres;

namespace {

const double not_a_number = std::numeric_limits<double>::quiet_NaN();
const double inf = std::numeric_limits<double>::infinity();

particles::ParticleSet two_spheres() {
  particles::ParticleSet spheres;
  spheres.resize(2);
  spheres.radius = {1, 2};
  spheres.phase = {0, 1};
  return spheres;
}

template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "nothing thrown";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("mass and moment are the integrals of density and of density times squared distance from an axis") {
  const auto spheres = two_spheres();
  const Inertia inertia = solid_spheres(spheres, std::vector<double>{3, 5});
  REQUIRE(inertia.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    // Simpson's rule over thin discs of radius^2 = R^2 - z^2: exact for these polynomials of degree 2 and 4,
    // the latter on many intervals
    const double radius = spheres.radius[i], density = i == 0 ? 3 : 5;
    constexpr int intervals = 2000;
    const double step = 2 * radius / intervals;
    double mass = 0, moment = 0;
    for (int k = 0; k <= intervals; ++k) {
      const double z = -radius + k * step, disc = radius * radius - z * z;
      const double weight = (k == 0 || k == intervals ? 1 : k % 2 == 1 ? 4 : 2) * step / 3;
      mass += weight * density * std::numbers::pi * disc;
      moment += weight * density * std::numbers::pi * disc * disc / 2;
    }
    CHECK(inertia.mass[i] == doctest::Approx(mass).epsilon(1e-11));
    CHECK(inertia.moment[i] == doctest::Approx(moment).epsilon(1e-11));
  }
}

TEST_CASE("density scaling multiplies masses and moments alike") {
  Inertia inertia{{1, 2}, {3, 4}};
  inertia.scale(10);
  CHECK(inertia.mass == std::vector<double>{10, 20});
  CHECK(inertia.moment == std::vector<double>{30, 40});
  for (const double bad : {0.0, -1.0, not_a_number, inf}) {
    CHECK(contains(message_of([&] { inertia.scale(bad); }),
                   "density scaling factor = " + core::to_text(bad) + " is not accepted"));
    CHECK(inertia.mass == std::vector<double>{10, 20});
  }
}

TEST_CASE("bad densities, phases and particles are refused") {
  auto spheres = two_spheres();
  const auto message = [&](std::vector<double> density) {
    return message_of([&] { solid_spheres(spheres, density); });
  };
  for (const double bad : {0.0, -1.0, not_a_number, inf})
    CHECK(contains(message({1, bad}), "density of phase 1 = " + core::to_text(bad) + " is not accepted"));
  CHECK(
      contains(message({1}), "phase of particle 1 = 1 is not accepted: a phase with a density is expected"));
  CHECK(contains(message({}), "phase of particle 0 = 0"));
  CHECK(message({1, 2, 3}) == "nothing thrown"); // a phase without particles is no fault
  spheres.radius[1] = 0;
  CHECK(contains(message({1, 1}), "radius of particle 1 = 0"));
  spheres = {};
  CHECK(contains(message({1, 1}), "number of particles = 0"));
}

TEST_CASE("validate names the first bad value") {
  const Inertia good{{1, 2}, {3, 4}};
  CHECK_NOTHROW(good.validate(2));
  CHECK(contains(message_of([&] { good.validate(3); }), "number of masses = 2 is not accepted"));
  CHECK(contains(message_of([] { Inertia{{1, 2}, {3}}.validate(2); }), "number of moments of inertia = 1"));
  for (const double bad : {0.0, -1.0, not_a_number, inf}) {
    CHECK(contains(message_of([&] {
                     Inertia{{1, bad}, {3, 4}}.validate(2);
                   }),
                   "mass of particle 1 = " + core::to_text(bad)));
    CHECK(contains(message_of([&] {
                     Inertia{{1, 2}, {bad, 4}}.validate(2);
                   }),
                   "moment of inertia of particle 0 = " + core::to_text(bad)));
  }
}
