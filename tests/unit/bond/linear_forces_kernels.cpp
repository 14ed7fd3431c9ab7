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
using bond::detail::BondBlock;
using bond::detail::BondRecord;

const bond::Beam<> beam({.materials = {{2536e9, 0.545}, {12020e9, 0.169}}});

const Body& millimetre_body() {
  static const Body body = body::random_body(6000, 31, 1e-3);
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

TEST_CASE("bonds stored in float change the forces by the rounding of a float") {
  const auto& [particles, network] = millimetre_body();
  const LinearForces forces(beam, particles, network);
  const CompactLinearForces compact(beam, particles, network);
  SpatialField motion = body::random_motion(particles.size(), 1e-7, 32);
  for (auto& spatial : motion)
    spatial.angular() *= 1e-4;
  // Roundings of 2^-24 each: one of K, one of d in the slip, three of d, d and the difference of stiffnesses in
  // the part along the bond.
  double worst = 0;
  for (BondIndex b = 0; b < forces.bond_count(); ++b) {
    const auto [i, j] = forces.ends(b);
    const auto k = forces.stiffness(b);
    const double reach = motion[j].linear().norm() + motion[i].linear().norm() +
                         0.5 * forces.length(b) * (motion[i].angular().norm() + motion[j].angular().norm());
    const Vec3 error = compact.load(b, motion).force - forces.load(b, motion).force;
    worst = std::max(worst, error.norm() / (std::max(k.normal, k.tangential) * reach));
  }
  CHECK(worst < 5 * 0x1p-24);
  CHECK(worst > 0x1p-28); // the two are not the same code
  const SpatialField exact = evaluated(forces, motion), found = evaluated(compact, motion);
  const auto [force, moment] = size_of(exact);
  const auto [force_error, moment_error] = size_of(difference(found, exact));
  MESSAGE("relative error (root mean square) of forces ", force_error / force, ", of moments ",
          moment_error / moment);
  CHECK(force_error < 5 * 0x1p-24 * force);
  CHECK(moment_error < 5 * 0x1p-24 * moment);
}

TEST_CASE("bonds stored in float: a translation gives no force at all, a rotation one of 2^-24 K_t L th") {
  const auto& [particles, network] = millimetre_body();
  const CompactLinearForces compact(beam, particles, network);
  const Vec3 rotation(3e-4, -2e-4, 1e-4);

  const auto translated =
      evaluated(compact, body::rigid_motion(particles, Vec3(1, 2, -4) / 1024, Vec3::Zero()));
  CHECK(size_of(translated).first == 0);
  CHECK(size_of(translated).second == 0);

  // per bond: slip = th x (2d - 2 d rounded), each component of d rounded by at most 2^-24 of itself
  const auto rotated = body::rigid_motion(particles, Vec3::Zero(), rotation);
  double worst = 0;
  for (BondIndex b = 0; b < compact.bond_count(); ++b) {
    const auto k = compact.stiffness(b);
    worst = std::max(worst, compact.load(b, rotated).force.norm() /
                                (std::max(k.normal, k.tangential) * compact.length(b) * rotation.norm()));
  }
  MESSAGE("force of a rotation over K L th: ", worst);
  CHECK(worst < 0x1p-24);
  CHECK(worst > 0x1p-30);
}

TEST_CASE("bonds stored in float keep the stiffness symmetric and the loads of a bond opposite") {
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

TEST_CASE("bonds stored in float: the same bytes for any number of threads") {
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
      "a stiffness of bond 0 over its length squared = inf is not accepted"));
}

TEST_CASE("a bond takes a cache line in double precision, half of one in float") {
  const auto& [particles, network] = millimetre_body();
  const LinearForces forces(beam, particles, network);
  const CompactLinearForces compact(beam, particles, network);
  CHECK(forces.memory() - compact.memory() == 32 * network.size());
  // lists: first and second ends, 12 bytes a bond; 16 a particle; 16 a bond between blocks, at most all of them
  CHECK(compact.memory() < (32 + 12 + 16) * network.size() + 16 * (particles.size() + 100));
}

#if defined(__x86_64__) && defined(__GNUC__)

namespace {

/// Both kernels over blocks of 700 particles of a random body.
template <class Real>
void compare_kernels() {
  const auto& [particles, network] = millimetre_body();
  std::vector<BondRecord<Real>, particles::CacheAlignedAllocator<BondRecord<Real>>> records;
  std::vector<BondIndex> begin(particles.size() + 1, 0);
  for (BondIndex b = 0; b < network.size(); ++b) {
    const auto geometry = bond::geometry_of(b, particles, network);
    records.emplace_back(geometry, beam.stiffness(geometry), network.second[b]);
    ++begin[network.first[b] + std::size_t{1}];
  }
  for (std::size_t i = 0; i < particles.size(); ++i)
    begin[i + 1] += begin[i];
  const SpatialField motion = body::random_motion(particles.size(), 1e-3, 36);
  for (ParticleIndex start = 0; start < particles.size(); start += 700) {
    const ParticleIndex end =
        std::min<ParticleIndex>(start + 700, static_cast<ParticleIndex>(particles.size()));
    std::vector<bond::detail::IncomingBond> incoming;
    for (BondIndex b = 0; b < network.size(); ++b)
      if (network.first[b] < start && network.second[b] >= start && network.second[b] < end)
        incoming.push_back({b, network.first[b]});
    const BondBlock<Real> block{records.data(), begin.data(), incoming.data(), incoming.size(), start, end};
    SpatialField portable(end - start), vectorised(end - start);
    bond::detail::add_forces(block, motion.data(), portable.data());
    bond::detail::Avx2::add_forces(block, motion.data(), vectorised.data());
#ifdef __FMA__ // the compiler may fuse what it likes, in either
    const auto [force, moment] = size_of(portable);
    const auto [force_error, moment_error] = size_of(difference(portable, vectorised));
    CHECK(force_error < 1e-14 * force);
    CHECK(moment_error < 1e-14 * moment);
#else
    CHECK(body::same_bytes(portable, vectorised));
#endif
  }
}

} // namespace

TEST_CASE("the kernel for AVX2 gives the same bytes as the one for any processor") {
  if (!bond::detail::has_avx2()) {
    MESSAGE("this processor has no AVX2: nothing to compare");
    return;
  }
  compare_kernels<double>();
  compare_kernels<float>();
}

#endif
