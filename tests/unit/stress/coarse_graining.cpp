// Coarse graining: kernels against quadrature, fields against brute force and what is conserved.

#include <cdem/stress/closure.hpp>
#include <cdem/stress/coarse_graining.hpp>
#include <cdem/stress/statistics.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using geometry::Box;
using sample::Body;
using sample::contains;
using sample::refusal;
using stress::CoarseGraining;
using stress::Gaussian;
using stress::Lucy;
using stress::StressField;
using stress::tessellation::Hexahedra;

/// Simpson's rule.
template <class Function>
double quadrature(double begin, double end, int intervals, Function&& function) {
  double sum = 0;
  for (int k = 0; k <= intervals; ++k)
    sum += (k == 0 || k == intervals ? 1
            : k % 2 == 1             ? 4
                                     : 2) *
           function(begin + k * (end - begin) / intervals);
  return sum * (end - begin) / intervals / 3;
}

template <class Kernel>
void check_kernel(const Kernel& kernel, double variance) {
  const double c = kernel.reach();
  const auto shell = [&](double power) {
    return quadrature(0, c * (1 - 1e-12), 5000, [&](double r) {
      return 4 * std::numbers::pi * std::pow(r, power) * kernel.density(r);
    });
  };
  CHECK(shell(2) == doctest::Approx(1).epsilon(1e-10));
  CHECK(shell(4) / 3 == doctest::Approx(variance).epsilon(1e-6)); // along an axis
  const double squares = quadrature(0, c * (1 - 1e-12), 5000, [&](double r) {
    return 4 * std::numbers::pi * r * r * kernel.density(r) * kernel.density(r);
  });
  CHECK(kernel.effective_volume() == doctest::Approx(1 / squares).epsilon(1e-9));
  CHECK(Kernel::of_volume(3e-9).effective_volume() == doctest::Approx(3e-9).epsilon(1e-12));

  core::Random random(1);
  for (int n = 0; n < 100; ++n) {
    const double b = n % 10 == 0 ? 0 : n % 10 == 1 ? 1e-9 * c : c * random.uniform(0, 1);
    const double chord = std::sqrt(c * c - b * b);
    double begin = random.uniform(-chord, chord), end = random.uniform(-chord, chord);
    if (begin > end)
      std::swap(begin, end);
    const auto phi = [&](double t) { return kernel.density(std::min(c, std::sqrt(b * b + t * t))); };
    const double scale = kernel.density(0) * c;
    const double whole = quadrature(begin, end, 2000, phi);
    const double first = quadrature(begin, end, 2000, [&](double t) { return t * phi(t); });
    CHECK(std::abs(kernel.integral(begin, end, b * b) - whole) < 1e-9 * scale);
    CHECK(std::abs(kernel.first_moment(begin, end, b * b) - first) < 1e-9 * scale * c);
  }
  // Short pieces too: no digits are lost that matter.
  CHECK(kernel.integral(0.3 * c, 0.3001 * c, 0.01 * c * c) ==
        doctest::Approx(1e-4 * c * kernel.density(c * std::sqrt(0.01 + 0.30005 * 0.30005))).epsilon(1e-7));
}

TEST_CASE("the kernels' integrals in closed form are those of quadrature") {
  check_kernel(Lucy(2.5), 2.5 * 2.5 / 12);
  check_kernel(Gaussian(0.4, 7), 0.4 * 0.4);
  CHECK(Gaussian(0.4, 9).effective_volume() ==
        doctest::Approx(8 * std::pow(std::numbers::pi, 1.5) * 0.064).epsilon(1e-12));
  CHECK(Gaussian::of_volume(2, 1.5).effective_volume() == doctest::Approx(2).epsilon(1e-12)); // cut or not
  CHECK(contains(refusal([] { (void)Lucy::of_volume(0); }), "effective volume of the kernel = 0"));
  CHECK(contains(refusal([] { (void)Gaussian::of_volume(-1); }), "effective volume of the kernel = -1"));
  // Cut at 2 widths the rest is scaled up.
  const Gaussian cut(0.4, 2);
  CHECK(cut.reach() == doctest::Approx(0.8));
  const double mass =
      quadrature(0, 0.8, 2000, [&](double r) { return 4 * std::numbers::pi * r * r * cut.density(r); });
  CHECK(mass == doctest::Approx(1).epsilon(1e-10));
}

/// Stress at a point by quadrature along every branch.
template <class Kernel>
Mat3 stress_by_quadrature(const Body& body, const Kernel& kernel, const Vec3& point) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t b = 0; b < body.network.size(); ++b) {
    const double weight = quadrature(0, 1, 300, [&](double s) {
      const Vec3 place = body.particles.position[body.network.first[b]] + s * body.network.branch[b];
      const double r = body.box.minimum_image(place - point).norm();
      return r < kernel.reach() ? kernel.density(r) : 0;
    });
    sum += weight * body.forces[b] * body.network.branch[b].transpose();
  }
  return sum;
}

