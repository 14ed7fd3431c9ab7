#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/bond/material.hpp>

#include <doctest/doctest.h>

#include <limits>

#include "body.hpp"

namespace {

using namespace cdem;
using body::contains;
using bond::Material;
using bond::MaterialTable;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Rule = bond::GeometricMean>
std::string message(const std::vector<Material>& materials, Rule rule = {}) {
  return body::message_of([&] { MaterialTable<Rule> table(materials, rule); });
}

/// No rule of mixtures: gives a modulus of zero.
struct NoCohesion {
  double operator()(double a, double b) const { return a == b ? a : 0; }
};

} // namespace

TEST_CASE("the shear modulus follows from E and Poisson's ratio") {
  CHECK(Material{260, 0.5, 0.3}.shear_modulus() == doctest::Approx(100).epsilon(1e-15));
  CHECK(Material{260, 0.5, 0}.shear_modulus() == 130);
}

TEST_CASE("the rules of mixtures: means, symmetric, ordered") {
  const auto check = [](double a, double b) {
    const double h = bond::HarmonicMean{}(a, b), g = bond::GeometricMean{}(a, b),
                 m = bond::ArithmeticMean{}(a, b);
    CHECK(std::min(a, b) <= h);
    CHECK(h <= g);
    CHECK(g <= m);
    CHECK(m <= std::max(a, b));
    CHECK(g * g == doctest::Approx(h * m).epsilon(1e-14));
  };
  check(1, 100);
  check(7, 0.01);
  CHECK(bond::GeometricMean{}(4, 9) == 6);
  CHECK(bond::ArithmeticMean{}(4, 9) == 6.5);
  CHECK(bond::HarmonicMean{}(4, 12) == 6);
}

TEST_CASE("each pair of phases has its material, the same both ways") {
  const std::vector<Material> materials{{100, 0.5, 0.1}, {400, 0.125, 0.3}, {900, 0.5, -0.2}};
  const MaterialTable<> table(materials);
  CHECK(table.size() == 3);
  for (PhaseIndex p = 0; p < 3; ++p) { // a phase's own material comes out as it went in, to the last bit
    CHECK(table.between(p, p).youngs_modulus == materials[p].youngs_modulus);
    CHECK(table.between(p, p).radius_ratio == materials[p].radius_ratio);
    CHECK(table.between(p, p).poissons_ratio == materials[p].poissons_ratio);
    for (PhaseIndex q = 0; q < 3; ++q)
      CHECK(table.between(p, q).youngs_modulus == table.between(q, p).youngs_modulus);
  }
  CHECK(table.between(0, 1).youngs_modulus == doctest::Approx(200).epsilon(1e-15));
  CHECK(table.between(0, 1).radius_ratio == doctest::Approx(0.25).epsilon(1e-15));
  CHECK(table.between(1, 2).poissons_ratio == doctest::Approx(0.05).epsilon(1e-13));
}

TEST_CASE("a material out of range is refused, naming the value and what is accepted") {
  CHECK(contains(message({{0, 0.5}}), "E_mu of phase 0 = 0 is not accepted: a finite number above 0 Pa"));
  CHECK(contains(message({{-1e9, 0.5}}), "E_mu of phase 0 = -1000000000 is not accepted"));
  CHECK(contains(message({{not_a_number, 0.5}}), "E_mu of phase 0 = nan"));
  CHECK(contains(message({{infinity, 0.5}}), "E_mu of phase 0 = inf"));
  CHECK(contains(message({{1, 0.5}, {1, 0}}), "r_mu of phase 1 = 0 is not accepted: a number in ]0, 1]"));
  CHECK(contains(message({{1, 1.2}}), "r_mu of phase 0 = 1.2"));
  CHECK(contains(message({{1, not_a_number}}), "r_mu of phase 0 = nan"));
  CHECK(contains(message({{1, 1, 0.51}}), "microscopic Poisson's ratio of phase 0 = 0.51"));
  CHECK(contains(message({{1, 1, -1}}), "microscopic Poisson's ratio of phase 0 = -1 is not accepted"));
  CHECK(contains(message({{1, 1, not_a_number}}), "microscopic Poisson's ratio of phase 0 = nan"));
  CHECK(message({{1, 1, 0.5}}) == "no InvalidInput thrown");
}

TEST_CASE("the number of materials, and what a rule makes of them, are checked") {
  CHECK(contains(message({}), "number of materials = 0 is not accepted: 1 to 256"));
  CHECK(contains(message(std::vector<Material>(257, {1, 1})), "number of materials = 257"));
  CHECK(message(std::vector<Material>(256, {1, 1})) == "no InvalidInput thrown");
  CHECK(contains(message({{1, 1}, {2, 1}}, NoCohesion{}), "E_mu of the interface of phases 0 and 1 = 0"));
}

TEST_CASE("a particle whose phase has no material is named") {
  body::Body row = body::row(3, Vec3::UnitX(), 1, 0.5);
  row.particles.phase[2] = 1;
  const bond::Beam<> law({.materials = {{1, 1}}});
  CHECK(contains(body::message_of([&] { law.validate(row.particles); }),
                 "phase of particle 2 = 1 is not accepted: a phase with a material is expected, 1 given"));
  CHECK(contains(body::message_of([&] { bond::LinearForces forces(law, row.particles, row.network); }),
                 "phase of particle 2 = 1"));
}
