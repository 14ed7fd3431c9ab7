// The Love–Weber theorem on bodies in equilibrium: solved by hand, and by a linear solver.

#include <cdem/stress/closure.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/statistics.hpp>

#include <Eigen/Sparse>
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using geometry::Box;
using sample::Body;
using sample::contains;
using sample::not_a_number;
using sample::refusal;
using stress::LoveWeber;
using stress::moment_of_forces;
using stress::moment_of_stress;
using stress::Outside;
using stress::Sharing;
using stress::StressField;
using stress::tessellation::Hexahedra;

TEST_CASE("two bars that carry a load, solved by hand") {
  // Supports at (-3, 0) and (3, 0), the loaded joint at (0, -4): each bar is 5 long and in tension P/2 * 5/4.
  const double load = 80, tension = load / 2 * 5 / 4;
  Body body;
  body.box = Box{Vec3(-4, -5, -1), Vec3(4, 1, 1), {}};
  body.add_particle(Vec3(-3, 0, 0), 1);
  body.add_particle(Vec3(3, 0, 0), 1);
  body.add_particle(Vec3(0, -4, 0), 1);
  body.add_bond(0, 2, tension * Vec3(3, -4, 0) / 5);
  body.add_bond(1, 2, tension * Vec3(-3, -4, 0) / 5);
  // Reactions: half of the load up, and outwards what the bars pull inwards.
  const std::vector<Vec3> external{Vec3(-30, 40, 0), Vec3(30, 40, 0), Vec3(0, -80, 0)};
  const Mat3 outer = moment_of_forces(body.particles.position, external);
  CHECK(outer(0, 0) == doctest::Approx(180)); // 30*3 twice
  CHECK(outer(1, 1) == doctest::Approx(320)); // 80*4
  for (const Hexahedra::Counts& counts : std::vector<Hexahedra::Counts>{{1, 1, 1}, {5, 4, 3}}) {
    const LoveWeber<> estimator(Hexahedra(body.box, counts));
    const StressField field = estimator.estimate(body.particles, body.network, body.forces);
    CHECK((moment_of_stress(field) - outer).norm() < 1e-12 * outer.norm());
  }
  particles::SpatialField<> spatial(3);
  for (std::size_t i = 0; i < 3; ++i) {
    spatial[i].linear() = external[i];
    spatial[i].angular() = Vec3(1, 2, 3); // no part of it
  }
  CHECK(moment_of_forces(body.particles.position, spatial) == outer);
}

TEST_CASE("a stretched row: sigma V is the force times the gauge length") {
  Body body;
  body.box = Box{Vec3(0, -0.5, -0.5), Vec3(8, 0.5, 0.5), {}};
  for (int i = 0; i < 8; ++i)
    body.add_particle(Vec3(i + 0.5, 0, 0), 0.5);
  for (std::size_t i = 0; i < 7; ++i)
    body.add_bond(i, i + 1, Vec3(12, 0, 0));
  std::vector<Vec3> external(8, Vec3::Zero());
  external.front().x() = -12;
  external.back().x() = 12;
  const LoveWeber<> estimator(Hexahedra(body.box, {8, 1, 1}));
  const StressField field = estimator.estimate(body.particles, body.network, body.forces);
  CHECK((moment_of_stress(field) - moment_of_forces(body.particles.position, external)).norm() < 1e-12);
  CHECK(stress::mean_stress(field)(0, 0) == doctest::Approx(12 * 7.0 / 8)); // F/A times 7 of 8
  for (std::size_t cell = 1; cell < 7; ++cell)
    CHECK(field.stress[cell](0, 0) == doctest::Approx(12)); // F/A between the ends
}

/// A network of springs along the branches, its particles near x = 0 and x = 1 moved apart, solved for equilibrium.
struct Solved {
  Body body;
  std::vector<Vec3> external; ///< [particles] N: zero between the clamps
  double force = 0;           ///< N, along x on the clamp at x = 1
};

