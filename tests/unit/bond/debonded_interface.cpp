#include <cdem/bond/debonded_interface.hpp>
#include <cdem/bond/forces_of.hpp>
#include <cdem/bond/unilateral_interface.hpp>

#include <doctest/doctest.h>

#include <limits>

#include "body.hpp"
#include "laws.hpp"

namespace {

using namespace cdem;
using body::contains;
using bond::DebondedInterface;
using bond::PhasePairs;
using bond::Response;
using bond::UnilateralInterface;

const bond::Beam<> beam({.materials = {{1, 0.6}, {30, 0.4}, {5, 0.5}}});

bond::BondGeometry between(PhaseIndex first, PhaseIndex second) {
  return {.direction = Vec3(2, -1, 2) / 3,
          .length = 2,
          .radius_first = 1.1,
          .radius_second = 0.9,
          .phase_first = first,
          .phase_second = second};
}

const bond::Deformation<> pulled{0.1, {0.2, -0.3}, 0.4, {0.15, 0.25}},
    pushed{-0.1, {0.2, -0.3}, 0.4, {0.15, 0.25}};

/// Load, energy and tangent of a law.
struct Answer {
  bond::Vector6 load;
  double energy;
  bond::Matrix6 tangent;
};
template <class Law>
Answer ask(const Law& law, const bond::BondGeometry& geometry, const bond::Deformation<>& d) {
  using Of = Response<Law>;
  const auto prepared = Of::prepare(law, geometry);
  return {bond::detail::vector_of(Of::load(law, prepared, d, {})), Of::energy(law, prepared, d, {}),
          Of::tangent(law, prepared, d, {}, geometry.length)};
}

} // namespace

TEST_CASE("C_Gamma scales bonds across phases, for each pair in both orders, and no others") {
  const DebondedInterface law(beam, {0.5, {{0, 2, 0.25}, {2, 1, 0}}});
  const double expected[3][3] = {{1, 0.5, 0.25}, {0.5, 1, 0}, {0.25, 0, 1}};
  for (PhaseIndex i = 0; i < 3; ++i)
    for (PhaseIndex j = 0; j < 3; ++j) {
      const bond::ChannelStiffness found = law.stiffness(between(i, j)),
                                   whole = beam.stiffness(between(i, j));
      CHECK(found.normal == expected[i][j] * whole.normal);
      CHECK(found.tangential == expected[i][j] * whole.tangential);
      CHECK(found.torsion == expected[i][j] * whole.torsion);
      CHECK(found.bending == expected[i][j] * whole.bending);
      CHECK(law.cohesion(between(i, j)) == expected[i][j]);
    }
  const DebondedInterface<bond::Beam<>> perfect({.law = beam});
  CHECK(perfect.stiffness(between(0, 1)).normal == beam.stiffness(between(0, 1)).normal);
  static_assert(std::same_as<bond::ForcesOf<DebondedInterface<bond::Beam<>>>, bond::LinearForces>);
  static_assert(bond::GivesBlockStiffness<DebondedInterface<laws::BlockBeam>>);
}

TEST_CASE("laws of any kind are scaled alike: load, energy, tangent") {
  const auto geometry = between(0, 1);
  const auto check = [&](const auto& law) {
    const Answer whole = ask(law, geometry, pulled),
                 part = ask(DebondedInterface(law, {0.3, {}}), geometry, pulled);
    CHECK((part.load - 0.3 * whole.load).norm() < 1e-12 * whole.load.norm());
    CHECK(part.energy == doctest::Approx(0.3 * whole.energy).epsilon(1e-12));
    CHECK((part.tangent - 0.3 * whole.tangent).norm() < 1e-12 * whole.tangent.norm());
  };
  check(beam);
  check(laws::BlockBeam{beam});
  check(laws::EnergyBeam{{beam}});
  check(laws::Stiffening{{beam}});
}

TEST_CASE("a contact across phases bears compression alone, without friction, and no energy is made of it") {
  const UnilateralInterface law(beam);
  const double stiffness = beam.stiffness(between(0, 1)).normal;
  const Answer open = ask(law, between(0, 1), pulled), closed = ask(law, between(0, 1), pushed);
  CHECK(open.load.norm() == 0);
  CHECK(open.energy == 0);
  CHECK(open.tangent.norm() == 0);
  CHECK(closed.load[0] == doctest::Approx(-0.1 * stiffness).epsilon(1e-14));
  CHECK(closed.load.tail<5>().norm() == 0);
  CHECK(closed.energy == doctest::Approx(0.005 * stiffness).epsilon(1e-14));
  CHECK(closed.tangent(0, 0) == stiffness);
  CHECK(closed.tangent.norm() == stiffness);
  for (const auto& d : {pulled, pushed}) { // within a phase it is the law itself
    const Answer inside = ask(law, between(1, 1), d), plain = ask(beam, between(1, 1), d);
    CHECK(inside.load == plain.load);
    CHECK(inside.energy == plain.energy);
    CHECK(inside.tangent == plain.tangent);
  }
  // the law's normal force where the law is not linear, and what C_Gamma leaves of it
  const laws::Stiffening stiffening{{beam}};
  const UnilateralInterface contact(stiffening);
  const UnilateralInterface weak(DebondedInterface(beam, {0.5, {}}));
  const Answer curved = ask(contact, between(0, 1), pushed),
               alone = ask(stiffening, between(0, 1), {-0.1, {}, 0, {}}),
               half = ask(weak, between(0, 1), pushed);
  CHECK(curved.load[0] == alone.load[0]);
  CHECK(curved.energy == alone.energy);
  CHECK(half.load[0] == doctest::Approx(-0.05 * stiffness).epsilon(1e-14));
}

TEST_CASE("two phases that are pressed together hold, pulled apart they part") {
  auto [particles, network] = body::row(4, Vec3::UnitX(), 2, 1);
  particles.phase[2] = particles.phase[3] = 1;
  const UnilateralInterface law(beam);
  const bond::BondForces forces(law, particles, network);
  core::ThreadPool pool;
  body::SpatialField motion(4), force;
  for (const double push : {-0.01, 0.01}) {
    motion[2][0] = motion[3][0] = push;
    forces.evaluate(motion, force, pool);
    const auto geometry = bond::geometry_of(1, particles, network);
    const double expected = push < 0 ? -push * beam.stiffness(geometry).normal : 0;
    CHECK(force[2][0] == doctest::Approx(expected).epsilon(1e-13));
    CHECK(force[1][0] == -force[2][0]);
  }
}

TEST_CASE("what is no cohesion is refused") {
  const auto message = [](PhasePairs cohesion) {
    return body::message_of([&] { DebondedInterface law(beam, cohesion); });
  };
  CHECK(contains(message({1.5}), "cohesion = 1.5 is not accepted: a number in [0, 1] is expected"));
  CHECK(contains(message({1, {{0, 1, -0.1}}}), "cohesion of phases 0 and 1 = -0.1 is not accepted"));
  CHECK(contains(message({std::numeric_limits<double>::quiet_NaN()}), "cohesion = nan"));
  CHECK(contains(message({1, {{0, 1, 0.1}, {1, 0, 0.2}}}),
                 "cohesion of phases 1 and 0 = 0.2 is not accepted: it was given before, as 0.1"));
  CHECK(contains(message({1, {{2, 2, 0.1}}}), "cohesion of phase 2 with itself = 0.1"));
  CHECK(message({0, {{0, 1, 1}}}) == "no InvalidInput thrown");
}
