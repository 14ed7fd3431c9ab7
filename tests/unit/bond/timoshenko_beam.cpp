#include <cdem/bond/linear_forces.hpp>
#include <cdem/bond/timoshenko_beam.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "body.hpp"

namespace {

using namespace cdem;
using bond::Material;
using bond::TimoshenkoBeam;

const Material ceramic{300e9, 0.6, 0.22};
constexpr double spacing = 2e-3, radius = 1.1e-3;

/// Deflection and rotation of the tip of a cantilever of length `length` under a force across it, from the theory of
/// Timoshenko's beam: F L^3/(3 E I) + F L/(kappa G A), F L^2/(2 E I).
struct Tip {
  double deflection, rotation;
  Tip(double force, double length) {
    const double a = ceramic.radius_ratio * radius, area = std::numbers::pi * a * a,
                 nu = ceramic.poissons_ratio;
    const double rigidity = ceramic.youngs_modulus * 0.25 * area * a * a;
    const double kappa = 6 * (1 + nu) / (7 + 6 * nu); // Cowper (1966)
    const double shear = kappa * ceramic.youngs_modulus / (2 * (1 + nu)) * area;
    deflection = force * std::pow(length, 3) / (3 * rigidity) + force * length / shear;
    rotation = force * length * length / (2 * rigidity);
  }
};

} // namespace

TEST_CASE("a cantilever bends and shears as Timoshenko's, whatever its number of beams and its direction") {
  const double load = 3;
  for (const std::size_t count : {2u, 3u, 9u}) {
    const Vec3 direction = Vec3(1, -2, 3).normalized(), across = Vec3(3, 0, -1).normalized();
    const auto [particles, network] = body::row(count, direction, spacing, radius);
    const bond::LinearForces forces(TimoshenkoBeam<>({.materials = {ceramic}}), particles, network);
    const Eigen::MatrixXd stiffness = body::dense_stiffness(forces);
    const Eigen::Index free = stiffness.rows() - 6;
    Eigen::VectorXd external = Eigen::VectorXd::Zero(free);
    external.tail(6).head(3) = load * across;
    const Eigen::VectorXd tip = stiffness.bottomRightCorner(free, free).llt().solve(external).tail(6);

    const Tip exact(load, static_cast<double>(count - 1) * spacing);
    CHECK((tip.head(3) - exact.deflection * across).norm() < 1e-10 * exact.deflection);
    CHECK((tip.tail(3) - exact.rotation * direction.cross(across)).norm() < 1e-10 * exact.rotation);
  }
}

TEST_CASE("only the tangential stiffness is another than Beam's, and a slender beam is Beam's") {
  const TimoshenkoBeam<> law({.materials = {ceramic}});
  const bond::Beam<> beam({.materials = {ceramic}});
  const auto at = [&](double length) {
    return bond::BondGeometry{
        .direction = Vec3::UnitX(), .length = length, .radius_first = radius, .radius_second = radius};
  };
  const bond::ChannelStiffness k = law.stiffness(at(spacing)), thin = beam.stiffness(at(spacing));
  CHECK(k.normal == thin.normal);
  CHECK(k.torsion == thin.torsion);
  CHECK(k.bending == thin.bending);
  CHECK(k.tangential < 0.6 * thin.tangential);
  // Phi goes as 1/L^2: at a hundred times the length, a ten-thousandth
  const double phi = thin.tangential / k.tangential - 1;
  CHECK(beam.stiffness(at(100 * spacing)).tangential / law.stiffness(at(100 * spacing)).tangential - 1 ==
        doctest::Approx(1e-4 * phi).epsilon(1e-9));
  CHECK(law.section_radius(at(spacing)) == ceramic.radius_ratio * radius);
}

TEST_CASE("a phase without a material is refused") {
  body::Body pair = body::row(2, Vec3::UnitX(), spacing, radius); // Clang 14 captures no structured binding
  pair.particles.phase[1] = 1;
  CHECK(body::contains(body::message_of([&] {
                         bond::LinearForces(TimoshenkoBeam<>({.materials = {ceramic}}), pair.particles,
                                            pair.network);
                       }),
                       "phase of particle 1 = 1 is not accepted"));
}
