// What the stored precision costs, and that the kernels of different processors agree.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "body.hpp"

namespace {

using namespace cdem;
using body::Body;
using body::SpatialField;
using bond::CompactLinearForces;
using bond::LinearForces;
using bond::detail::BondRecord;

const bond::Beam<> beam({.materials = {{2536e9, 0.545}, {12020e9, 0.169}}});

const Body& millimetre_body() {
  static const Body body = body::random_body(7000, 31, 1e-3);
  return body;
}

template <class Forces>
SpatialField evaluated(const Forces& forces, const SpatialField& motion, int threads = 1) {
  core::ThreadPool pool(threads);
  SpatialField force(motion.size());
  forces.evaluate(motion, force, pool);
  return force;
}

/// Root mean square of the force (first) and the moment (second) on a particle.
std::pair<double, double> size_of(const SpatialField& field) {
  double force = 0, moment = 0;
  for (const auto& spatial : field) {
    force += spatial.linear().squaredNorm();
    moment += spatial.angular().squaredNorm();
  }
  const auto count = static_cast<double>(field.size());
  return {std::sqrt(force / count), std::sqrt(moment / count)};
}

SpatialField difference(const SpatialField& a, const SpatialField& b) {
  SpatialField result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int dof = 0; dof < 6; ++dof)
      result[i][dof] = a[i][dof] - b[i][dof];
  return result;
}

} // namespace

TEST_CASE("stiffnesses stored in float change the forces by the rounding of a float") {
  const auto& [particles, network] = millimetre_body();
  const LinearForces forces(beam, particles, network);
  const CompactLinearForces compact(beam, particles, network);
  SpatialField motion = body::random_motion(particles.size(), 1e-7, 32);
  for (auto& spatial : motion)
    spatial.angular() *= 1e-4;
  // Roundings of 2^-24 each: K_t across the bond, and the difference of stiffnesses along it.
  double worst = 0;
  for (BondIndex b = 0; b < forces.bond_count(); ++b) {
    const auto [i, j] = forces.ends(b);
    const auto k = forces.stiffness(b);
    const double reach = motion[j].linear().norm() + motion[i].linear().norm() +
                         0.5 * forces.length(b) * (motion[i].angular().norm() + motion[j].angular().norm());
    const Vec3 error = compact.load(b, motion).force - forces.load(b, motion).force;
    worst = std::max(worst, error.norm() / (std::max(k.normal, k.tangential) * reach));
  }
  CHECK(worst < 2 * 0x1p-24);
  CHECK(worst > 0x1p-28); // the two are not the same code
  const SpatialField exact = evaluated(forces, motion), found = evaluated(compact, motion);
  const auto [force, moment] = size_of(exact);
  const auto [force_error, moment_error] = size_of(difference(found, exact));
  MESSAGE("relative error (root mean square) of forces ", force_error / force, ", of moments ",
          moment_error / moment);
  CHECK(force_error < 2 * 0x1p-24 * force);
  CHECK(moment_error < 2 * 0x1p-24 * moment);
}

TEST_CASE("stiffnesses stored in float: rigid motions give no force, to the rounding of a double") {
  const auto& [particles, network] = millimetre_body();
  const CompactLinearForces compact(beam, particles, network);
  const auto translated =
      evaluated(compact, body::rigid_motion(particles, Vec3(1, 2, -4) / 1024, Vec3::Zero()));
  CHECK(size_of(translated).first == 0);
  CHECK(size_of(translated).second == 0);
  const Vec3 rotation(3e-4, -2e-4, 1e-4);
  const auto rotated = body::rigid_motion(particles, Vec3::Zero(), rotation);
  double worst = 0;
  for (BondIndex b = 0; b < compact.bond_count(); ++b) {
    const auto k = compact.stiffness(b);
    const double reach = particles.position[compact.ends(b).first].norm() * rotation.norm();
    worst =
        std::max(worst, compact.load(b, rotated).force.norm() / (std::max(k.normal, k.tangential) * reach));
  }
  CHECK(worst < 1e-15);
}

TEST_CASE("stiffnesses stored in float keep the stiffness symmetric and the loads of a bond opposite") {
  const Body body = body::random_body(40, 33, 1e-3);
  const CompactLinearForces compact(beam, body.particles, body.network);
  const Eigen::MatrixXd stiffness = body::dense_stiffness(compact);
  CHECK((stiffness - stiffness.transpose()).lpNorm<Eigen::Infinity>() <
        1e-14 * stiffness.lpNorm<Eigen::Infinity>());
  const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues();
  CHECK(values.minCoeff() > -1e-14 * values.maxCoeff());
  for (ParticleIndex i = 0; i < 40; ++i)
    CHECK((compact.diagonal_block(i) - stiffness.block<6, 6>(6 * i, 6 * i)).lpNorm<Eigen::Infinity>() <
          1e-13 * stiffness.lpNorm<Eigen::Infinity>());

  const SpatialField motion = body::random_motion(40, 1e-3, 34);
  Vec3 sum = Vec3::Zero();
  double scale = 0;
  for (const auto& spatial : evaluated(compact, motion)) {
    sum += spatial.linear();
    scale += spatial.linear().norm();
  }
  CHECK(sum.norm() < 1e-14 * scale);

  core::ThreadPool pool;
  const double work = body::flat(motion).dot(stiffness * body::flat(motion));
  CHECK(compact.elastic_energy(motion, pool) == doctest::Approx(0.5 * work).epsilon(1e-13));
}

