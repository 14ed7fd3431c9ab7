#include <cdem/bond/beam.hpp>
#include <cdem/bond/bond_forces.hpp>
#include <cdem/bond/linear_forces.hpp>

#include <doctest/doctest.h>

#include <limits>

#include "body.hpp"
#include "laws.hpp"

namespace {

using namespace cdem;
using body::Body;
using body::contains;
using body::evaluated;
using body::gradient_error;
using body::SpatialField;
using bond::BondForces;

const bond::Beam<> beam({.materials = {{1, 0.6}, {30, 0.4}}});

/// Largest difference over the largest entry, forces and moments apart.
double difference(const SpatialField& a, const SpatialField& b) {
  double worst = 0;
  for (const int first : {0, 3}) {
    double apart = 0, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      for (int dof = first; dof < first + 3; ++dof) {
        apart = std::max(apart, std::abs(a[i][dof] - b[i][dof]));
        largest = std::max(largest, std::abs(b[i][dof]));
      }
    worst = std::max(worst, apart / largest);
  }
  return worst;
}

/// Everything that two kinds of forces say of the same body.
template <class Law>
void expect_linear_forces(const Law& law, double tolerance) {
  const Body random = body::random_body(3000, 5);
  const bond::LinearForces expected(beam, random.particles, random.network);
  const BondForces<Law> forces(law, random.particles, random.network);
  const SpatialField motion = body::random_motion(3000, 1, 6);
  core::ThreadPool pool;
  CHECK(difference(evaluated(forces, motion), evaluated(expected, motion)) < tolerance);
  CHECK(forces.elastic_energy(motion, pool) ==
        doctest::Approx(expected.elastic_energy(motion, pool)).epsilon(1e-13));
  std::vector<Vec3> found, moments, known;
  forces.bond_forces(motion, found, pool);
  forces.bond_moments(motion, moments, pool);
  expected.bond_forces(motion, known, pool);
  double worst = 0, block = 0;
  for (BondIndex b = 0; b < forces.bond_count(); b += 17) {
    const body::Vector12 loads = body::on_both_ends(expected.load(b, motion));
    worst = std::max(worst, (body::on_both_ends(forces.load(b, motion)) - loads).norm() / loads.norm());
    worst = std::max(worst, (found[b] - known[b]).norm() / known[b].norm());
    const auto ends = expected.load(b, motion);
    worst = std::max(worst, (moments[b] - 0.5 * (ends.moment_first - ends.moment_second)).norm() /
                                (ends.moment_first.norm() + ends.moment_second.norm()));
  }
  const auto tangent = forces.tangent(motion, pool);
  for (ParticleIndex i = 0; i < 3000; i += 100) {
    const auto known_block = expected.diagonal_block(i);
    block = std::max({block, (forces.diagonal_block(i) - known_block).norm() / known_block.norm(),
                      (tangent.diagonal_block(i) - known_block).norm() / known_block.norm()});
  }
  CHECK(worst < tolerance);
  CHECK(block < tolerance);
  CHECK(difference(evaluated(tangent, motion), evaluated(expected, motion)) < tolerance);
}

} // namespace

TEST_CASE("a beam gives what LinearForces gives") {
  expect_linear_forces(beam, 2e-14);
}
TEST_CASE("a beam written as its 12x12 matrix gives the same") {
  expect_linear_forces(laws::BlockBeam{beam}, 2e-13);
}
TEST_CASE("a beam given by its energy alone gives the same") {
  expect_linear_forces(laws::EnergyBeam{beam}, 2e-14);
}

TEST_CASE("any number of threads gives the same bytes, memory and losses included") {
  const Body random = body::random_body(7000, 8);
  const auto motion = [](std::uint64_t seed) { return body::random_motion(7000, 1, seed); };
  const auto run = [&](int threads) {
    core::ThreadPool pool(threads);
    BondForces<laws::Softening> forces(laws::Softening{beam}, random.particles, random.network);
    SpatialField force;
    for (std::uint64_t seed : {1u, 2u, 3u})
      forces.advance(motion(seed), force, pool);
    SpatialField tried;
    forces.evaluate(motion(4), tried, pool);
    return std::tuple(force, tried, forces.dissipated_energy(), forces.elastic_energy(motion(4), pool));
  };
  const auto one = run(1);
  for (const int threads : {2, 4}) {
    const auto more = run(threads);
    CHECK(body::same_bytes(std::get<0>(more), std::get<0>(one)));
    CHECK(body::same_bytes(std::get<1>(more), std::get<1>(one)));
    CHECK(std::get<2>(more) == std::get<2>(one));
    CHECK(std::get<3>(more) == std::get<3>(one));
  }
}

TEST_CASE("forces are minus the gradient of the energy, of laws that are not linear") {
  const Body random = body::random_body(40, 9);
  const SpatialField motion = body::random_motion(40, 0.3, 10);
  const BondForces<laws::Stiffening> stiffening(laws::Stiffening{beam}, random.particles, random.network);
  CHECK(gradient_error(stiffening, motion, 1e-5) < 1e-9);
  CHECK(difference(evaluated(stiffening, motion),
                   evaluated(BondForces<bond::Beam<>>(beam, random.particles, random.network), motion)) >
        0.05);

  // its tangent is the derivative of its forces
  core::ThreadPool pool;
  const auto tangent = stiffening.tangent(motion, pool);
  const SpatialField turn = body::random_motion(40, 1, 11);
  SpatialField ahead = motion, behind = motion;
  for (std::size_t i = 0; i < 40; ++i)
    for (int dof = 0; dof < 6; ++dof) {
      ahead[i][dof] += 1e-5 * turn[i][dof];
      behind[i][dof] -= 1e-5 * turn[i][dof];
    }
  const Eigen::VectorXd slope =
      (body::flat(evaluated(stiffening, ahead)) - body::flat(evaluated(stiffening, behind))) / 2e-5;
  const Eigen::VectorXd linear = body::flat(evaluated(tangent, turn));
  CHECK((slope - linear).norm() < 1e-8 * linear.norm());
  CHECK(tangent.elastic_energy(turn, pool) ==
        doctest::Approx(-0.5 * body::flat(turn).dot(linear)).epsilon(1e-12));
}

