#include <cdem/stress/closure.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/statistics.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using geometry::Box;
using sample::Body;
using sample::contains;
using sample::not_a_number;
using sample::random_body;
using sample::refusal;
using sample::same_bytes;
using stress::LoveWeber;
using stress::Outside;
using stress::Sharing;
using stress::StressField;
using stress::tessellation::Hexahedra;

StressField estimate(const Body& body, const Hexahedra& grid, LoveWeber<>::Parameters parameters = {}) {
  return LoveWeber<>(grid, parameters).estimate(body.particles, body.network, body.forces);
}

/// A tensor without any symmetry, so that an exchange of row and column is seen.
const Mat3 any_stress = (Mat3() << 3, -1, 0.5, 2, -4, 0.25, 1.5, -0.75, 7).finished();

TEST_CASE("a bond in tension gives a positive stress f (x) d / V, row = force") {
  Body body;
  body.box = Box::cube(2, false);
  body.add_particle(Vec3(0.5, 1, 1), 0.1);
  body.add_particle(Vec3(1.5, 1, 1), 0.1);
  body.add_bond(0, 1, Vec3(3, 0, 5)); // the first particle is pulled along the branch
  const StressField field = estimate(body, Hexahedra(body.box, {1, 1, 1}));
  REQUIRE(field.size() == 1);
  Mat3 expected = Mat3::Zero();
  expected(0, 0) = 3.0 / 8;
  expected(2, 0) = 5.0 / 8; // force along z, branch along x
  CHECK(field.stress[0] == expected);
  CHECK(field.volume[0] == 8);
  CHECK(field.particles[0] == 2);
  CHECK(field.outside == Mat3::Zero());
}

TEST_CASE("a lattice under a uniform stress has that stress in every specimen") {
  const Body body = sample::stressed_lattice(12, 0.1, any_stress);
  for (const auto& counts : std::vector<Hexahedra::Counts>{{1, 1, 1}, {12, 12, 12}, {3, 4, 2}, {6, 1, 12}})
    for (const Sharing sharing : {Sharing::by_length, Sharing::by_midpoint}) {
      if (sharing == Sharing::by_midpoint && counts[0] != 1)
        continue; // contact points lie on the specimens' faces
      const StressField field = estimate(body, Hexahedra(body.box, counts), {sharing, Outside::refuse});
      for (std::size_t cell = 0; cell < field.size(); ++cell) {
        CHECK((field.stress[cell] - any_stress).norm() < 1e-12 * any_stress.norm());
        CHECK(field.particles[cell] == 1728 / field.size());
      }
    }
}

TEST_CASE("sharing by length is exact where the paper's rule counts whole contacts") {
  // Ten bonds in a row under the force F = A sigma, three specimens: 10/3 bonds each, of which contact points see
  // 3, 4 and 3. So the paper's rule prints 0.9, 1.2 and 0.9 of the stress.
  Body body;
  body.box = Box{Vec3(0, -0.5, -0.5), Vec3(10, 0.5, 0.5), {}};
  for (int i = 0; i <= 10; ++i)
    body.add_particle(Vec3(i, 0, 0), 0.5);
  for (std::size_t i = 0; i < 10; ++i)
    body.add_bond(i, i + 1, Vec3(7, 0, 0));
  const Hexahedra grid(body.box, {3, 1, 1});
  const StressField by_length = estimate(body, grid);
  const StressField by_midpoint = estimate(body, grid, {Sharing::by_midpoint, Outside::refuse});
  const double counted[] = {0.9, 1.2, 0.9};
  for (std::size_t cell = 0; cell < 3; ++cell) {
    CHECK(by_length.stress[cell](0, 0) == doctest::Approx(7).epsilon(1e-14));
    CHECK(by_midpoint.stress[cell](0, 0) == doctest::Approx(7 * counted[cell]).epsilon(1e-14));
  }
}

