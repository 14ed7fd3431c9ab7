#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/bond/spring.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "body.hpp"

namespace {

using namespace cdem;
using body::Body;
using body::contains;
using body::SpatialField;
using bond::LinearForces;

const bond::Beam<> beam({.materials = {{1, 0.6}, {30, 0.4}}});

/// Sum over the bonds, from their single loads: what evaluate() must give, in another order of the sums.
Eigen::VectorXd sum_of_loads(const LinearForces& forces, const SpatialField& motion) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(motion.size()));
  for (BondIndex b = 0; b < forces.bond_count(); ++b) {
    const body::Vector12 loads = body::on_both_ends(forces.load(b, motion));
    const auto [i, j] = forces.ends(b);
    sum.segment<6>(6 * static_cast<Eigen::Index>(i)) += loads.head<6>();
    sum.segment<6>(6 * static_cast<Eigen::Index>(j)) += loads.tail<6>();
  }
  return sum;
}

SpatialField evaluated(const LinearForces& forces, const SpatialField& motion, int threads = 1) {
  core::ThreadPool pool(threads);
  SpatialField force(motion.size(), [] { // overwritten, whatever was there
    particles::Spatial<> rubbish;
    for (int dof = 0; dof < 6; ++dof)
      rubbish[dof] = std::numeric_limits<double>::quiet_NaN();
    return rubbish;
  }());
  forces.evaluate(motion, force, pool);
  return force;
}

/// A random body big enough for several blocks of a parallel loop.
const Body& large_body() {
  static const Body body = body::random_body(7000, 8);
  return body;
}

} // namespace

TEST_CASE("the force on each particle is the sum of its bonds' loads") {
  for (const std::size_t count : {1u, 2u, 3u, 70u, 700u, 7000u}) {
    const Body random = count == 7000 ? large_body() : body::random_body(count, count);
    const LinearForces forces(beam, random.particles, random.network);
    const SpatialField motion = body::random_motion(count, 1, 9);
    const SpatialField force = evaluated(forces, motion);
    const Eigen::VectorXd expected = sum_of_loads(forces, motion);
    CHECK((body::flat(force) - expected).lpNorm<Eigen::Infinity>() <=
          1e-13 * expected.lpNorm<Eigen::Infinity>());
    double padding = 0;
    for (const auto& spatial : force)
      padding = std::max({padding, std::abs(spatial.component[3]), std::abs(spatial.component[7])});
    CHECK(padding == 0);
  }
}

TEST_CASE("any number of threads gives the same bytes") {
  const Body& random = large_body();
  const LinearForces forces(beam, random.particles, random.network);
  const SpatialField motion = body::random_motion(random.particles.size(), 1, 10);
  const SpatialField serial = evaluated(forces, motion, 1);
  for (const int threads : {2, 3, 4})
    CHECK(body::same_bytes(evaluated(forces, motion, threads), serial));
  core::ThreadPool one(1), three(3);
  CHECK(forces.elastic_energy(motion, three) == forces.elastic_energy(motion, one));
}

TEST_CASE("forces handed on block by block are those of the field, each particle once, sums in block order") {
  const Body& random = large_body();
  const LinearForces forces(beam, random.particles, random.network);
  const SpatialField motion = body::random_motion(random.particles.size(), 1, 24);
  const SpatialField expected = evaluated(forces, motion);
  double one_thread = 0;
  for (const int threads : {1, 2, 3}) {
    core::ThreadPool pool(threads);
    SpatialField found(motion.size());
    std::vector<int> visits(motion.size(), 0);
    const double sum = forces.evaluate_blockwise(
        motion, 0.0, pool, [&](std::size_t begin, std::size_t end, const particles::Spatial<>* force) {
          double part = 0;
          for (std::size_t i = begin; i < end; ++i) {
            found[i] = force[i - begin];
            part += force[i - begin].linear().norm();
            ++visits[i];
          }
          return part;
        });
    CHECK(body::same_bytes(found, expected));
    CHECK(std::count(visits.begin(), visits.end(), 1) == static_cast<std::ptrdiff_t>(visits.size()));
    if (threads == 1)
      one_thread = sum;
    CHECK(sum == one_thread);
  }
}

TEST_CASE("rigid motions give no force") {
  const Body random = body::random_body(500, 11);
  const LinearForces forces(beam, random.particles, random.network);
  const SpatialField motion = body::rigid_motion(random.particles, Vec3(1, -2, 0.5), Vec3(0.3, 0.1, -0.2));
  const double scale =
      body::flat(evaluated(forces, body::random_motion(500, 1, 12))).lpNorm<Eigen::Infinity>();
  CHECK(body::flat(evaluated(forces, motion)).lpNorm<Eigen::Infinity>() < 1e-13 * scale);
}

