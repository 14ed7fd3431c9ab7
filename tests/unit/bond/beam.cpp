#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>

#include <doctest/doctest.h>

#include <numbers>
#include <utility>

#include "body.hpp"

namespace {

using namespace cdem;
using bond::Beam;
using bond::Material;

const Material alumina{2536e9, 0.545, 0.3};

/// Circular section of a beam: area, second moment, polar moment, from its diameter.
struct Section {
  double area, second_moment, polar_moment;
  explicit Section(double diameter)
      : area(std::numbers::pi * diameter * diameter / 4),
        second_moment(std::numbers::pi * std::pow(diameter, 4) / 64),
        polar_moment(std::numbers::pi * std::pow(diameter, 4) / 32) {}
};

/// The textbook stiffness matrix of a beam along x, rows and columns u v w, rotations about x y z, of end 1
/// and of end 2, written out entry by entry.
body::Matrix12 textbook_beam(double e, double g, const Section& section, double l) {
  const double a = e * section.area / l, t = g * section.polar_moment / l;
  const double b12 = 12 * e * section.second_moment / (l * l * l),
               b6 = 6 * e * section.second_moment / (l * l);
  const double b4 = 4 * e * section.second_moment / l, b2 = 2 * e * section.second_moment / l;
  body::Matrix12 k;
  k << a, 0, 0, 0, 0, 0, -a, 0, 0, 0, 0, 0,        //
      0, b12, 0, 0, 0, b6, 0, -b12, 0, 0, 0, b6,   //
      0, 0, b12, 0, -b6, 0, 0, 0, -b12, 0, -b6, 0, //
      0, 0, 0, t, 0, 0, 0, 0, 0, -t, 0, 0,         //
      0, 0, -b6, 0, b4, 0, 0, 0, b6, 0, b2, 0,     //
      0, b6, 0, 0, 0, b4, 0, -b6, 0, 0, 0, b2,     //
      -a, 0, 0, 0, 0, 0, a, 0, 0, 0, 0, 0,         //
      0, -b12, 0, 0, 0, -b6, 0, b12, 0, 0, 0, -b6, //
      0, 0, -b12, 0, b6, 0, 0, 0, b12, 0, b6, 0,   //
      0, 0, 0, -t, 0, 0, 0, 0, 0, t, 0, 0,         //
      0, 0, -b6, 0, b2, 0, 0, 0, b6, 0, b4, 0,     //
      0, b6, 0, 0, 0, b2, 0, -b6, 0, 0, 0, b4;
  return k;
}

/// The 12x12 rotation from the laboratory's axes to a frame whose x is `n`, turned about it by `angle`.
body::Matrix12 rotation_to(const Vec3& n, double angle) {
  const Vec3 any = std::abs(n.x()) < 0.5 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 t0 = n.cross(any).normalized(), b0 = n.cross(t0);
  const Vec3 t = std::cos(angle) * t0 + std::sin(angle) * b0;
  Mat3 frame;
  frame << n.transpose(), t.transpose(), n.cross(t).transpose();
  body::Matrix12 rotation = body::Matrix12::Zero();
  for (int block = 0; block < 4; ++block)
    rotation.block<3, 3>(3 * block, 3 * block) = frame;
  return rotation;
}

/// Unknowns of a dense system: every degree of freedom but the first particle's, which is clamped.
Eigen::VectorXd clamped_solution(const bond::LinearForces& forces, const Eigen::VectorXd& load) {
  const Eigen::MatrixXd stiffness = body::dense_stiffness(forces);
  const Eigen::Index free = stiffness.rows() - 6;
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(stiffness.rows());
  solution.tail(free) = stiffness.bottomRightCorner(free, free).ldlt().solve(load.tail(free));
  return solution;
}

} // namespace

TEST_CASE("the beam is the textbook Euler-Bernoulli beam in any direction") {
  core::Random random(1);
  const Beam<> law({.materials = {alumina}});
  double worst = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const bond::BondGeometry geometry = body::random_geometry(random);
    const Section section(alumina.radius_ratio * (geometry.radius_first + geometry.radius_second));
    const body::Matrix12 rotation = rotation_to(geometry.direction, random.uniform(0, 6));
    const body::Matrix12 stiffness =
        rotation.transpose() *
        textbook_beam(alumina.youngs_modulus, alumina.youngs_modulus / 2.6, section, geometry.length) *
        rotation;
    const body::Vector12 ends = body::random_ends(random, geometry.length);
    const body::Vector12 expected = -stiffness * ends;
    const body::Vector12 found =
        body::on_both_ends(bond::load_of(law.stiffness(geometry), geometry.direction, geometry.length,
                                         bond::deformation_of(geometry.direction, geometry.length,
                                                              body::end_of(ends, 0), body::end_of(ends, 1))));
    // forces and moments differ in unit: each is compared with the largest of its kind
    for (const int part : {0, 3, 6, 9})
      worst = std::max(worst, (found - expected).segment<3>(part).norm() /
                                  std::max(expected.segment<3>(part % 6).norm(),
                                           expected.segment<3>(part % 6 + 6).norm()));
  }
  CHECK(worst < 1e-12);
}

