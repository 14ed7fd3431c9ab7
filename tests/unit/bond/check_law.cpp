// check_law() lets good laws pass and finds every fault that it looks for.

#include <cdem/bond/check_law.hpp>
#include <cdem/bond/finite_rotation.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <string>

using namespace cdem;
using bond::BondGeometry;
using bond::ChannelLoad;
using bond::Deformation;

namespace {

enum class Fault {
  none,
  not_finite,
  force_changes_when_asked,
  moment_changes_when_asked,
  feels_direction,
  ages,
  pulls_at_rest,
  first_radius_alone,
  wrong_energy,
  wrong_tangent,
  not_symmetric,
  gives_energy,
  energy_changes_when_asked,
};

/// Four springs that remember how far they were stretched, with one fault.
class Faulty {
public:
  struct State {
    double longest = 0; ///< strain
    int steps = 0;
  };
  struct Kept {
    double length, stiffness, moment;
  };

  explicit Faulty(Fault fault) : fault_(fault) {}

  Kept prepare(const BondGeometry& bond) const {
    double k =
        1e6 * (is(Fault::first_radius_alone) ? bond.radius_first : bond.radius_first + bond.radius_second);
    if (is(Fault::feels_direction))
      k *= 1 + bond.direction.x() * bond.direction.x();
    return {bond.length, k, k * bond.length * bond.length};
  }
  void update(const Kept& kept, const Deformation<>& d, State& state) const {
    state.longest = std::max(state.longest, std::abs(d.stretch) / kept.length);
    ++state.steps;
  }
  ChannelLoad<> load(const Kept& kept, const Deformation<>& d, const State& state) const {
    const double k = kept.stiffness * factor(state);
    ChannelLoad<> f{k * d.stretch,
                    {0.5 * k * d.shear.t, 0.5 * k * d.shear.b},
                    kept.moment * d.twist,
                    {kept.moment * d.bend.t, kept.moment * d.bend.b}};
    if (is(Fault::not_finite))
      f.tangential.t *= d.shear.t / d.shear.t;
    if (is(Fault::force_changes_when_asked))
      f.normal *= 1 + 1e-6 * std::sin(++asked_);
    if (is(Fault::moment_changes_when_asked))
      f.bending.t *= 1 + 1e-6 * std::sin(++asked_);
    if (is(Fault::ages))
      f.normal += 1e-8 * k * kept.length * state.steps;
    if (is(Fault::pulls_at_rest))
      f.normal += 1e-8 * k * kept.length;
    if (is(Fault::not_symmetric))
      f.normal += 0.1 * k * d.shear.t;
    return f;
  }
  double energy(const Kept& kept, const Deformation<>& d, const State& state) const {
    const double k = kept.stiffness * factor(state);
    double e = 0.5 * k * (d.stretch * d.stretch + 0.5 * d.shear.squared()) +
               0.5 * kept.moment * (d.twist * d.twist + d.bend.squared());
    if (is(Fault::wrong_energy))
      e += 0.5 * k * d.stretch * d.stretch;
    if (is(Fault::ages))
      e += 1e-8 * k * kept.length * state.steps * d.stretch;
    if (is(Fault::pulls_at_rest))
      e += 1e-8 * k * kept.length * d.stretch;
    if (is(Fault::energy_changes_when_asked))
      e += 1e-6 * kept.moment * std::sin(++asked_);
    return e;
  }
  bond::Matrix6 tangent(const Kept& kept, const Deformation<>&, const State& state, double) const {
    const double k = kept.stiffness * factor(state);
    bond::Matrix6 h = bond::matrix_of({k, 0.5 * k, kept.moment, kept.moment});
    if (is(Fault::not_symmetric))
      h(0, 1) = 0.1 * k;
    if (is(Fault::wrong_tangent))
      h(3, 3) *= 1.001;
    return h;
  }
  void validate(const particles::ParticleSet&) const {}

private:
  bool is(Fault fault) const { return fault_ == fault; }
  /// Softens with the longest strain; stiffens where energy comes from nothing.
  double factor(const State& state) const {
    return is(Fault::gives_energy) ? 1 + 200 * state.longest : 1 / (1 + 200 * state.longest);
  }

  Fault fault_;
  mutable int asked_ = 0;
};

bond::FiniteRotation<bond::Beam<>> beam() {
  return bond::FiniteRotation<bond::Beam<>>({.materials = {{.youngs_modulus = 70e9, .radius_ratio = 0.6},
                                                           {.youngs_modulus = 3e9, .radius_ratio = 0.4}}});
}

} // namespace