TEST_CASE("forces and moments sum to zero over a free body") {
  const Body random = body::random_body(500, 13);
  const LinearForces forces(beam, random.particles, random.network);
  const SpatialField force = evaluated(forces, body::random_motion(500, 1, 14));
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  double scale = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    sum += force[i].linear();
    moment += force[i].angular() + random.particles.position[i].cross(force[i].linear());
    scale += force[i].linear().norm();
  }
  CHECK(sum.norm() < 1e-13 * scale);
  CHECK(moment.norm() < 1e-13 * scale);
}

TEST_CASE("the stiffness is symmetric and positive but for six rigid motions") {
  const Body random = body::random_body(40, 15);
  const LinearForces forces(beam, random.particles, random.network);
  const Eigen::MatrixXd stiffness = body::dense_stiffness(forces);
  const double scale = stiffness.lpNorm<Eigen::Infinity>();
  CHECK((stiffness - stiffness.transpose()).lpNorm<Eigen::Infinity>() < 1e-14 * scale);
  // pieces of the body that no bond joins move freely, each in six ways
  std::vector<std::size_t> piece(40);
  std::iota(piece.begin(), piece.end(), std::size_t{0});
  for (std::size_t pass = 0; pass < 40; ++pass)
    for (BondIndex b = 0; b < forces.bond_count(); ++b) {
      const auto [i, j] = forces.ends(b);
      piece[i] = piece[j] = std::min(piece[i], piece[j]);
    }
  Eigen::Index pieces = 0;
  for (std::size_t i = 0; i < 40; ++i)
    pieces += piece[i] == i;
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues();
  CHECK(values.head(6 * pieces).lpNorm<Eigen::Infinity>() < 1e-13 * values.maxCoeff());
  CHECK(values[6 * pieces] > 1e-9 * values.maxCoeff());
}

TEST_CASE("the energy is u.Ku/2, and the forces minus its gradient") {
  const Body random = body::random_body(30, 16);
  const LinearForces forces(beam, random.particles, random.network);
  core::ThreadPool pool;
  SpatialField motion = body::random_motion(30, 1, 17);
  const SpatialField force = evaluated(forces, motion);
  const double energy = forces.elastic_energy(motion, pool);
  CHECK(energy > 0);
  CHECK(energy == doctest::Approx(-0.5 * body::flat(motion).dot(body::flat(force))).epsilon(1e-13));
  double worst = 0;
  for (auto [i, dof] : {std::pair{0u, 0}, {3u, 4}, {17u, 2}, {29u, 5}}) {
    motion[i][dof] += 0.5; // quadratic: central differences are exact but for rounding
    const double after = forces.elastic_energy(motion, pool);
    motion[i][dof] -= 1;
    const double before = forces.elastic_energy(motion, pool);
    motion[i][dof] += 0.5;
    worst = std::max(worst, std::abs(before - after - force[i][dof]));
  }
  CHECK(worst < 1e-13 * energy);
}

TEST_CASE("the diagonal blocks are those of the assembled stiffness") {
  const Body random = body::random_body(40, 18);
  const LinearForces forces(beam, random.particles, random.network);
  const Eigen::MatrixXd stiffness = body::dense_stiffness(forces);
  double worst = 0;
  for (ParticleIndex i = 0; i < 40; ++i)
    worst = std::max(
        worst, (forces.diagonal_block(i) - stiffness.block<6, 6>(6 * i, 6 * i)).lpNorm<Eigen::Infinity>());
  CHECK(worst < 1e-14 * stiffness.lpNorm<Eigen::Infinity>());
}

TEST_CASE("bonds keep the numbers of the network, and each is listed at both its ends") {
  const Body random = body::random_body(300, 19);
  const LinearForces forces(beam, random.particles, random.network);
  REQUIRE(forces.bond_count() == random.network.size());
  CHECK(forces.particle_count() == 300);
  std::vector<int> listed(forces.bond_count(), 0);
  for (ParticleIndex i = 0; i < 300; ++i) {
    BondIndex previous = 0;
    for (const BondIndex b : forces.bonds_of(i)) {
      const auto [first, second] = forces.ends(b);
      CHECK((first == i || second == i));
      CHECK(b >= previous);
      previous = b;
      ++listed[b];
    }
  }
  for (BondIndex b = 0; b < forces.bond_count(); ++b) {
    CHECK(listed[b] == 2);
    CHECK(forces.ends(b) == std::pair(random.network.first[b], random.network.second[b]));
    CHECK(forces.length(b) == doctest::Approx(random.network.branch[b].norm()).epsilon(1e-15));
    CHECK((forces.length(b) * forces.direction(b) - random.network.branch[b]).norm() < 1e-15);
    const auto expected = beam.stiffness(bond::geometry_of(b, random.particles, random.network));
    const auto found = forces.stiffness(b); // kept as differences over squared lengths: a few roundings away
    CHECK(found.normal == doctest::Approx(expected.normal).epsilon(4e-15));
    CHECK(found.tangential == expected.tangential);
    CHECK(found.torsion == doctest::Approx(expected.torsion).epsilon(4e-15));
    CHECK(found.bending == expected.bending);
  }
}

