#pragma once

/// @file
/// Bodies and motions shared by the tests of bond laws and internal forces.

#include <cdem/bond/bond_law.hpp>
#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/core/random.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/particles/particle_set.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace body {

using cdem::Mat3;
using cdem::ParticleIndex;
using cdem::Vec3;
using SpatialField = cdem::particles::SpatialField<>;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// Particles and the bonds that join them.
struct Body {
  cdem::particles::ParticleSet particles;
  cdem::network::BondNetwork network;
};

/// Components uniform in [-size, size).
inline Vec3 random_vector(cdem::core::Random& random, double size) {
  const double x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}

/// Two ends of a bond: u_i, th_i, u_j, th_j.
inline Vector12 random_ends(cdem::core::Random& random, double length) {
  Vector12 ends;
  ends << random_vector(random, length), random_vector(random, 1), random_vector(random, length),
      random_vector(random, 1);
  return ends;
}

/// The same 12 numbers as two Spatial.
inline cdem::particles::Spatial<> end_of(const Vector12& ends, int end) {
  cdem::particles::Spatial<> spatial;
  spatial.linear() = ends.segment<3>(6 * end);
  spatial.angular() = ends.segment<3>(6 * end + 3);
  return spatial;
}

/// Force and moment on the first end, then on the second.
inline Vector12 on_both_ends(const cdem::bond::BondLoad& load) {
  Vector12 loads;
  loads << load.force, load.moment_first, -load.force, load.moment_second;
  return loads;
}

/// A bond of random direction, length and radii within a factor of three.
inline cdem::bond::BondGeometry random_geometry(cdem::core::Random& random) {
  cdem::bond::BondGeometry geometry;
  geometry.radius_first = random.uniform(1e-4, 3e-4);
  geometry.radius_second = random.uniform(1e-4, 3e-4);
  geometry.length = (geometry.radius_first + geometry.radius_second) * random.uniform(0.95, 1.1);
  geometry.direction = random_vector(random, 1).normalized();
  return geometry;
}

/// Random spheres in a cube of side (count)^(1/3) mean diameters, every two bonded whose centres are nearer
/// than 1.4 mean diameters; sorted by (first, second). Phases 0 and 1 at random.
inline Body random_body(std::size_t count, std::uint64_t seed, double diameter = 1) {
  cdem::core::Random random(seed);
  Body body;
  body.particles.resize(count);
  const double side = diameter * std::cbrt(static_cast<double>(count));
  for (std::size_t i = 0; i < count; ++i) {
    body.particles.position[i] = random_vector(random, side / 2);
    body.particles.radius[i] = 0.5 * diameter * random.uniform(0.7, 1.3);
    body.particles.phase[i] = static_cast<cdem::PhaseIndex>(random.uniform() < 0.5);
  }
  body.network.particle_count = count;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      const Vec3 branch = body.particles.position[j] - body.particles.position[i];
      if (branch.norm() > 1.4 * diameter)
        continue;
      body.network.first.push_back(static_cast<ParticleIndex>(i));
      body.network.second.push_back(static_cast<ParticleIndex>(j));
      body.network.branch.push_back(branch);
    }
  return body;
}

/// A straight row of `count` equal spheres along `direction`, each bonded to the next.
inline Body row(std::size_t count, const Vec3& direction, double spacing, double radius) {
  Body body;
  body.particles.resize(count);
  body.network.particle_count = count;
  for (std::size_t i = 0; i < count; ++i) {
    body.particles.position[i] = static_cast<double>(i) * spacing * direction;
    body.particles.radius[i] = radius;
    if (i == 0)
      continue;
    body.network.first.push_back(static_cast<ParticleIndex>(i - 1));
    body.network.second.push_back(static_cast<ParticleIndex>(i));
    body.network.branch.push_back(spacing * direction);
  }
  return body;
}

/// Displacements up to `length`, rotations up to 1.
inline SpatialField random_motion(std::size_t particles, double length, std::uint64_t seed) {
  cdem::core::Random random(seed);
  SpatialField field(particles);
  for (auto& spatial : field) {
    spatial.linear() = random_vector(random, length);
    spatial.angular() = random_vector(random, 1);
  }
  return field;
}

/// Small rigid motion: u = translation + rotation x (x - 0), th = rotation.
inline SpatialField rigid_motion(const cdem::particles::ParticleSet& particles, const Vec3& translation,
                                 const Vec3& rotation) {
  SpatialField field(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    field[i].linear() = translation + rotation.cross(particles.position[i]);
    field[i].angular() = rotation;
  }
  return field;
}

/// [6 particles] as one vector.
inline Eigen::VectorXd flat(const SpatialField& field) {
  Eigen::VectorXd vector(6 * static_cast<Eigen::Index>(field.size()));
  for (std::size_t i = 0; i < field.size(); ++i)
    for (int dof = 0; dof < 6; ++dof)
      vector[6 * static_cast<Eigen::Index>(i) + dof] = field[i][dof];
  return vector;
}

/// Forces at a displacement.
template <class Forces>
SpatialField evaluated(const Forces& forces, const SpatialField& motion, int threads = 1) {
  cdem::core::ThreadPool pool(threads);
  SpatialField force;
  forces.evaluate(motion, force, pool);
  return force;
}

/// Largest difference between the forces and central differences of the energy, over the largest force; of every third
/// particle.
template <class Forces>
double gradient_error(const Forces& forces, SpatialField motion, double step) {
  cdem::core::ThreadPool pool;
  const SpatialField force = evaluated(forces, motion);
  double worst = 0;
  for (std::size_t i = 0; i < motion.size(); i += 3)
    for (int dof = 0; dof < 6; ++dof) {
      const double here = motion[i][dof];
      motion[i][dof] = here + step;
      const double after = forces.elastic_energy(motion, pool);
      motion[i][dof] = here - step;
      const double before = forces.elastic_energy(motion, pool);
      motion[i][dof] = here;
      worst = std::max(worst, std::abs((before - after) / (2 * step) - force[i][dof]));
    }
  return worst / flat(force).lpNorm<Eigen::Infinity>();
}

/// K, column by column, from f = -K u.
template <class Forces>
Eigen::MatrixXd dense_stiffness(const Forces& forces) {
  const std::size_t count = forces.particle_count();
  const auto size = 6 * static_cast<Eigen::Index>(count);
  Eigen::MatrixXd stiffness(size, size);
  cdem::core::ThreadPool pool;
  SpatialField motion(count), force(count);
  for (Eigen::Index column = 0; column < size; ++column) {
    double& moved = motion[static_cast<std::size_t>(column / 6)][static_cast<int>(column % 6)];
    moved = 1;
    forces.evaluate(motion, force, pool);
    moved = 0;
    stiffness.col(column) = -flat(force);
  }
  return stiffness;
}

/// What core::InvalidInput says when `call` throws it.
template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const cdem::core::InvalidInput& error) {
    return error.what();
  }
  return "no InvalidInput thrown";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline bool same_bytes(const SpatialField& a, const SpatialField& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

} // namespace body
