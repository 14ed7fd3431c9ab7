// Overlaps, contacts and rattlers of arrangements that are known by heart.

#include <cdem/packing/detail/contact_survey.hpp>

#include <doctest/doctest.h>

namespace {

using namespace cdem;
using packing::detail::survey_contacts;

/// 4 n^3 touching spheres of radius sqrt(2)/(4 n) in the unit cube: face-centred cubic, the densest packing.
particles::ParticleSet face_centred(int n) {
  particles::ParticleSet spheres;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c)
        for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.5, 0, 0.5), Vec3(0, 0.5, 0.5)})
          spheres.position.push_back((Vec3(a, b, c) + corner) / n);
  spheres.radius.assign(spheres.position.size(), std::sqrt(2.0) / (4 * n));
  spheres.phase.assign(spheres.position.size(), 0);
  return spheres;
}

/// n^3 touching spheres on a simple cubic lattice between the walls of the unit cube.
particles::ParticleSet simple_cubic(int n) {
  particles::ParticleSet spheres;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c)
        spheres.position.push_back((Vec3(a, b, c) + Vec3::Constant(0.5)) / n);
  spheres.radius.assign(spheres.position.size(), 0.5 / n);
  spheres.phase.assign(spheres.position.size(), 0);
  return spheres;
}

} // namespace

TEST_CASE("face-centred cubic spheres have twelve contacts") {
  const auto survey = survey_contacts(face_centred(4), geometry::Box::cube(1, true), 1e-9);
  CHECK(survey.contact_number == 12);
  CHECK(survey.rattlers == 0);
  CHECK(survey.largest_overlap < 1e-14);
}

TEST_CASE("simple cubic spheres between walls have six contacts, walls included") {
  const auto survey = survey_contacts(simple_cubic(4), geometry::Box::cube(1, false), 1e-9);
  CHECK(survey.contact_number == 6);
  CHECK(survey.rattlers == 0);
}

TEST_CASE("a hole frees no neighbour of a stiff lattice, and a small sphere in it rattles") {
  auto spheres = face_centred(4);
  spheres.radius[17] *= 0.8;
  const auto survey = survey_contacts(spheres, geometry::Box::cube(1, true), 1e-9);
  CHECK(survey.rattlers == 1);
  CHECK(survey.contact_number == doctest::Approx((255.0 * 12 - 12) / 255));
}

TEST_CASE("rattlers are peeled off until none is left") {
  auto spheres = simple_cubic(2); // each sphere: three neighbours and three walls
  const auto box = geometry::Box::cube(1, false);
  CHECK(survey_contacts(spheres, box, 1e-9).rattlers == 0);
  spheres.radius[0] *= 0.9; // it rattles; its neighbours keep five contacts
  auto survey = survey_contacts(spheres, box, 1e-9);
  CHECK(survey.rattlers == 1);
  CHECK(survey.contact_number == doctest::Approx((3 * 5 + 4 * 6) / 7.0));
  for (const std::size_t i :
       {1U, 2U, 4U}) // those neighbours rattle too; three others keep their walls and the last
    spheres.radius[i] *= 0.9;
  survey = survey_contacts(spheres, box, 1e-9);
  CHECK(survey.rattlers == 4);
  CHECK(survey.contact_number == doctest::Approx((3 * 4 + 6) / 4.0));
  spheres.radius[7] *= 0.9; // with the last one gone three walls do not hold them
  survey = survey_contacts(spheres, box, 1e-9);
  CHECK(survey.rattlers == 8);
  CHECK(survey.contact_number == 0);
}

TEST_CASE("an overlap is found, of spheres across a face and of a sphere with a wall") {
  particles::ParticleSet spheres;
  spheres.resize(3);
  spheres.position = {Vec3(0.05, 0.5, 0.5), Vec3(0.9, 0.5, 0.5), Vec3(0.5, 0.5, 0.5)};
  spheres.radius = {0.05, 0.12, 0.01};
  // Distance 0.15 through the face, radii 0.17.
  CHECK(survey_contacts(spheres, geometry::Box::cube(1, true), 1e-9).largest_overlap ==
        doctest::Approx(0.02 / 0.17).epsilon(1e-12));
  // The second sphere's centre is 0.1 from the wall, its radius 0.12.
  CHECK(survey_contacts(spheres, geometry::Box::cube(1, false), 1e-9).largest_overlap ==
        doctest::Approx(0.02 / 0.12).epsilon(1e-12));
}
