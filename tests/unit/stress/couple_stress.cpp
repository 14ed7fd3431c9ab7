// Couple stress: by hand on single bonds, and the balance of moments of a body in equilibrium, in all estimators.

#include <cdem/stress/closure.hpp>
#include <cdem/stress/coarse_graining.hpp>
#include <cdem/stress/halo.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/tessellation/polyhedra.hpp>
#include <cdem/stress/tessellation/tetrahedra.hpp>
#include <cdem/stress/tessellation/wedges.hpp>
#include <cdem/stress/time_average.hpp>

#include <doctest/doctest.h>

#include "solved_body.hpp"

namespace {

using namespace cdem;
using namespace cdem::stress::tessellation;
using geometry::Box;
using sample::Body;
using sample::contains;
using sample::refusal;
using stress::BondLoads;
using stress::LoveWeber;
using stress::StressField;

/// One bond along x from 0 to 4, in four cells, bent by an end force: a cantilever held at its first end.
struct Cantilever {
  Body body;
  std::vector<Vec3> moments;
  Cantilever() {
    body.box = Box{Vec3(0, -0.5, -0.5), Vec3(4, 0.5, 0.5), {}};
    body.add_particle(Vec3(0, 0, 0), 1);
    body.add_particle(Vec3(4, 0, 0), 1);
    body.add_bond(0, 1, Vec3(0, 3, 0)); // pulls the first particle up; the moment vanishes at the second
    moments = {Vec3(0, 0, 2 * 3)};      // M at the middle = half the length times the force
  }
};

TEST_CASE("a cantilever's bending moment falls along it") {
  const Cantilever c;
  const LoveWeber<> estimator(Hexahedra(c.body.box, {4, 1, 1}));
  const StressField field = estimator.estimate(c.body.particles, c.body.network, {c.body.forces, c.moments});
  for (std::size_t cell = 0; cell < 4; ++cell) {
    Mat3 couple = Mat3::Zero();
    couple(2, 0) = 3 * (3.5 - double(cell)); // force times the distance to the free end, at the cell's middle
    CHECK((field.couple_stress[cell] - couple).norm() < 1e-13);
    CHECK(field.stress[cell](1, 0) == doctest::Approx(3));
  }
  CHECK(field.outside_couple == Mat3::Zero());
  CHECK((stress::moment_of_couple_stress(field) - c.moments[0] * Vec3(4, 0, 0).transpose()).norm() < 1e-13);

  SUBCASE("the whole bond by the rule of the midpoint: the moment at the contact") {
    Cantilever uneven;
    uneven.body.particles.radius = {2.5, 0.5}; // the contact at x = 3
    const LoveWeber<> rule(Hexahedra(c.body.box, {4, 1, 1}), {stress::Sharing::by_midpoint, {}});
    const StressField whole =
        rule.estimate(uneven.body.particles, uneven.body.network, {uneven.body.forces, uneven.moments});
    CHECK(whole.couple_stress[3](2, 0) == doctest::Approx(4 * 3 * 1.0));
    CHECK(whole.couple_stress[2](2, 0) == 0);
  }
  SUBCASE("what lies outside a window is reported with the moment it has there") {
    const LoveWeber<> window(Hexahedra(Box{Vec3(1, -0.5, -0.5), Vec3(2, 0.5, 0.5), {}}, {1, 1, 1}),
                             {stress::Sharing::by_length, stress::Outside::report});
    const StressField part = window.estimate(c.body.particles, c.body.network, {c.body.forces, c.moments});
    CHECK(part.couple_stress[0](2, 0) == doctest::Approx(3 * 2.5));
    CHECK(part.outside_couple(2, 0) == doctest::Approx(3 * (3.5 + 1.5 + 0.5)));
  }
  SUBCASE("in a ball around x = 3 of radius 1/2") {
    const stress::Halo halo({Vec3(3, 0, 0)}, 0.5, c.body.box);
    const StressField ball = halo.estimate(c.body.particles, c.body.network, {c.body.forces, c.moments});
    CHECK(ball.couple_stress[0](2, 0) * ball.volume[0] == doctest::Approx(3 * 1.0));
    CHECK(ball.stress[0](1, 0) * ball.volume[0] == doctest::Approx(3 * 1.0));
  }
  SUBCASE("turned around, a bond says the same") {
    Cantilever turned;
    turned.body.network.first = {1};
    turned.body.network.second = {0};
    turned.body.network.branch = {Vec3(-4, 0, 0)};
    turned.body.forces = {Vec3(0, -3, 0)};
    turned.moments = {-c.moments[0]};
    const StressField same =
        estimator.estimate(turned.body.particles, turned.body.network, {turned.body.forces, turned.moments});
    for (std::size_t cell = 0; cell < 4; ++cell)
      CHECK((same.couple_stress[cell] - field.couple_stress[cell]).norm() < 1e-13);
  }
}

TEST_CASE("no moments, no couple stress; forces alone give the same stress") {
  const Cantilever c;
  const LoveWeber<> estimator(Hexahedra(c.body.box, {4, 1, 1}));
  const StressField with = estimator.estimate(c.body.particles, c.body.network, {c.body.forces, c.moments});
  const StressField without = estimator.estimate(c.body.particles, c.body.network, c.body.forces);
  CHECK(without.couple_stress.empty());
  CHECK(without.stress[1] == with.stress[1]);
  CHECK(contains(refusal([&] { (void)stress::moment_of_couple_stress(without); }),
                 "number of couple stresses = 0"));
}

TEST_CASE("a body in equilibrium: both sides of the balance, in every tessellation") {
  const sample::SolvedBody solved = sample::solve_body(800, 0.16, 5);
  const Body& body = solved.body;
  const Mat3 outer = stress::moment_of_forces(body.particles.position, solved.external);
  Mat3 outer_couple = Mat3::Zero(); // M_ext (x) x, and (d x f) (x) x_m
  double couple_scale = 0;
  for (std::size_t i = 0; i < body.particles.size(); ++i)
    outer_couple += solved.external[i].angular() * body.particles.position[i].transpose();
  for (std::size_t b = 0; b < body.network.size(); ++b) {
    const Vec3 middle = body.particles.position[body.network.first[b]] + 0.5 * body.network.branch[b];
    outer_couple += sample::couple_of(solved, b) * middle.transpose();
    couple_scale += solved.moments[b].norm() * body.network.branch[b].norm();
  }
  const auto check = [&](const auto& cells) {
    const LoveWeber<std::decay_t<decltype(cells)>> estimator(cells);
    const StressField field = estimator.estimate(body.particles, body.network, solved.loads());
    CHECK((stress::moment_of_stress(field) - outer).norm() < 1e-9 * outer.norm());
    CHECK((stress::moment_of_couple_stress(field) - outer_couple).norm() < 1e-9 * couple_scale);
    core::ThreadPool pool(3);
    CHECK(sample::same_bytes(field, estimator.estimate(body.particles, body.network, solved.loads(), pool)));
  };
  const Hexahedra grid(body.box, {3, 4, 5});
  check(grid);
  check(Wedges(grid, Axis::y));
  check(Tetrahedra(grid));
  check(Polyhedra(mesh_of(grid)));
}

TEST_CASE("coarse graining balances forces and moments at every point") {
  // div sigma + b = 0 and div mu + e:sigma + m = 0 by central differences: the error falls as the square of the step.
  const sample::SolvedBody solved = sample::solve_body(800, 0.16, 5);
  const Body& body = solved.body;
  std::vector<Vec3> force, moment;
  for (const auto& f : solved.external) {
    force.push_back(f.linear());
    moment.push_back(f.angular());
  }
  core::Random random(6);
  std::vector<Vec3> points;
  for (int n = 0; n < 40; ++n)
    points.push_back(sample::random_point(random, Box{Vec3::Constant(0.05), Vec3::Constant(0.95), {}}));
  core::ThreadPool pool(2);
  const auto check = [&](const auto& kernel) {
    using Graining = stress::CoarseGraining<std::decay_t<decltype(kernel)>>;
    const Graining at_points(points, kernel, body.box);
    const auto b = at_points.spread(body.particles.position, force, pool);
    const auto m = at_points.spread(body.particles.position, moment, pool);
    const StressField centre = at_points.estimate(body.particles, body.network, solved.loads(), pool);
    const auto imbalance = [&](double step) {
      std::vector<Vec3> around;
      for (const Vec3& point : points)
        for (int k = 0; k < 3; ++k)
          for (const double way : {-1.0, 1.0})
            around.push_back(point + way * step * Vec3::Unit(k));
      const StressField field =
          Graining(around, kernel, body.box).estimate(body.particles, body.network, solved.loads(), pool);
      double of_forces = 0, of_moments = 0;
      for (std::size_t p = 0; p < points.size(); ++p) {
        Vec3 forces = b[p], moments = m[p];
        for (std::size_t k = 0; k < 3; ++k) {
          const auto column = static_cast<Eigen::Index>(k);
          const std::size_t low = 6 * p + 2 * k, high = low + 1;
          forces += (field.stress[high] - field.stress[low]).col(column) / (2 * step);
          moments += (field.couple_stress[high] - field.couple_stress[low]).col(column) / (2 * step);
        }
        const Mat3& s = centre.stress[p];
        moments += Vec3(s(2, 1) - s(1, 2), s(0, 2) - s(2, 0), s(1, 0) - s(0, 1));
        of_forces = std::max(of_forces, forces.norm());
        of_moments = std::max(of_moments, moments.norm());
      }
      return std::pair(of_forces, of_moments);
    };
    double scale = 0, couple_scale = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      scale = std::max(scale, centre.stress[p].norm() / kernel.reach());
      couple_scale = std::max(couple_scale, centre.couple_stress[p].norm() / kernel.reach());
    }
    const auto coarse = imbalance(4e-3), fine = imbalance(2e-3), finest = imbalance(1e-3);
    CHECK(coarse.first / fine.first == doctest::Approx(4).epsilon(0.05));
    CHECK(fine.first / finest.first == doctest::Approx(4).epsilon(0.05));
    CHECK(coarse.second / fine.second == doctest::Approx(4).epsilon(0.05));
    CHECK(fine.second / finest.second == doctest::Approx(4).epsilon(0.05));
    CHECK(finest.first < 1e-3 * scale);
    CHECK(finest.second < 1e-3 * couple_scale);
    MESSAGE("steps 4e-3, 2e-3, 1e-3: imbalance of forces "
            << coarse.first / scale << ", " << fine.first / scale << ", " << finest.first / scale
            << " of sigma/reach; of moments " << coarse.second / couple_scale << ", "
            << fine.second / couple_scale << ", " << finest.second / couple_scale << " of mu/reach");
  };
  check(stress::Lucy(0.3));
  check(stress::Gaussian(0.08));
}

