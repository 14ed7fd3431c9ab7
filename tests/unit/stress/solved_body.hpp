#pragma once

// A body of beams in equilibrium, clamped at x = 0 and pulled and twisted at x = 1: forces and moments of all its bonds, solved for by
// conjugate gradients.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "sample.hpp"

namespace sample {

struct SolvedBody {
  Body body;
  std::vector<Vec3> moments;          ///< [bonds] N m, at the middle
  particles::SpatialField<> external; ///< [particles] N, N m: zero but in the clamps
  stress::BondLoads loads() const { return {body.forces, moments}; }
};

inline constexpr double clamp_depth = 0.12;

inline SolvedBody solve_body(std::size_t count, double reach, std::uint64_t seed) {
  SolvedBody solved;
  Body& body = solved.body = random_body(geometry::Box::cube(1, false), count, reach, seed);
  const auto& x = body.particles.position;
  const bond::Beam<> law({.materials = {{.youngs_modulus = 1e6, .radius_ratio = 0.8}}});
  const bond::LinearForces forces(law, body.particles, body.network);
  core::ThreadPool pool;

  using Field = particles::SpatialField<>;
  Field u(count), right(count), inverse(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (x[i].x() > 1 - clamp_depth) {
      u[i].linear() = Vec3(0.01, 0.05 * (0.5 - x[i].z()), 0.05 * (x[i].y() - 0.5));
      u[i].angular() = Vec3(0.05, 0, 0);
    }
    const auto block = forces.diagonal_block(static_cast<ParticleIndex>(i));
    if (x[i].x() >= clamp_depth && x[i].x() <= 1 - clamp_depth && block(0, 0) > 0)
      for (int dof = 0; dof < 6; ++dof)
        inverse[i][dof] = 1 / block(dof, dof); // 0 where a particle is held or hangs on nothing
  }
  const auto dot = [&](const Field& a, const Field& b) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
      sum += a[i].linear().dot(b[i].linear()) + a[i].angular().dot(b[i].angular());
    return sum;
  };
  const auto each = [&](auto&& change) {
    for (std::size_t i = 0; i < count; ++i)
      for (int dof = 0; dof < 6; ++dof)
        change(i, dof);
  };
  Field residual, z(count), p(count), force;
  forces.evaluate(u, residual, pool);
  each([&](auto i, int d) { p[i][d] = z[i][d] = inverse[i][d] * residual[i][d]; });
  double rho = dot(residual, z);
  const double target = 1e-30 * rho;
  int iterations = 0;
  for (; rho > target && iterations < 5000; ++iterations) {
    forces.evaluate(p, force, pool);
    const double step = -rho / dot(p, force); // p is zero where particles are held
    each([&](auto i, int d) {
      u[i][d] += step * p[i][d];
      residual[i][d] += step * force[i][d];
      z[i][d] = inverse[i][d] * residual[i][d];
    });
    const double next = dot(residual, z);
    each([&](auto i, int d) { p[i][d] = z[i][d] + next / rho * p[i][d]; });
    rho = next;
  }
  REQUIRE(iterations < 5000);

  forces.evaluate(u, solved.external, pool);
  double largest = 0;
  for (const auto& f : solved.external)
    largest = std::max(largest, f.linear().norm());
  each([&](auto i, int d) {
    if (inverse[i][d] != 0)
      REQUIRE(std::abs(solved.external[i][d]) < 1e-10 * largest); // in equilibrium
    solved.external[i][d] *= inverse[i][d] != 0 ? 0 : -1;
  });
  for (std::size_t b = 0; b < body.network.size(); ++b) {
    const bond::BondLoad load = forces.load(b, u);
    body.forces[b] = load.force;
    solved.moments.push_back(0.5 * (load.moment_first - load.moment_second));
  }
  return solved;
}

/// d x f of a bond.
inline Vec3 couple_of(const SolvedBody& solved, std::size_t bond) {
  return solved.body.network.branch[bond].cross(solved.body.forces[bond]);
}

} // namespace sample