TEST_CASE("stress at points against quadrature along every branch") {
  for (const bool periodic : {false, true}) {
    const Box box{Vec3(-1, 2, 0), Vec3(1, 4, 2), {periodic, false, periodic}};
    const Body body = sample::random_body(box, 150, 0.5, 17);
    core::Random random(5);
    std::vector<Vec3> points{Vec3(-1, 2, 0), body.particles.position[3]}; // a corner; a branch runs through
    for (int n = 0; n < 4; ++n)
      points.push_back(sample::random_point(random, box));
    const auto check = [&](const auto& kernel) {
      const CoarseGraining graining(points, kernel, box);
      const StressField field = graining.estimate(body.particles, body.network, body.forces);
      for (std::size_t p = 0; p < points.size(); ++p)
        CHECK((field.stress[p] - stress_by_quadrature(body, kernel, points[p])).norm() <
              1e-6 * body.moment_scale() * kernel.density(0));
    };
    check(Lucy(0.6));
    check(Gaussian(0.11));
  }
}

/// A body in the middle of a box, so that nothing is smeared out of it.
Body body_in_the_middle() {
  Body body = sample::random_body(Box{Vec3::Constant(0.3), Vec3::Constant(0.7), {}}, 100, 0.15, 9);
  body.box = Box::cube(1, false);
  return body;
}

TEST_CASE("on a grid the sum of V sigma is that of f (x) d, and of V rho the mass") {
  const Body body = body_in_the_middle();
  const auto inertia = particles::solid_spheres(body.particles, std::vector{2000.0});
  double mass = 0;
  for (const double m : inertia.mass)
    mass += m;
  core::ThreadPool pool(2);
  const auto check = [&](const auto& kernel, double tolerance) {
    const CoarseGraining graining(Hexahedra(body.box, {20, 20, 20}), kernel);
    const StressField field = graining.estimate(body.particles, body.network, body.forces, pool);
    CHECK((stress::moment_of_stress(field) - body.moment()).norm() < tolerance * body.moment_scale());
    const auto density = graining.spread(body.particles.position, inertia.mass, pool);
    double sum = 0;
    for (const double rho : density)
      sum += rho / (20.0 * 20 * 20);
    CHECK(sum == doctest::Approx(mass).epsilon(tolerance));
  };
  check(Lucy(0.25), 2e-4);
  check(Gaussian(0.05, 6), 1e-6); // the sum over a grid is as good as exact for smooth functions
}

TEST_CASE("a uniformly stressed lattice has its stress everywhere") {
  const Mat3 sigma = (Mat3() << 5, 1, 0, 1, -2, 0.5, 0, 0.5, 3).finished();
  const Body body = sample::stressed_lattice(9, 0.1, sigma);
  const CoarseGraining<Gaussian> graining(Hexahedra(body.box, {5, 4, 3}), Gaussian(0.07, 5.5));
  const StressField field = graining.estimate(body.particles, body.network, body.forces);
  // A lattice smeared by w = 0.7 spacings: waves of 2 exp(-2 pi^2 w^2/a^2), 1e-4 in each direction, are left.
  for (const Mat3& stress : field.stress)
    CHECK((stress - sigma).norm() < 5e-4 * sigma.norm());
  CHECK((stress::mean_stress(field) - sigma).norm() < 5e-4 * sigma.norm());
  CHECK(field.volume[0] == doctest::Approx(0.9 * 0.9 * 0.9 / 60));
}

TEST_CASE("one particle: its density is the kernel, its velocity its own") {
  Body body;
  body.box = Box::cube(1, false);
  body.add_particle(Vec3(0.5, 0.5, 0.5), 0.1);
  const particles::Inertia inertia{{3}, {1}};
  particles::SpatialField<> velocity(1);
  velocity[0].linear() = Vec3(1, -2, 4);
  const Lucy kernel(0.3);
  core::ThreadPool pool;
  const CoarseGraining<> graining({Vec3(0.5, 0.5, 0.7), Vec3(0.9, 0.9, 0.9)}, kernel, body.box);
  const auto motion = graining.motion(body.particles, inertia, velocity, pool);
  CHECK(motion.density[0] == doctest::Approx(3 * kernel.density(0.2)));
  CHECK((motion.velocity[0] - Vec3(1, -2, 4)).norm() < 1e-14);
  CHECK((motion.momentum[0] - 3 * kernel.density(0.2) * Vec3(1, -2, 4)).norm() < 1e-12);
  CHECK(motion.kinetic_stress[0].norm() < 1e-12);
  CHECK(motion.density[1] == 0);
  CHECK(motion.velocity[1] == Vec3::Zero());
  // 1/phi(0) is the volume of a point's surroundings.
  CHECK(graining.estimate(body.particles, body.network, body.forces).volume[0] ==
        doctest::Approx(1 / kernel.density(0)));
}

