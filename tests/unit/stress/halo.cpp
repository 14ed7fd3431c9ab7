// Balls around points: their volume between walls, and what bonds have inside, by sampling.

#include <cdem/stress/closure.hpp>
#include <cdem/stress/halo.hpp>
#include <cdem/stress/love_weber.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using geometry::Box;
using geometry::volume_in_box;
using sample::Body;
using sample::contains;
using sample::refusal;
using stress::Halo;
using stress::StressField;

constexpr double pi = std::numbers::pi;

TEST_CASE("the volume of a ball between walls: known parts") {
  const Box box{Vec3(-2, -3, -4), Vec3(2, 3, 4), {}};
  const double r = 1.25, whole = 4.0 / 3 * pi * r * r * r;
  CHECK(volume_in_box(Vec3(0, 0, 0), r, box) == doctest::Approx(whole).epsilon(1e-14));
  CHECK(volume_in_box(Vec3(2, 0, 0), r, box) == doctest::Approx(whole / 2).epsilon(1e-14));
  CHECK(volume_in_box(Vec3(2, -3, 0), r, box) == doctest::Approx(whole / 4).epsilon(1e-14));
  CHECK(volume_in_box(Vec3(2, -3, 4), r, box) == doctest::Approx(whole / 8).epsilon(1e-14));
  for (const double gap : {0.1, 0.6, 1.2}) { // caps of height r - gap
    const double cap = pi * std::pow(r - gap, 2) * (2 * r + gap) / 3;
    CHECK(volume_in_box(Vec3(2 - gap, 0, 0), r, box) == doctest::Approx(whole - cap).epsilon(1e-14));
    CHECK(volume_in_box(Vec3(0, gap - 3, 0), r, box) == doctest::Approx(whole - cap).epsilon(1e-14));
    // At an edge half of the rest.
    CHECK(volume_in_box(Vec3(2, gap - 3, 0), r, box) == doctest::Approx((whole - cap) / 2).epsilon(1e-14));
  }
  CHECK(volume_in_box(Vec3(0.3, 1, -2), 100, box) == doctest::Approx(box.volume()).epsilon(1e-14));
  const Box slit{box.lower, box.upper, {true, false, true}};
  CHECK(volume_in_box(Vec3(2, 0, 4), r, slit) == doctest::Approx(whole).epsilon(1e-14));
}

TEST_CASE("the volume of a ball between walls: cut into thin slices, each a disc in a rectangle") {
  core::Random random(3);
  for (int n = 0; n < 30; ++n) {
    const Box box{Vec3::Zero(), sample::random_vector(random, 0.3, 2), {}};
    const Vec3 centre = sample::random_point(random, box);
    const double r = random.uniform(0.1, 1.6);
    // Height by height along z; in each the width along y over fine strips along x.
    const int steps = 200;
    const double low = std::max(box.lower.z(), centre.z() - r),
                 high = std::min(box.upper.z(), centre.z() + r);
    double volume = 0;
    for (int k = 0; k < steps; ++k) {
      const double z = low + (k + 0.5) * (high - low) / steps;
      const double rho = std::sqrt(std::max(0.0, r * r - (z - centre.z()) * (z - centre.z())));
      const double left = std::max(box.lower.x(), centre.x() - rho),
                   right = std::min(box.upper.x(), centre.x() + rho);
      for (int i = 0; i < steps; ++i) {
        const double x = left + (i + 0.5) * (right - left) / steps;
        const double half = std::sqrt(std::max(0.0, rho * rho - (x - centre.x()) * (x - centre.x())));
        const double width =
            std::min(box.upper.y(), centre.y() + half) - std::max(box.lower.y(), centre.y() - half);
        volume += width * (right - left) / steps * (high - low) / steps;
      }
    }
    CHECK(volume_in_box(centre, r, box) == doctest::Approx(volume).epsilon(2e-3));
  }
}

/// Sum over the bonds of what lies within r of a point, by fine sampling of each branch and all its images.
Mat3 sampled_moment(const Body& body, const Vec3& point, double r, int samples) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t b = 0; b < body.network.size(); ++b)
    for (int s = 0; s < samples; ++s) {
      const Vec3 place =
          body.particles.position[body.network.first[b]] + (s + 0.5) / samples * body.network.branch[b];
      if (body.box.minimum_image(place - point).norm() < r)
        sum += body.forces[b] * body.network.branch[b].transpose() / samples;
    }
  return sum;
}

TEST_CASE("each ball against fine sampling of every branch, and the centres counted") {
  for (const bool periodic : {false, true}) {
    const Box box{Vec3(-1, 2, 0), Vec3(1, 5, 1.5), {periodic, periodic, false}};
    const Body body = sample::random_body(box, 200, 0.45, 17);
    core::Random random(5);
    std::vector<Vec3> points;
    for (int n = 0; n < 12; ++n)
      points.push_back(sample::random_point(random, box));
    const double r = 0.6;
    const StressField field = Halo(points, r, box).estimate(body.particles, body.network, body.forces);
    for (std::size_t p = 0; p < points.size(); ++p) {
      // Each branch enters and leaves at most once: two samples misplaced.
      CHECK((field.volume[p] * field.stress[p] - sampled_moment(body, points[p], r, 500)).norm() <
            2.0 / 500 * body.moment_scale());
      std::size_t inside = 0;
      for (const Vec3& x : body.particles.position)
        inside += box.minimum_image(x - points[p]).norm() < r ? 1U : 0U;
      CHECK(field.particles[p] == inside);
    }
  }
}