TEST_CASE("couple stresses are averaged over time with the stresses") {
  const Cantilever c;
  stress::TimeAverage average;
  const auto add = [&](double factor, double weight) {
    const std::vector<Vec3> forces{factor * c.body.forces[0]}, moments{factor * c.moments[0]};
    const stress::Halo halo({Vec3(1, 0, 0), Vec3(3, 0, 0)}, 0.5, c.body.box);
    average.add(halo.estimate(c.body.particles, c.body.network, {forces, moments}), 1, weight);
  };
  add(1, 1);
  add(4, 2);
  const StressField mean = average.result();
  CHECK(mean.couple_stress[0](2, 0) * mean.volume[0] == doctest::Approx(3 * (3 * 3.0)));
  CHECK(mean.stress[1](1, 0) * mean.volume[1] == doctest::Approx(3 * 3.0));
  CHECK(average.result(2).couple_stress[1](2, 0) == doctest::Approx(2 * mean.couple_stress[1](2, 0)));

  StressField bad = mean;
  bad.couple_stress.clear();
  CHECK(contains(refusal([&] { average.add(bad); }), "number of couple stresses = 0"));
  bad.couple_stress.resize(1);
  CHECK(contains(refusal([&] { average.add(bad); }), "number of couple stresses = 1"));
  bad = mean;
  bad.couple_stress[1](0, 0) = sample::not_a_number;
  CHECK(contains(refusal([&] { average.add(bad); }), "couple stress of specimen 1"));
}

TEST_CASE("bad moments are refused by name") {
  const Cantilever c;
  const LoveWeber<> estimator(Hexahedra(c.body.box, {4, 1, 1}));
  const auto message = [&](const std::vector<Vec3>& moments) {
    return refusal([&] {
      (void)estimator.estimate(c.body.particles, c.body.network, {c.body.forces, moments});
    });
  };
  CHECK(message(c.moments).empty());
  CHECK(contains(message({Vec3::Zero(), Vec3::Zero()}), "number of moments = 2"));
  CHECK(contains(message({Vec3(0, sample::infinity, 0)}), "moment of bond 0"));
}

} // namespace
