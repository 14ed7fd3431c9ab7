#pragma once

/// @file
/// Bodies and motions shared by the tests of the integrators.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/bond/spring.hpp>
#include <cdem/core/random.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/particles/inertia.hpp>

#include <Eigen/Dense>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace sample {

using namespace cdem;
using Field = particles::SpatialField<>;

/// Particles and the bonds that join them.
struct Network {
  particles::ParticleSet particles;
  network::BondNetwork bonds;
};

inline Vec3 random_vector(core::Random& random, double size) {
  const double x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}

/// Simple cubic lattice of edge^3 spheres 1 mm apart, shaken by up to a fifth of that, radii within 35 % of
/// their mean, phases 0 and 1 at random; neighbours nearer than 1.3 mm are bonded (Z is near 7).
inline Network shaken_lattice(int edge, std::uint64_t seed) {
  constexpr double spacing = 1e-3;
  core::Random random(seed);
  Network net;
  auto& p = net.particles;
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      for (int z = 0; z < edge; ++z) {
        p.position.push_back(spacing * (Vec3(x, y, z) + random_vector(random, 0.2)));
        p.radius.push_back(0.5 * spacing * random.uniform(0.65, 1.35));
        p.phase.push_back(static_cast<PhaseIndex>(random.bits() & 1));
      }
  net.bonds.particle_count = p.size();
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = i + 1; j < p.size(); ++j) {
      const Vec3 branch = p.position[j] - p.position[i];
      if (branch.norm() > 1.3 * spacing)
        continue;
      net.bonds.first.push_back(static_cast<ParticleIndex>(i));
      net.bonds.second.push_back(static_cast<ParticleIndex>(j));
      net.bonds.branch.push_back(branch);
    }
  return net;
}

/// Straight row along x of `count` equal spheres, each bonded to the next; `closed` bonds the last to the
/// first, as through a periodic face.
inline Network row(std::size_t count, double spacing, double radius, bool closed = false) {
  Network net;
  net.particles.resize(count);
  net.bonds.particle_count = count;
  const auto bond = [&](std::size_t i, std::size_t j, double along) {
    net.bonds.first.push_back(static_cast<ParticleIndex>(i));
    net.bonds.second.push_back(static_cast<ParticleIndex>(j));
    net.bonds.branch.push_back(along * Vec3::UnitX());
  };
  for (std::size_t i = 0; i < count; ++i) {
    net.particles.position[i] = static_cast<double>(i) * spacing * Vec3::UnitX();
    net.particles.radius[i] = radius;
    if (i + 1 < count)
      bond(i, i + 1, spacing);
    if (i == 0 && closed)
      bond(0, count - 1, -spacing);
  }
  return net;
}

/// A network with its forces, inertia and constraints: what a Problem refers to.
struct Body {
  Network net;
  bond::LinearForces forces;
  particles::Inertia inertia;
  particles::Constraints constraints = {};
  Field load = {};

  template <class Law>
  Body(Network network, const Law& law, double density = 2000)
      : net(std::move(network)), forces(law, net.particles, net.bonds),
        inertia(particles::solid_spheres(net.particles, std::vector<double>{density, 1.5 * density})) {}

  std::size_t size() const { return forces.particle_count(); }
  integrate::Problem<bond::LinearForces> problem() const {
    return {forces, inertia, constraints, load.empty() ? nullptr : &load};
  }
  /// Holds (or moves) a degree of freedom of every particle with x below `below`.
  void hold_left(double below) {
    for (std::size_t i = 0; i < size(); ++i)
      if (net.particles.position[i].x() < below)
        for (int dof = 0; dof < 6; ++dof)
          constraints.add({static_cast<ParticleIndex>(i), static_cast<std::uint8_t>(dof), 0});
  }
};

/// Two phases, contrast `contrast`, of E_mu 1 GPa.
inline bond::Beam<> beam(double radius_ratio = 0.5, double contrast = 5) {
  return bond::Beam<>({.materials = {{1e9, radius_ratio}, {contrast * 1e9, radius_ratio}}});
}

/// Free or held body of edge^3 particles.
inline Body lattice_body(int edge, std::uint64_t seed, bool held = false) {
  Body body(shaken_lattice(edge, seed), beam());
  if (held)
    body.hold_left(0.5e-3);
  return body;
}

/// At rest but shaken: velocities up to 1 m/s and 1000 rad/s, displacements and rotations to match; zero
/// where constrained.
inline particles::Motion shaken(const Body& body, std::uint64_t seed) {
  core::Random random(seed);
  auto motion = particles::Motion::at_rest(body.size());
  for (std::size_t i = 0; i < body.size(); ++i) {
    motion.displacement[i].linear() = random_vector(random, 1e-6);
    motion.displacement[i].angular() = random_vector(random, 1e-3);
    motion.velocity[i].linear() = random_vector(random, 1);
    motion.velocity[i].angular() = random_vector(random, 1000);
  }
  for (const auto& constraint : body.constraints.list()) {
    motion.displacement[constraint.particle][constraint.dof] = 0;
    motion.velocity[constraint.particle][constraint.dof] = constraint.rate;
  }
  return motion;
}

/// 2 over the largest frequency: the exact limit of undamped velocity Verlet.
inline double stability_limit(const Body& body, double tolerance = 1e-13) {
  core::ThreadPool pool;
  return 2 / integrate::largest_frequency(body.problem(), pool, tolerance, 2000000);
}

/// Kinetic and elastic energy, J.
inline double energy(const Body& body, const particles::Motion& motion) {
  core::ThreadPool pool;
  return integrate::kinetic_energy(body.inertia, motion.velocity, pool) +
         body.forces.elastic_energy(motion.displacement, pool);
}

/// sum of F.M^-1 F over the free degrees of freedom, of the internal forces, W N/kg.
inline double force_norm(const Body& body, const particles::Motion& motion) {
  core::ThreadPool pool;
  Field force(body.size());
  body.forces.evaluate(motion.displacement, force, pool);
  for (const auto& constraint : body.constraints.list())
    force[constraint.particle][constraint.dof] = 0;
  double sum = 0;
  for (std::size_t i = 0; i < body.size(); ++i)
    sum += force[i].linear().squaredNorm() / body.inertia.mass[i] +
           force[i].angular().squaredNorm() / body.inertia.moment[i];
  return sum;
}

inline bool same_bytes(const Field& a, const Field& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

inline bool same_bytes(const particles::Motion& a, const particles::Motion& b) {
  return same_bytes(a.displacement, b.displacement) && same_bytes(a.velocity, b.velocity) &&
         same_bytes(a.acceleration, b.acceleration) && a.time == b.time && a.step == b.step &&
         std::memcmp(&a.energy, &b.energy, sizeof(a.energy)) == 0;
}

/// What an exception of type Error says when `call` throws it.
template <class Error = core::InvalidInput, class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing thrown";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace sample