constexpr double clamp = 0.1;

Solved solve_stretched_network(std::size_t count, double reach, std::uint64_t seed) {
  Solved solved;
  solved.body = sample::random_body(Box::cube(1, false), count, reach, seed);
  Body& body = solved.body;
  const auto n = static_cast<Eigen::Index>(3 * count);
  const auto clamped = [&](std::size_t i) {
    return body.particles.position[i].x() < clamp || body.particles.position[i].x() > 1 - clamp;
  };
  std::vector<Eigen::Triplet<double>> entries;
  const auto couple = [&](std::size_t row, std::size_t column, const Mat3& block) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        entries.emplace_back(static_cast<int>(3 * row) + a, static_cast<int>(3 * column) + b, block(a, b));
  };
  std::vector<Mat3> stiffness;
  for (std::size_t b = 0; b < body.network.size(); ++b) {
    const std::size_t i = body.network.first[b], j = body.network.second[b];
    const Vec3 normal = body.network.branch[b].normalized();
    // A little transverse stiffness keeps loose particles in place.
    stiffness.push_back((0.9 * normal * normal.transpose() + 0.1 * Mat3::Identity()) /
                        body.network.branch[b].norm());
    couple(i, i, stiffness[b]);
    couple(j, j, stiffness[b]);
    couple(i, j, -stiffness[b]);
    couple(j, i, -stiffness[b]);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < count; ++i)
    if (body.particles.position[i].x() > 1 - clamp)
      displacement[static_cast<Eigen::Index>(3 * i)] = 0.01;
  const Eigen::VectorXd load = -(matrix * displacement);
  // Rows and columns of the clamped particles become those of the identity.
  std::vector<Eigen::Triplet<double>> free_entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const auto& entry : entries)
    if (!clamped(static_cast<std::size_t>(entry.row()) / 3) &&
        !clamped(static_cast<std::size_t>(entry.col()) / 3))
      free_entries.push_back(entry);
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) {
      const auto row = static_cast<Eigen::Index>(3 * i) + k;
      if (clamped(i))
        free_entries.emplace_back(static_cast<int>(row), static_cast<int>(row), 1.0);
      else
        right[row] = load[row];
    }
  Eigen::SparseMatrix<double> reduced(n, n);
  reduced.setFromTriplets(free_entries.begin(), free_entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(1e-14);
  solver.compute(reduced);
  displacement += solver.solve(right);

  const auto at = [&](std::size_t i) -> Vec3 {
    return displacement.segment<3>(static_cast<Eigen::Index>(3 * i));
  };
  for (std::size_t b = 0; b < body.network.size(); ++b)
    body.forces[b] = stiffness[b] * (at(body.network.second[b]) - at(body.network.first[b]));
  solved.external.assign(count, Vec3::Zero()); // what holds each particle against its bonds
  for (std::size_t b = 0; b < body.network.size(); ++b) {
    solved.external[body.network.first[b]] -= body.forces[b];
    solved.external[body.network.second[b]] += body.forces[b];
  }
  for (std::size_t i = 0; i < count; ++i)
    if (!clamped(i)) {
      REQUIRE(solved.external[i].norm() < 1e-12); // in equilibrium
      solved.external[i].setZero();
    } else if (body.particles.position[i].x() > 1 - clamp) {
      solved.force += solved.external[i].x();
    }
  return solved;
}

