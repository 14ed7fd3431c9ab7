#pragma once

/// @file
/// The beam's forces as one writes them in an afternoon: an edge list of 72 bytes a bond, forces zeroed and
/// scattered. What the library must beat. It shares no code with it.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <vector>

#include "sample.hpp"

namespace bench {

struct RawBond {
  std::uint32_t i, j;
  double n[3], length, kn, kt, torsion, bending;
};
static_assert(sizeof(RawBond) == 72);

namespace detail {
inline std::vector<RawBond> make_raw_bonds(const Sample& sample) {
  const auto law = alumina();
  std::vector<RawBond> bonds;
  bonds.reserve(sample.network.size());
  for (std::size_t b = 0; b < sample.network.size(); ++b) {
    const auto geometry = cdem::bond::geometry_of(b, sample.particles, sample.network);
    const auto k = law.stiffness(geometry);
    const auto& n = geometry.direction;
    bonds.push_back({sample.network.first[b],
                     sample.network.second[b],
                     {n.x(), n.y(), n.z()},
                     geometry.length,
                     k.normal,
                     k.tangential,
                     k.torsion,
                     k.bending});
  }
  return bonds;
}
} // namespace detail

/// The sample's bonds, made once.
inline const std::vector<RawBond>& raw_bonds(std::int64_t particles) {
  static std::map<std::int64_t, std::vector<RawBond>> made;
  const auto found = made.find(particles);
  return found != made.end()
             ? found->second
             : made.emplace(particles, detail::make_raw_bonds(sample(particles))).first->second;
}

/// f = -K u, each bond's part times what is `left` of it: left(number of the bond, twice its energy).
template <class Left>
void raw_forces(const std::vector<RawBond>& bonds, const Field& displacement, Field& force, Left&& left) {
  std::memset(static_cast<void*>(force.data()), 0, force.size() * sizeof(force[0]));
  for (std::size_t number = 0; number < bonds.size(); ++number) {
    const RawBond& b = bonds[number];
    const double *u = displacement[b.i].component, *v = displacement[b.j].component;
    double *f = force[b.i].component, *g = force[b.j].component;
    const double nx = b.n[0], ny = b.n[1], nz = b.n[2];
    const double tx = 0.5 * (u[4] + v[4]), ty = 0.5 * (u[5] + v[5]), tz = 0.5 * (u[6] + v[6]);
    const double sx = v[0] - u[0] - b.length * (ty * nz - tz * ny);
    const double sy = v[1] - u[1] - b.length * (tz * nx - tx * nz);
    const double sz = v[2] - u[2] - b.length * (tx * ny - ty * nx);
    const double dx = v[4] - u[4], dy = v[5] - u[5], dz = v[6] - u[6];
    const double along = (b.kn - b.kt) * (sx * nx + sy * ny + sz * nz);
    const double twist = (b.torsion - b.bending) * (dx * nx + dy * ny + dz * nz);
    double fx = b.kt * sx + along * nx, fy = b.kt * sy + along * ny, fz = b.kt * sz + along * nz;
    double mx = b.bending * dx + twist * nx, my = b.bending * dy + twist * ny,
           mz = b.bending * dz + twist * nz;
    const double part = left(number, fx * sx + fy * sy + fz * sz + mx * dx + my * dy + mz * dz);
    fx *= part, fy *= part, fz *= part, mx *= part, my *= part, mz *= part;
    const double arm = 0.5 * b.length;
    const double cx = arm * (ny * fz - nz * fy), cy = arm * (nz * fx - nx * fz),
                 cz = arm * (nx * fy - ny * fx);
    f[0] += fx, f[1] += fy, f[2] += fz, f[4] += cx + mx, f[5] += cy + my, f[6] += cz + mz;
    g[0] -= fx, g[1] -= fy, g[2] -= fz, g[4] += cx - mx, g[5] += cy - my, g[6] += cz - mz;
  }
}

/// f = -K u.
inline void raw_forces(const std::vector<RawBond>& bonds, const Field& displacement, Field& force) {
  raw_forces(bonds, displacement, force, [](std::size_t, double) { return 1.0; });
}

/// The library's forces on the sample, made once.
/// @throws std::logic_error if they are not those of the raw loop
template <class Real>
const cdem::bond::BasicLinearForces<Real>& forces_of(std::int64_t particles) {
  static std::map<std::int64_t, cdem::bond::BasicLinearForces<Real>> made;
  const auto found = made.find(particles);
  if (found != made.end())
    return found->second;
  const Sample& body = sample(particles);
  const auto& forces = made.try_emplace(particles, alumina(), body.particles, body.network).first->second;
  const Field motion = random_motion(body.particles.size());
  Field force(motion.size()), expected(motion.size());
  cdem::core::ThreadPool pool;
  forces.evaluate(motion, force, pool);
  raw_forces(raw_bonds(particles), motion, expected);
  if (!(relative_difference(expected, force) < (sizeof(Real) == 8 ? 1e-14 : 1e-6)))
    throw std::logic_error("the library and the raw loop differ");
  return forces;
}

} // namespace bench