TEST_CASE("good laws pass, without a memory and with one") {
  for (const double angle : {1e-3, 0.3}) { // turned by more than a full turn in all
    const bond::LawReport report = bond::check_law(beam(), {.angle = angle, .turn = 8, .phases = {0, 1}});
    CHECK_MESSAGE(report.passed(), report.to_string());
    CHECK(report.checks.size() == 10); // nothing is lost without a memory
  }
  const bond::LawReport memory = bond::check_law(Faulty(Fault::none));
  CHECK_MESSAGE(memory.passed(), memory.to_string());
  CHECK(memory.checks.size() == 12);
}

TEST_CASE("every check finds a law that was made to fail it") {
  const std::pair<Fault, const char*> faults[] = {
      {Fault::not_finite, "finite values"},
      {Fault::force_changes_when_asked, "action and reaction"},
      {Fault::moment_changes_when_asked, "balance of moments"},
      {Fault::feels_direction, "frame indifference"},
      {Fault::ages, "rigid motion"},
      {Fault::pulls_at_rest, "no load at rest"},
      {Fault::first_radius_alone, "same law from either end"},
      {Fault::wrong_energy, "load = dE/dx"},
      {Fault::wrong_tangent, "tangent = dF/dx"},
      {Fault::not_symmetric, "symmetric tangent"},
      {Fault::gives_energy, "dissipation not negative"},
      {Fault::energy_changes_when_asked, "work = stored + lost"},
  };
  for (const auto& [fault, name] : faults) {
    const bond::LawReport report = bond::check_law(Faulty(fault));
    CHECK_MESSAGE(!report.at(name).passed(), report.to_string());
    CHECK(!report.passed());
    CHECK(report.at(name).where.find("bond of length") == 0);
  }
  // a fault that concerns one thing is found by one check
  for (const char* name : {"wrong tangent", "pulls at rest", "feels direction"}) {
    const Fault fault = name[0] == 'w'   ? Fault::wrong_tangent
                        : name[0] == 'p' ? Fault::pulls_at_rest
                                         : Fault::feels_direction;
    int failed = 0;
    const bond::LawReport report = bond::check_law(Faulty(fault));
    for (const bond::LawCheck& check : report.checks)
      failed += check.passed() ? 0 : 1;
    CHECK_MESSAGE(failed == 1, report.to_string());
  }
}

TEST_CASE("a load at rest is accepted where it is said") {
  const bond::LawReport report = bond::check_law(Faulty(Fault::pulls_at_rest), {.loaded_at_rest = true});
  CHECK_MESSAGE(report.passed(), report.to_string());
}

TEST_CASE("the report is a table, can throw, and is the same for the same seed") {
  const bond::LawReport report = bond::check_law(Faulty(Fault::wrong_tangent));
  CHECK(report.to_string().find("tangent = dF/dx") != std::string::npos);
  CHECK(report.to_string().find("FAILED: bond of length") != std::string::npos);
  CHECK(report.to_string() == bond::check_law(Faulty(Fault::wrong_tangent)).to_string());
  CHECK_THROWS_WITH_AS(bond::check_law(Faulty(Fault::wrong_tangent), {.throw_if_failed = true}),
                       doctest::Contains("does not pass check_law()"), core::InvalidInput);
  CHECK_NOTHROW(bond::check_law(Faulty(Fault::none), {.throw_if_failed = true}));
  CHECK_THROWS_WITH_AS(report.at("colour"), doctest::Contains("name of a check = colour"),
                       core::InvalidInput);
}

TEST_CASE("a parameter that is not accepted is named; so is what the law says of the phases") {
  const auto check = [](bond::LawCheckParameters parameters) {
    bond::check_law(Faulty(Fault::none), parameters);
  };
  CHECK_THROWS_WITH_AS(check({.strain = 0}), doctest::Contains("strain of the"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(check({.angle = -1}), doctest::Contains("angle of the"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(check({.turn = 0}), doctest::Contains("turn of the"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(check({.radius = 0}), doctest::Contains("radius of the"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(check({.phases = {}}), doctest::Contains("number of phases"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(check({.bonds = 0}), doctest::Contains("number of bonds"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(check({.deformations = 0}), doctest::Contains("number of deformations"),
                       core::InvalidInput);
  CHECK_THROWS_WITH_AS(bond::check_law(beam(), {.phases = {2}}), doctest::Contains("phase of particle 0"),
                       core::InvalidInput);
}