TEST_CASE("a random network in equilibrium") {
  const Solved solved = solve_stretched_network(2500, 0.12, 77);
  const Body& body = solved.body;
  CAPTURE(2.0 * double(body.network.size()) / 2500);
  REQUIRE(solved.force > 0);

  SUBCASE("the specimens' V sigma is the moment of the clamps' forces") {
    const Mat3 outer = moment_of_forces(body.particles.position, solved.external);
    for (const Sharing sharing : {Sharing::by_length, Sharing::by_midpoint}) {
      const LoveWeber<> estimator(Hexahedra(body.box, {5, 6, 7}), {sharing, Outside::refuse});
      const StressField field = estimator.estimate(body.particles, body.network, body.forces);
      CHECK((moment_of_stress(field) - outer).norm() < 1e-9 * outer.norm());
    }
  }
  SUBCASE("shared by length, every slice between the clamps carries exactly F/A") {
    // The mean over a slice of the force through its planes, and each plane carries F.
    const Hexahedra slices(body.box, {20, 1, 1}); // slices 2 to 17 lie between the clamps
    const auto of = [&](Sharing sharing) {
      StressField field =
          LoveWeber<>(slices, {sharing, Outside::refuse}).estimate(body.particles, body.network, body.forces);
      field.stress = {field.stress.begin() + 2, field.stress.end() - 2};
      field.volume = {field.volume.begin() + 2, field.volume.end() - 2};
      return stress::statistics(field, Axis::x, Axis::x);
    };
    const stress::Statistics by_length = of(Sharing::by_length), by_midpoint = of(Sharing::by_midpoint);
    CHECK(std::abs(by_length.minimum - solved.force) < 1e-9 * solved.force);
    CHECK(std::abs(by_length.maximum - solved.force) < 1e-9 * solved.force);
    CHECK(by_midpoint.coefficient_of_variation() > 1e-3); // the paper's rule scatters about it
    MESSAGE("slices of " << 2500 / 20 << " particles, F/A exact: CoV of sigma_xx by length "
                         << by_length.coefficient_of_variation() << ", by midpoint "
                         << by_midpoint.coefficient_of_variation());
  }
  SUBCASE("in small cubes the two rules differ by what crosses the faces: less in larger ones") {
    double smaller = 0;
    for (const int n : {2, 3, 4, 6}) {
      const Box between{Vec3(0.1, 0.1, 0.1), Vec3(0.9, 0.9, 0.9), {}};
      const auto of = [&](Sharing sharing) {
        const LoveWeber<> estimator(Hexahedra(between, {n, n, n}), {sharing, Outside::report});
        return estimator.estimate(body.particles, body.network, body.forces);
      };
      const StressField by_length = of(Sharing::by_length), by_midpoint = of(Sharing::by_midpoint);
      double squares = 0;
      for (std::size_t cell = 0; cell < by_length.size(); ++cell)
        squares += std::pow(by_midpoint.stress[cell](0, 0) - by_length.stress[cell](0, 0), 2);
      const stress::Statistics length = stress::statistics(by_length, Axis::x, Axis::x);
      const stress::Statistics midpoint = stress::statistics(by_midpoint, Axis::x, Axis::x);
      const double difference = std::sqrt(squares / (n * n * n)) / length.mean;
      MESSAGE("cubes of " << 2500 * 0.512 / (n * n * n) << " particles: the rules differ by " << difference
                          << " of the mean sigma_xx (rms); CoV by length "
                          << length.coefficient_of_variation() << ", by midpoint "
                          << midpoint.coefficient_of_variation());
      CHECK(difference > smaller);
      smaller = difference;
    }
  }
}

TEST_CASE("bad input is refused by name") {
  const std::vector<Vec3> three(3, Vec3::Ones()), two(2, Vec3::Ones());
  CHECK(contains(refusal([&] { (void)moment_of_forces(three, two); }), "number of forces = 2"));
  CHECK(contains(refusal([&] { (void)moment_of_forces(two, particles::SpatialField<>(3)); }),
                 "number of forces = 3"));
  std::vector<Vec3> bad = three;
  bad[1].y() = not_a_number;
  CHECK(contains(refusal([&] { (void)moment_of_forces(three, bad); }), "finite forces and positions"));
  StressField field;
  field.stress.assign(2, Mat3::Zero());
  CHECK(contains(refusal([&] { (void)moment_of_stress(field); }), "number of specimen volumes = 0"));
}

} // namespace