TEST_CASE("a beam's stiffnesses are those of [L17] section 2.2, with r_mu times the mean radius") {
  const Beam<> law({.materials = {{100e9, 0.5, 0.25}}});
  const bond::ChannelStiffness k = law.stiffness(
      {.direction = Vec3::UnitX(), .length = 4e-3, .radius_first = 1e-3, .radius_second = 3e-3});
  const double a = 1e-3, pi = std::numbers::pi; // 0.5 (1 + 3)/2 mm
  CHECK(k.normal == doctest::Approx(100e9 * pi * a * a / 4e-3).epsilon(1e-14));
  CHECK(k.tangential == doctest::Approx(12 * 100e9 * (pi * a * a * a * a / 4) / 64e-9).epsilon(1e-14));
  CHECK(k.torsion == doctest::Approx(2 * 40e9 * (pi * a * a * a * a / 4) / 4e-3).epsilon(1e-14));
  CHECK(k.bending == doctest::Approx(100e9 * (pi * a * a * a * a / 4) / 4e-3).epsilon(1e-14));
}

TEST_CASE("a cantilever of beams bends as the exact one, whatever its direction") {
  const double spacing = 2e-3, radius = 1e-3, load = 3.0;
  const Section section(alumina.radius_ratio * 2 * radius);
  for (const std::size_t count : {2u, 3u, 11u}) {
    const Vec3 direction = Vec3(1, -2, 3).normalized(), across = Vec3(3, 0, -1).normalized();
    const auto [particles, network] = body::row(count, direction, spacing, radius);
    const bond::LinearForces forces(Beam<>({.materials = {alumina}}), particles, network);
    Eigen::VectorXd external = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(count));
    external.tail(6).head(3) = load * across;
    const Eigen::VectorXd tip = clamped_solution(forces, external).tail(6);

    const double length = static_cast<double>(count - 1) * spacing;
    const double flexural_rigidity = alumina.youngs_modulus * section.second_moment;
    const Vec3 deflection = load * std::pow(length, 3) / (3 * flexural_rigidity) * across;
    const Vec3 rotation = load * length * length / (2 * flexural_rigidity) * direction.cross(across);
    CHECK((tip.head(3) - deflection).norm() < 1e-9 * deflection.norm());
    CHECK((tip.tail(3) - rotation).norm() < 1e-9 * rotation.norm());
  }
}

TEST_CASE("a row of beams twists and stretches as a bar") {
  const double spacing = 2e-3, radius = 1e-3, torque = 0.01, pull = 5;
  const std::size_t count = 9;
  const Vec3 direction = Vec3(-1, 1, 0.5).normalized();
  const auto [particles, network] = body::row(count, direction, spacing, radius);
  const bond::LinearForces forces(Beam<>({.materials = {alumina}}), particles, network);
  Eigen::VectorXd external = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(count));
  external.tail(6) << pull * direction, torque * direction;
  const Eigen::VectorXd tip = clamped_solution(forces, external).tail(6);

  const Section section(alumina.radius_ratio * 2 * radius);
  const double length = static_cast<double>(count - 1) * spacing,
               shear_modulus = alumina.youngs_modulus / 2.6;
  const Vec3 twist = torque * length / (shear_modulus * section.polar_moment) * direction;
  const Vec3 stretch = pull * length / (alumina.youngs_modulus * section.area) * direction;
  CHECK((tip.tail(3) - twist).norm() < 1e-10 * twist.norm());
  CHECK((tip.head(3) - stretch).norm() < 1e-10 * stretch.norm());
}

TEST_CASE("a bond across an interface has the mixed material") {
  const Material metal{12020e9, 0.169, 0.33};
  const auto normal_stiffness = [&](auto rule) {
    const Beam<decltype(rule)> law({.materials = {alumina, metal}, .interface_rule = rule});
    bond::BondGeometry geometry{
        .direction = Vec3::UnitZ(), .length = 2, .radius_first = 1, .radius_second = 1};
    geometry.phase_second = 1;
    const double forward = law.stiffness(geometry).normal;
    std::swap(geometry.phase_first, geometry.phase_second);
    CHECK(law.stiffness(geometry).normal == forward);
    return forward;
  };
  const auto expected = [](double modulus, double ratio) {
    return modulus * std::numbers::pi * ratio * ratio / 2;
  };
  CHECK(normal_stiffness(bond::GeometricMean{}) ==
        doctest::Approx(expected(std::sqrt(2536e9 * 12020e9), std::sqrt(0.545 * 0.169))).epsilon(1e-13));
  CHECK(normal_stiffness(bond::ArithmeticMean{}) == doctest::Approx(expected(7278e9, 0.357)).epsilon(1e-13));
  CHECK(
      normal_stiffness(bond::HarmonicMean{}) ==
      doctest::Approx(expected(2 / (1 / 2536e9 + 1 / 12020e9), 2 / (1 / 0.545 + 1 / 0.169))).epsilon(1e-13));
}
