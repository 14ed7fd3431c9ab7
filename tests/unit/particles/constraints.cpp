#include <cdem/core/random.hpp>
#include <cdem/particles/constraints.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <map>
#include <string>

using namespace cdem;
using core::InvalidInput;
using particles::Constraint;
using particles::Constraints;

TEST_CASE("constraints come out sorted, each once, whatever the order they are added in") {
  core::Random random(1);
  Constraints constraints;
  std::map<std::pair<ParticleIndex, int>, double> expected;
  for (int k = 0; k < 2000; ++k) {
    const auto particle = static_cast<ParticleIndex>(random.bits() % 100);
    const auto dof = static_cast<std::uint8_t>(random.bits() % 6);
    const double rate = 10.0 * particle + dof;
    constraints.add({particle, dof, rate});
    expected[{particle, dof}] = rate;
  }
  REQUIRE(constraints.size() == expected.size());
  auto next = expected.begin();
  for (const Constraint& constraint : constraints.list()) {
    CHECK(constraint.particle == next->first.first);
    CHECK(constraint.dof == next->first.second);
    CHECK(constraint.rate == next->second);
    ++next;
  }
}

TEST_CASE("empty and size") {
  Constraints constraints;
  CHECK(constraints.empty());
  constraints.add({3, 5, 0});
  CHECK_FALSE(constraints.empty());
  CHECK(constraints.size() == 1);
  constraints.add({3, 5, 0}); // again, the same: no change
  CHECK(constraints.size() == 1);
}

TEST_CASE("bad constraints are refused and change nothing") {
  Constraints constraints;
  constraints.add({1, 2, 0.5});
  constraints.add({4, 0, 0});
  CHECK_THROWS_WITH_AS(constraints.add({0, 6, 0}),
                       "constrained degree of freedom = 6 is not accepted: 0 to 5 is expected", InvalidInput);
  CHECK_THROWS_AS(constraints.add({0, 255, 0}), InvalidInput);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_WITH_AS(constraints.add({7, 0, bad}),
                         ("rate of the constraint on particle 7 = " + core::to_text(bad) +
                          " is not accepted: a finite number is expected")
                             .c_str(),
                         InvalidInput);
  CHECK_THROWS_WITH_AS(
      constraints.add({1, 2, -0.5}),
      "rate of the constraint on particle 1, degree of freedom 2 = -0.5 is not accepted: it is "
      "already prescribed at 0.5",
      InvalidInput);
  REQUIRE(constraints.size() == 2);
  CHECK(constraints.list()[0].rate == 0.5);
}