TEST_CASE("two particles that fly apart: the kinetic stress is a pressure along their line") {
  Body body;
  body.box = Box::cube(1, false);
  body.add_particle(Vec3(0.4, 0.5, 0.5), 0.1);
  body.add_particle(Vec3(0.6, 0.5, 0.5), 0.1);
  const particles::Inertia inertia{{3, 3}, {1, 1}};
  particles::SpatialField<> velocity(2);
  velocity[0].linear() = Vec3(-2, 7, 0);
  velocity[1].linear() = Vec3(2, 7, 0);
  const Lucy kernel(0.3);
  core::ThreadPool pool;
  const CoarseGraining<> graining({Vec3(0.5, 0.5, 0.5)}, kernel, body.box);
  const auto motion = graining.motion(body.particles, inertia, velocity, pool);
  Mat3 expected = Mat3::Zero();
  expected(0, 0) = -2 * 3 * kernel.density(0.1) * 4;
  CHECK((motion.kinetic_stress[0] - expected).norm() < 1e-12 * expected.norm());
  CHECK((motion.velocity[0] - Vec3(0, 7, 0)).norm() < 1e-14);
}

TEST_CASE("mass is conserved: the rate of density is minus the divergence of momentum") {
  const Body body = body_in_the_middle();
  const auto inertia = particles::solid_spheres(body.particles, std::vector{2000.0});
  core::Random random(4);
  particles::SpatialField<> velocity(body.particles.size());
  for (auto& v : velocity)
    v.linear() = sample::random_vector(random, -1, 1);
  const Vec3 point(0.45, 0.52, 0.58);
  const double h = 1e-3;
  core::ThreadPool pool;
  std::vector<Vec3> around;
  for (int k = 0; k < 3; ++k)
    for (const double way : {-1.0, 1.0})
      around.push_back(point + way * h * Vec3::Unit(k));
  const Gaussian kernel(0.06);
  const auto motion =
      CoarseGraining(around, kernel, body.box).motion(body.particles, inertia, velocity, pool);
  double divergence = 0;
  for (std::size_t k = 0; k < 3; ++k)
    divergence +=
        (motion.momentum[2 * k + 1] - motion.momentum[2 * k])[static_cast<Eigen::Index>(k)] / (2 * h);
  const auto density_after = [&](double time) {
    std::vector<Vec3> moved = body.particles.position;
    for (std::size_t i = 0; i < moved.size(); ++i)
      moved[i] += time * velocity[i].linear();
    return CoarseGraining({point}, kernel, body.box).spread(moved, inertia.mass, pool)[0];
  };
  const double rate = (density_after(h) - density_after(-h)) / (2 * h);
  CHECK(rate == doctest::Approx(-divergence).epsilon(1e-3));
}

TEST_CASE("the same bytes for any number of threads") {
  const Body body = sample::random_body(Box::cube(1, true), 500, 0.15, 41);
  core::Random random(5);
  std::vector<Vec3> moments;
  for (std::size_t b = 0; b < body.network.size(); ++b)
    moments.push_back(sample::random_vector(random, -1, 1));
  const CoarseGraining<> graining(Hexahedra(body.box, {7, 6, 5}), Lucy(0.2));
  const StressField one = graining.estimate(body.particles, body.network, {body.forces, moments});
  for (const int threads : {2, 3, 5}) {
    core::ThreadPool pool(threads);
    CHECK(sample::same_bytes(one,
                             graining.estimate(body.particles, body.network, {body.forces, moments}, pool)));
  }
}

TEST_CASE("bad input is refused by name") {
  CHECK(contains(refusal([] { Lucy kernel(0); }), "radius of the kernel = 0"));
  CHECK(contains(refusal([] { Gaussian kernel(-1); }), "width of the kernel = -1"));
  CHECK(contains(refusal([] { Gaussian kernel(1, 0.5); }), "cut-off of the kernel = 0.5"));
  const Box box = Box::cube(1, true);
  CHECK(contains(refusal([&] { CoarseGraining<> g({}, Lucy(0.1), box); }), "number of points = 0"));
  CHECK(contains(refusal([&] { CoarseGraining<> g({Vec3(0, sample::not_a_number, 0)}, Lucy(0.1), box); }),
                 "point 0 = 0 nan 0"));
  CHECK(contains(refusal([&] { CoarseGraining<> g({Vec3(0, 0, 0)}, Lucy(0.6), box); }),
                 "reach of the kernel = 0.6"));
  const Body body = sample::random_body(box, 60, 0.4, 3);
  const CoarseGraining<> graining({Vec3(0, 0, 0)}, Lucy(0.2), box);
  core::ThreadPool pool;
  CHECK(contains(
      refusal([&] { (void)graining.spread(body.particles.position, std::vector<double>(59), pool); }),
      "number of values = 59"));
  std::vector<Vec3> bad = body.particles.position;
  bad[7].x() = sample::infinity;
  CHECK(contains(refusal([&] { (void)graining.spread(bad, std::vector<double>(60), pool); }),
                 "position of particle 7"));
  const particles::Inertia inertia{std::vector<double>(60, 1), std::vector<double>(60, 1)};
  CHECK(contains(
      refusal([&] { (void)graining.motion(body.particles, inertia, particles::SpatialField<>(59), pool); }),
      "number of velocities = 59"));
  CHECK(
      contains(refusal([&] { (void)graining.estimate(body.particles, body.network, std::vector<Vec3>(3)); }),
               "number of forces = 3"));
}

} // namespace