TEST_CASE("the bond forces are those of the single loads") {
  const Body random = body::random_body(300, 20);
  const LinearForces forces(beam, random.particles, random.network);
  const SpatialField motion = body::random_motion(300, 1, 21);
  core::ThreadPool pool(2);
  std::vector<Vec3> found(3, Vec3::Ones()); // overwritten and resized
  forces.bond_forces(motion, found, pool);
  REQUIRE(found.size() == forces.bond_count());
  for (BondIndex b = 0; b < found.size(); ++b)
    CHECK(found[b] == forces.load(b, motion).force);
}

TEST_CASE("a body without bonds has no forces") {
  Body loose = body::random_body(10, 22);
  loose.network.first.clear();
  loose.network.second.clear();
  loose.network.branch.clear();
  const LinearForces forces(beam, loose.particles, loose.network);
  CHECK(forces.bond_count() == 0);
  CHECK(body::flat(evaluated(forces, body::random_motion(10, 1, 23))).norm() == 0);
  CHECK(forces.diagonal_block(3).norm() == 0);
}

namespace {

/// A law whose fourth bond has the stiffness it is told.
struct Doubtful {
  double value;
  bond::ChannelStiffness stiffness(const bond::BondGeometry& geometry) const {
    return {1, geometry.radius_first > 0.9 ? value : 1, 1, 1};
  }
  void validate(const particles::ParticleSet&) const {}
};

} // namespace

TEST_CASE("parts that do not fit together, and laws gone wrong, are refused") {
  Body three = body::row(6, Vec3::UnitX(), 1, 0.5);
  const auto message = [&](const auto& law) {
    return body::message_of([&] { LinearForces forces(law, three.particles, three.network); });
  };
  SUBCASE("counts") {
    three.particles.resize(7);
    three.particles.radius[6] = 1;
    CHECK(contains(message(beam),
                   "particle_count of the network = 6 is not accepted: the number of particles, 7"));
  }
  SUBCASE("no particles") {
    three = {};
    CHECK(contains(message(beam), "number of particles = 0 is not accepted"));
  }
  SUBCASE("radius") {
    three.particles.radius[2] = -1;
    CHECK(contains(message(beam), "radius of particle 2 = -1"));
  }
  SUBCASE("ends") {
    three.network.second[1] = 6;
    CHECK(contains(message(beam), "second particle of bond 1 = 6"));
  }
  SUBCASE("bond with itself") {
    three.network.second[1] = three.network.first[1];
    CHECK(contains(message(beam), "second particle of bond 1 = 1"));
  }
  SUBCASE("length") {
    three.network.branch[4].setZero();
    CHECK(contains(message(beam), "length of bond 4 = 0"));
  }
  SUBCASE("order") {
    std::swap(three.network.first[2], three.network.second[2]);
    CHECK(contains(message(beam), "first particle of bond 2 = 3 is not accepted: bonds sorted by"));
    std::swap(three.network.first[2], three.network.second[2]);
    std::swap(three.network.first[3], three.network.first[1]);
    std::swap(three.network.second[3], three.network.second[1]);
    CHECK(contains(message(beam), "first particle of bond 2 = 2 is not accepted: bonds sorted by"));
  }
  SUBCASE("phase") {
    three.particles.phase[5] = 2;
    CHECK(contains(message(beam), "phase of particle 5 = 2"));
  }
  SUBCASE("stiffness") {
    three.particles.radius[3] = 1;
    CHECK(contains(message(Doubtful{-1}), "a stiffness of bond 3 = -1 is not accepted"));
    CHECK(
        contains(message(Doubtful{std::numeric_limits<double>::quiet_NaN()}), "a stiffness of bond 3 = nan"));
    CHECK(
        contains(message(Doubtful{std::numeric_limits<double>::infinity()}), "a stiffness of bond 3 = inf"));
    CHECK(message(Doubtful{0}) == "no InvalidInput thrown");
  }
}