TEST_CASE("the contact point is in the middle of the gap between the spheres") {
  Body body;
  body.box = Box::cube(1, false);
  body.add_particle(Vec3(0.1, 0.5, 0.5), 0.4);
  body.add_particle(Vec3(0.8, 0.5, 0.5),
                    0.1); // gap 0.2, its middle at 0.1 + 0.4 + 0.1 = 0.6; the branch's at 0.45
  body.add_bond(0, 1, Vec3(1, 2, 3));
  const Mat3 whole = Vec3(1, 2, 3) * Vec3(0.7, 0, 0).transpose();
  const auto low_share = [&](int cells_to_the_left, int cells) {
    const StressField field =
        estimate(body, Hexahedra(body.box, {cells, 1, 1}), {Sharing::by_midpoint, Outside::refuse});
    Mat3 sum = Mat3::Zero();
    for (std::size_t cell = 0; cell < static_cast<std::size_t>(cells_to_the_left); ++cell)
      sum += field.volume[cell] * field.stress[cell];
    return sum;
  };
  CHECK(low_share(59, 100).norm() == 0);
  CHECK((low_share(61, 100) - whole).norm() < 1e-14);
  // A sphere within the other: the contact point stays on the branch.
  body.particles.radius = {0.9, 0.1};
  CHECK(low_share(79, 100).norm() == 0);
  CHECK((low_share(81, 100) - whole).norm() < 1e-14);
}

TEST_CASE("the specimens' V sigma add up to the bonds' f (x) d on any grid") {
  for (const bool periodic : {false, true}) {
    const Box box{Vec3(-1, 2, 0), Vec3(1, 5, 1), {periodic, periodic, false}};
    const Body body = random_body(box, 600, 0.35, 17);
    REQUIRE(body.network.size() > 2000);
    for (const auto& counts : std::vector<Hexahedra::Counts>{{1, 1, 1}, {2, 3, 1}, {7, 11, 5}, {40, 30, 20}})
      for (const Sharing sharing : {Sharing::by_length, Sharing::by_midpoint}) {
        const StressField field = estimate(body, Hexahedra(box, counts), {sharing, Outside::refuse});
        CHECK((stress::moment_of_stress(field) - body.moment()).norm() < 1e-13 * body.moment_scale());
        CHECK(field.outside == Mat3::Zero());
        CHECK(std::accumulate(field.particles.begin(), field.particles.end(), 0u) == 600);
      }
  }
}

TEST_CASE("an affine network: each specimen's stress against fine sampling of every branch") {
  const Box box = Box::cube(1, true);
  Body body = random_body(box, 150, 0.25, 23);
  const Mat3 strain = (Mat3() << 1, 0.3, 0, 0.3, -0.2, 0.1, 0, 0.1, -0.3).finished();
  for (std::size_t b = 0; b < body.network.size(); ++b) {
    const Vec3 normal = body.network.branch[b].normalized();
    body.forces[b] = 5 * normal.dot(strain * body.network.branch[b]) * normal;
  }
  const Hexahedra grid(box, {3, 2, 4});
  const StressField field = estimate(body, grid);
  constexpr int samples = 2000;
  std::vector<Mat3> sampled(grid.cell_count(), Mat3::Zero());
  for (std::size_t b = 0; b < body.network.size(); ++b)
    for (int s = 0; s < samples; ++s) {
      const Vec3 point = box.wrap(body.particles.position[body.network.first[b]] +
                                  (s + 0.5) / samples * body.network.branch[b]);
      const auto along = [&](int axis, int n) {
        return static_cast<std::size_t>(std::floor(n * point[axis]));
      };
      sampled[along(0, 3) + 3 * (along(1, 2) + 2 * along(2, 4))] +=
          body.forces[b] * body.network.branch[b].transpose() / samples * 24;
    }
  // A branch crosses at most a few faces, each misplaced by at most one sample.
  for (std::size_t cell = 0; cell < field.size(); ++cell) {
    CHECK((field.stress[cell] - sampled[cell]).norm() < 24 * body.moment_scale() / samples);
    // Central springs: the stress is symmetric.
    CHECK((field.stress[cell] - field.stress[cell].transpose()).norm() < 1e-13 * field.stress[cell].norm());
  }
}