TEST_CASE("a ball that holds the whole body has the stress of the body") {
  const Body body = sample::random_body(Box::cube(1, false), 300, 0.25, 7);
  const StressField ball =
      Halo({Vec3(0.2, 0.5, 0.9)}, 5, body.box).estimate(body.particles, body.network, body.forces);
  const StressField cell =
      stress::LoveWeber<>({body.box, {1, 1, 1}}).estimate(body.particles, body.network, body.forces);
  CHECK((ball.stress[0] - cell.stress[0]).norm() < 1e-12 * body.moment_scale());
  CHECK(ball.volume[0] == doctest::Approx(1));
  CHECK(ball.particles[0] == 300);
  CHECK(ball.outside == Mat3::Zero());
}

TEST_CASE("in a uniformly stressed lattice a ball of whole bonds has its stress") {
  // By the symmetry of the lattice a ball holds bonds in equal parts; the mean over many places tends to the stress.
  const Mat3 sigma = (Mat3() << 5, 1, 0, 1, -2, 0.5, 0, 0.5, 3).finished();
  const Body body = sample::stressed_lattice(8, 0.1, sigma);
  core::Random random(2);
  std::vector<Vec3> points;
  for (int n = 0; n < 1500; ++n)
    points.push_back(sample::random_point(random, body.box));
  const StressField field = Halo(points, 0.25, body.box).estimate(body.particles, body.network, body.forces);
  Mat3 mean = Mat3::Zero();
  for (const Mat3& stress : field.stress)
    mean += stress / 1500;
  CHECK((mean - sigma).norm() < 0.01 * sigma.norm());
}

TEST_CASE("the same bytes for any number of threads") {
  const Body body = sample::random_body(Box::cube(1, true), 500, 0.15, 41);
  core::Random random(5);
  std::vector<Vec3> points, moments;
  for (int n = 0; n < 300; ++n)
    points.push_back(sample::random_point(random, body.box));
  for (std::size_t b = 0; b < body.network.size(); ++b)
    moments.push_back(sample::random_vector(random, -1, 1));
  const Halo halo(points, 0.2, body.box);
  const StressField one = halo.estimate(body.particles, body.network, {body.forces, moments});
  for (const int threads : {2, 3, 5}) {
    core::ThreadPool pool(threads);
    CHECK(sample::same_bytes(one, halo.estimate(body.particles, body.network, {body.forces, moments}, pool)));
  }
}

TEST_CASE("no bond, no stress") {
  Body body;
  body.box = Box::cube(1, false);
  body.add_particle(Vec3(0.5, 0.5, 0.5), 0.1);
  const StressField field =
      Halo({Vec3(0.5, 0.5, 0.6)}, 0.2, body.box).estimate(body.particles, body.network, body.forces);
  CHECK(field.stress[0] == Mat3::Zero());
  CHECK(field.particles[0] == 1);
}

TEST_CASE("bad input is refused by name") {
  const Box box = Box::cube(1, false), periodic = Box::cube(1, true);
  const auto message = [](std::vector<Vec3> points, double radius, const Box& in) {
    return refusal([&] { Halo halo(std::move(points), radius, in); });
  };
  CHECK(message({Vec3(0, 0.5, 1)}, 0.2, box).empty());
  CHECK(contains(message({}, 0.2, box), "number of points = 0"));
  CHECK(contains(message({Vec3(0, 0, 0)}, 0, box), "radius of the balls = 0"));
  CHECK(contains(message({Vec3(0, 0, 0)}, sample::not_a_number, box), "radius of the balls = nan"));
  CHECK(contains(message({Vec3(0, 0, 0), Vec3(0, sample::infinity, 0)}, 1, box), "point 1 = 0 inf 0"));
  CHECK(contains(message({Vec3(0, 0, 1.1)}, 1, box), "coordinate z of point 0 = 1.1"));
  CHECK(contains(message({Vec3(0, 0, 1.1)}, 0.6, periodic), "radius of the balls = 0.6"));
  CHECK(contains(message({Vec3(0, 0, 0)}, 1, {Vec3(0, 0, 1), Vec3(1, 1, 1), {}}), "edge of the box along z"));

  const Body good = sample::random_body(periodic, 60, 0.4, 3);
  const auto estimate = [&](double radius, auto&& spoil) {
    Body body = good;
    spoil(body);
    return refusal([&] {
      (void)Halo({Vec3(0, 0, 0)}, radius, periodic).estimate(body.particles, body.network, body.forces);
    });
  };
  CHECK(estimate(0.25, [](Body&) {}).empty());
  CHECK(contains(estimate(0.45, [](Body&) {}), "radius and half the longest branch"));
  CHECK(contains(estimate(0.25, [](Body& b) { b.forces.pop_back(); }), "number of forces"));
  CHECK(contains(estimate(0.25, [](Body& b) { b.forces[4].y() = sample::not_a_number; }), "force of bond 4"));
  CHECK(contains(estimate(0.25, [](Body& b) { b.network.first[2] = 60; }), "first particle of bond 2 = 60"));
  CHECK(contains(estimate(0.25, [](Body& b) { b.particles.radius[1] = 0; }), "radius of particle 1 = 0"));
}

} // namespace
