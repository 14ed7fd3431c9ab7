#pragma once

/// @file
/// Cubes to be pulled, for the tests of the whole chain.

#include <cdem/core/random.hpp>
#include <cdem/simulation/specimen.hpp>

namespace bodies {

using namespace cdem;

/// Simple cubic lattice of edge^3 touching spheres of diameter `spacing` in a cube that they fill from wall to wall.
inline simulation::Specimen cubic_lattice(int edge, double spacing) {
  simulation::Specimen specimen;
  specimen.box = geometry::Box::cube(edge * spacing, false);
  auto& p = specimen.particles;
  auto& n = specimen.network;
  const auto number = [&](int x, int y, int z) {
    return static_cast<ParticleIndex>((x * edge + y) * edge + z);
  };
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      for (int z = 0; z < edge; ++z) {
        p.position.push_back(spacing * (Vec3(x, y, z) + Vec3::Constant(0.5)));
        p.radius.push_back(0.5 * spacing);
        p.phase.push_back(0);
        const int next[3][3] = {
            {x, y, z + 1}, {x, y + 1, z}, {x + 1, y, z}}; // in increasing order of `second`
        for (int k = 0; k < 3; ++k)
          if (next[k][0] < edge && next[k][1] < edge && next[k][2] < edge) {
            n.first.push_back(number(x, y, z));
            n.second.push_back(number(next[k][0], next[k][1], next[k][2]));
            n.branch.push_back(spacing * Vec3::Unit(2 - k));
          }
      }
  n.particle_count = p.size();
  return specimen;
}

/// A disordered cube of edge^3 spheres: the lattice above, every centre shaken by up to a quarter of the spacing, radii
/// within 20 % of their mean, bonded at coordination number Z.
inline simulation::Specimen shaken_cube(int edge, double spacing, double coordination, std::uint64_t seed) {
  const simulation::Specimen lattice = cubic_lattice(edge, spacing);
  particles::ParticleSet shaken = lattice.particles;
  core::Random random(seed);
  for (std::size_t i = 0; i < shaken.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      shaken.position[i][k] += spacing * random.uniform(-0.25, 0.25);
    shaken.radius[i] *= random.uniform(0.8, 1.2);
  }
  core::ThreadPool pool;
  return simulation::make_specimen(shaken, lattice.box, coordination, pool);
}

} // namespace bodies