TEST_CASE("turning everything by 90 degrees turns the tensors") {
  const Box box{Vec3(-1, -1.5, -0.5), Vec3(1, 1.5, 0.5), {}};
  const Body body = random_body(box, 300, 0.4, 31);
  const StressField field = estimate(body, Hexahedra(box, {3, 4, 2}));
  const Mat3 turn = (Mat3() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished(); // about z
  Body turned = body;
  turned.box = Box{Vec3(-1.5, -1, -0.5), Vec3(1.5, 1, 0.5), {}};
  for (Vec3& x : turned.particles.position)
    x = turn * x;
  for (Vec3& d : turned.network.branch)
    d = turn * d;
  for (Vec3& f : turned.forces)
    f = turn * f;
  const Hexahedra grid(box, {3, 4, 2}), turned_grid(turned.box, {4, 3, 2});
  const StressField turned_field = estimate(turned, turned_grid);
  for (std::size_t cell = 0; cell < field.size(); ++cell) {
    const auto image = turned_grid.locate(turn * grid.centre(cell));
    REQUIRE(image);
    CHECK((turned_field.stress[*image] - turn * field.stress[cell] * turn.transpose()).norm() < 1e-11);
    CHECK(turned_field.particles[*image] == field.particles[cell]);
  }
}

TEST_CASE("a branch through a periodic face goes on at the other side") {
  Body body;
  body.box = Box::cube(1, true);
  body.add_particle(Vec3(0.95, 0.5, 0.5), 0.05);
  body.add_particle(Vec3(0.25, 0.5, 0.5), 0.05);
  body.add_bond(0, 1, Vec3(2, 0, 0));
  REQUIRE(body.network.branch[0].x() == doctest::Approx(0.3));
  const StressField field = estimate(body, Hexahedra(body.box, {10, 1, 1}));
  const double inside[] = {0.1, 0.1, 0.05, 0, 0, 0, 0, 0, 0, 0.05};
  for (std::size_t cell = 0; cell < 10; ++cell)
    CHECK(field.stress[cell](0, 0) == doctest::Approx(2 * inside[cell] / 0.1).epsilon(1e-12));
  CHECK(field.particles[9] == 1);
  CHECK(field.particles[2] == 1);
}

TEST_CASE("what lies outside is reported, not lost") {
  const Box box = Box::cube(1, false);
  const Body body = random_body(box, 400, 0.2, 41);
  const Box window{Vec3::Constant(0.2), Vec3::Constant(0.7), {}};
  const Hexahedra grid(window, {2, 2, 2});
  for (const Sharing sharing : {Sharing::by_length, Sharing::by_midpoint}) {
    const StressField field = estimate(body, grid, {sharing, Outside::report});
    CHECK(field.outside.norm() > 0);
    CHECK((stress::moment_of_stress(field) + field.outside - body.moment()).norm() <
          1e-13 * body.moment_scale());
    // A cell of the window holds 125 cells of a grid over the whole body: the same moments.
    const Hexahedra fine(box, {20, 20, 20});
    const StressField all = estimate(body, fine, {sharing, Outside::refuse});
    std::vector<Mat3> moment(8, Mat3::Zero());
    for (std::size_t part = 0; part < fine.cell_count(); ++part)
      if (const auto cell = grid.locate(fine.centre(part)))
        moment[*cell] += all.volume[part] * all.stress[part];
    for (std::size_t cell = 0; cell < 8; ++cell)
      CHECK((field.volume[cell] * field.stress[cell] - moment[cell]).norm() < 1e-12 * body.moment_scale());
  }
}

TEST_CASE("the same bytes for any number of threads and whatever the rounds") {
  // More bonds than a round holds (131,072), on a grid fine enough for threads to own neighbouring cells.
  Body body = random_body(Box::cube(1, true), 1500, 0.16, 7);
  const network::BondNetwork once = body.network;
  const std::vector<Vec3> forces = body.forces;
  core::Random random(9);
  while (body.network.size() < 150'000)
    for (std::size_t b = 0; b < once.size(); ++b) {
      body.network.first.push_back(once.first[b]);
      body.network.second.push_back(once.second[b]);
      body.network.branch.push_back(once.branch[b]);
      body.forces.push_back(sample::random_vector(random, -1, 1));
    }
  for (const Sharing sharing : {Sharing::by_length, Sharing::by_midpoint}) {
    const LoveWeber<> estimator(Hexahedra(body.box, {9, 7, 8}), {sharing, Outside::refuse});
    const StressField one = estimator.estimate(body.particles, body.network, body.forces);
    CHECK((stress::moment_of_stress(one) - body.moment()).norm() < 1e-13 * body.moment_scale());
    for (const int threads : {1, 2, 3, 5}) {
      core::ThreadPool pool(threads);
      CHECK(same_bytes(one, estimator.estimate(body.particles, body.network, body.forces, pool)));
    }
  }
}

TEST_CASE("no bond, no stress") {
  Body body;
  body.box = Box::cube(1, false);
  body.add_particle(Vec3(0.5, 0.5, 0.5), 0.1);
  const StressField field = estimate(body, Hexahedra(body.box, {2, 2, 2}));
  for (const Mat3& stress : field.stress)
    CHECK(stress == Mat3::Zero());
}

/// A tessellation of the user's own, of one cell without bounds.
struct OneCell {
  std::size_t cells = 1;
  double cell_volume = 1;
  std::size_t cell_count() const { return cells; }
  double volume(std::size_t) const { return cell_volume; }
  std::optional<std::size_t> locate(const Vec3&) const { return 0; }
  template <class Callback>
  double for_each_piece(const geometry::Segment&, Callback&& callback) const {
    callback(std::size_t{0}, 0.0, 1.0);
    return 0;
  }
};

TEST_CASE("a tessellation of the user's own") {
  const Body body = random_body(Box::cube(1, false), 50, 0.4, 2);
  const StressField field =
      LoveWeber<OneCell>(OneCell{1, 2.5}).estimate(body.particles, body.network, body.forces);
  CHECK((2.5 * field.stress[0] - body.moment()).norm() < 1e-13 * body.moment_scale());

  CHECK(contains(refusal([] { LoveWeber<OneCell>(OneCell{0, 1}); }), "number of specimens = 0"));
  CHECK(contains(refusal([] { LoveWeber<OneCell>(OneCell{1, 0}); }), "volume of specimen 0 = 0"));
  CHECK(contains(refusal([] { LoveWeber<OneCell>(OneCell{1, -1}); }), "volume of specimen 0 = -1"));
  CHECK(contains(refusal([] {
                   LoveWeber<OneCell>(OneCell{1, not_a_number});
                 }),
                 "volume of specimen 0 = nan"));
}

TEST_CASE("bad input is refused by name") {
  const Body good = random_body(Box::cube(1, false), 60, 0.4, 3);
  const LoveWeber<> estimator(Hexahedra(good.box, {2, 2, 2}));
  const auto message = [&](auto&& spoil) {
    Body body = good;
    spoil(body);
    return refusal([&] { (void)estimator.estimate(body.particles, body.network, body.forces); });
  };
  CHECK(message([](Body&) {}).empty());
  CHECK(contains(message([](Body& b) { b.forces.pop_back(); }), "number of forces"));
  CHECK(contains(message([](Body& b) { b.forces[4].y() = not_a_number; }), "force of bond 4"));
  CHECK(contains(message([](Body& b) { b.forces[5].x() = sample::infinity; }), "force of bond 5"));
  CHECK(contains(message([](Body& b) { b.network.branch.pop_back(); }), "number of bonds"));
  CHECK(contains(message([](Body& b) { b.network.particle_count = 59; }),
                 "number of particles of the network = 59"));
  CHECK(contains(message([](Body& b) { b.network.first[2] = 60; }), "first particle of bond 2 = 60"));
  CHECK(contains(message([](Body& b) { b.network.second[2] = 99; }), "second particle of bond 2 = 99"));
  CHECK(contains(message([](Body& b) { b.network.branch[3].setZero(); }), "branch of bond 3"));
  CHECK(contains(message([](Body& b) { b.network.branch[3].z() = not_a_number; }), "branch of bond 3"));
  CHECK(
      contains(message([](Body& b) { b.particles.position[7].x() = 1.2; }), "position of particle 7 = 1.2"));
  CHECK(contains(message([](Body& b) { b.particles.position[7].x() = not_a_number; }),
                 "position x of particle 7 = nan"));
  CHECK(contains(message([](Body& b) { b.particles.radius[1] = 0; }), "radius of particle 1 = 0"));
  CHECK(contains(message([](Body& b) { b = Body{}; }), "number of particles = 0"));
  // Periodic bonds in a box that is not: the branch leaves through a wall.
  CHECK(contains(message([](Body& b) { b.network.branch[6] = Vec3(2, 0, 0); }),
                 "part outside the tessellation of bond 6"));
  // The first of several, whatever the threads.
  Body body = good;
  for (std::size_t b = 10; b < body.forces.size(); ++b)
    body.forces[b].x() = not_a_number;
  core::ThreadPool pool(3);
  CHECK(contains(refusal([&] { (void)estimator.estimate(body.particles, body.network, body.forces, pool); }),
                 "force of bond 10 "));
}

} // namespace