TEST_CASE("stiffnesses stored in float: the same bytes for any number of threads") {
  const auto& [particles, network] = millimetre_body();
  const CompactLinearForces compact(beam, particles, network);
  const SpatialField motion = body::random_motion(particles.size(), 1e-3, 35);
  const SpatialField serial = evaluated(compact, motion);
  CHECK(body::same_bytes(evaluated(compact, motion, 3), serial));
}

TEST_CASE("a stiffness that a float cannot hold is refused") {
  const Body pair = body::row(2, Vec3::UnitX(), 1e-12, 5e-13);
  const bond::Beam<> stiff({.materials = {{1e36, 1}}});
  CHECK(body::message_of([&] { LinearForces forces(stiff, pair.particles, pair.network); }) ==
        "no InvalidInput thrown");
  CHECK(body::contains(
      body::message_of([&] { CompactLinearForces forces(stiff, pair.particles, pair.network); }),
      "is not accepted: at most 3.4028"));
}

TEST_CASE("a bond takes 64 bytes in double precision, 48 with its stiffnesses in float") {
  const auto& [particles, network] = millimetre_body();
  const LinearForces forces(beam, particles, network);
  const CompactLinearForces compact(beam, particles, network);
  const auto places =
      static_cast<double>(forces.memory() - compact.memory()) / 16; // copies for other blocks included
  const auto bonds = static_cast<double>(network.size());
  CHECK(places >= bonds);
  CHECK(places < 2 * bonds);
  // lists: place at the second end, 4 bytes a bond; 8 a particle; numbers of the copies
  const double lists = static_cast<double>(compact.memory()) - 48 * places;
  CHECK(lists < 4 * bonds + 8 * static_cast<double>(particles.size()) + 8 * (places - bonds) + 1000);
}

namespace {

/// Forces by either kernel, block by block, and by the single loads of each bond.
template <class Real>
void compare_kernels() {
  const auto& particles = millimetre_body().particles;
  const auto& network = millimetre_body().network;
  const bond::BasicLinearForces<Real> forces(beam, particles, network);
  const bond::detail::BlockedBonds<Real> bonds(
      particles.size(), network.first, network.second, [&](BondIndex b) {
        const auto geometry = bond::geometry_of(b, particles, network);
        return BondRecord::of(geometry, beam.stiffness(geometry), network.first[b], network.second[b]);
      });
  REQUIRE(bonds.block_count() > 2);
  const SpatialField motion = body::random_motion(particles.size(), 1e-3, 36);
  SpatialField portable(motion.size()), chosen(motion.size());
  for (std::size_t number = 0; number < bonds.block_count(); ++number) {
    const auto block = bonds.block(number);
    bond::detail::add_forces_portable(block, motion.data(), portable.data() + block.begin);
    bond::detail::add_forces(block, motion.data(), chosen.data() + block.begin);
  }
  SpatialField single(motion.size());
  for (BondIndex b = 0; b < forces.bond_count(); ++b) {
    const auto [i, j] = forces.ends(b);
    const auto load = forces.load(b, motion);
    single[i].linear() += load.force;
    single[i].angular() += load.moment_first;
    single[j].linear() -= load.force;
    single[j].angular() += load.moment_second;
  }
  const auto [force, moment] = size_of(single);
  const auto [force_error, moment_error] = size_of(difference(portable, single));
  CHECK(force_error < 1e-15 * force);
  CHECK(moment_error < 1e-15 * moment);
#ifdef __FMA__ // the compiler may fuse what it likes, in either
  const auto [chosen_force, chosen_moment] = size_of(difference(portable, chosen));
  CHECK(chosen_force < 1e-14 * force);
  CHECK(chosen_moment < 1e-14 * moment);
#else
  CHECK(body::same_bytes(portable, chosen));
#endif
}

} // namespace

TEST_CASE("the kernel of this processor gives the bytes of the one for any, both the sum of single loads") {
  compare_kernels<double>();
  compare_kernels<float>();
}

TEST_CASE("a bond turned around gives the same bytes") {
  core::Random random(37);
  for (int k = 0; k < 100; ++k) {
    const auto geometry = body::random_geometry(random);
    const auto bond = BondRecord::of(geometry, beam.stiffness(geometry), 0, 1);
    const auto ends = body::random_ends(random, geometry.length);
    const auto first = body::end_of(ends, 0), second = body::end_of(ends, 1);
    const auto there = bond.load(first, second), back = bond.turned().load(second, first);
    CHECK(there.force == -back.force);
    CHECK(there.moment_first == back.moment_second);
    CHECK(there.moment_second == back.moment_first);
  }
}