TEST_CASE("trying changes nothing, advancing does, and a memory brings it back") {
  const Body random = body::random_body(200, 12);
  core::ThreadPool pool;
  BondForces<laws::Softening> forces(laws::Softening{beam}, random.particles, random.network);
  const SpatialField small = body::random_motion(200, 0.1, 13), large = body::random_motion(200, 2, 14);
  SpatialField fresh, force, again;
  forces.evaluate(small, fresh, pool);
  forces.evaluate(large, force, pool);
  forces.evaluate(small, again, pool);
  CHECK(body::same_bytes(again, fresh));
  forces.advance(small, force, pool);
  const auto memory = forces.memory();
  const double lost = forces.dissipated_energy();
  forces.advance(large, force, pool);
  forces.evaluate(small, again, pool);
  CHECK_FALSE(body::same_bytes(again, fresh)); // softer
  CHECK(forces.dissipated_energy() != lost);
  forces.restore(memory);
  forces.evaluate(small, again, pool);
  CHECK(body::same_bytes(again, fresh));
  CHECK(forces.dissipated_energy() == lost);

  const Body other = body::random_body(100, 15);
  BondForces<laws::Softening> fewer(laws::Softening{beam}, other.particles, other.network);
  CHECK(
      contains(body::message_of([&] { fewer.restore(memory); }),
               "number of remembered bonds = " + std::to_string(random.network.size()) + " is not accepted"));
}

TEST_CASE("what a softening bond loses is the area between loading and unloading") {
  // one spring pulled to s and back to rest: K s^2/2 given along the falling stiffness, less what comes back
  const Body pair = body::row(2, Vec3::UnitX(), 1, 0.5);
  core::ThreadPool pool;
  BondForces<laws::Softening> forces(laws::Softening{beam}, pair.particles, pair.network);
  const double stiffness = beam.stiffness(bond::geometry_of(0, pair.particles, pair.network)).normal;
  SpatialField motion(2), force;
  const double peak = 0.4;
  const int steps = 1000;
  double work = 0, before = 0;
  for (int step = 1; step <= 2 * steps; ++step) {
    const double stretch = peak * (step <= steps ? step : 2 * steps - step) / steps;
    work += 0.5 * before * (stretch - motion[1][0]);
    motion[1][0] = stretch;
    forces.advance(motion, force, pool);
    before = -force[1][0];
    work += 0.5 * before * (stretch - peak * (step <= steps ? step - 1 : 2 * steps - step + 1) / steps);
  }
  // Softening: F = K s/(1 + m) at the largest stretch m so far; up: K (s - ln(1 + s)) given, down: K m^2/(2 (1 + m)) back
  const double exact = stiffness * (peak - std::log(1 + peak) - 0.5 * peak * peak / (1 + peak));
  CHECK(forces.dissipated_energy() == doctest::Approx(exact).epsilon(1e-5));
  CHECK(forces.dissipated_energy() == doctest::Approx(work).epsilon(1e-10));
}

TEST_CASE("parts that do not fit together, and matrices that are no stiffness, are refused") {
  Body three = body::row(3, Vec3(1, 2, 2) / 3, 1, 0.5);
  const auto message = [&](const auto& law) {
    return body::message_of([&] { BondForces forces(law, three.particles, three.network); });
  };
  SUBCASE("counts") {
    three.particles.resize(4);
    three.particles.radius[3] = 1;
    CHECK(contains(message(beam),
                   "particle_count of the network = 3 is not accepted: the number of particles, 4"));
  }
  SUBCASE("phase") {
    three.particles.phase[2] = 2;
    CHECK(contains(message(beam), "phase of particle 2 = 2"));
  }
  SUBCASE("order") {
    std::swap(three.network.first[1], three.network.second[1]);
    CHECK(contains(message(beam), "first particle of bond 1 = 2 is not accepted: bonds sorted by"));
  }
  SUBCASE("stiffness") {
    const laws::AnyChannels negative{{1, -2, 0, 0}};
    CHECK(contains(message(negative), "a stiffness of bond 0 = -2 is not accepted"));
  }
  const auto changed = [&](void (*change)(bond::Matrix12&)) {
    return message(laws::BlockBeam{beam, change});
  };
  const std::string name = "12x12 stiffness of the bond of particles 0 and 1 = ";
  SUBCASE("matrix") {
    CHECK(changed(nullptr) == "no InvalidInput thrown");
    CHECK(contains(changed([](bond::Matrix12& k) { k(3, 4) = std::numeric_limits<double>::quiet_NaN(); }),
                   name + "not finite"));
    CHECK(contains(changed([](bond::Matrix12& k) { k(0, 5) *= 1.1; }), "of it is not symmetric"));
    CHECK(contains(changed([](bond::Matrix12& k) { k(2, 2) *= 1.1; }), name + "resists a rigid motion"));
  }
}
