#pragma once

/// @file
/// Samples and a second neighbour search shared by the tests of the network layer.

#include <cdem/core/random.hpp>
#include <cdem/core/types.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/network/neighbour_search.hpp>
#include <cdem/particles/particle_set.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace sample {

using cdem::ParticleIndex;
using cdem::Vec3;

/// Every point and its 26 nearest images, one by one: the definition of a neighbour search.
class BruteForceSearch {
public:
  BruteForceSearch(const std::vector<Vec3>& points, const cdem::geometry::Box& box)
      : points_(points), box_(box) {}

  template <class Visitor>
  void for_each_within(const Vec3& point, double radius, Visitor&& visit) const {
    for (std::size_t j = 0; j < points_.size(); ++j)
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z) {
            const bool exists =
                (x == 0 || box_.periodic[0]) && (y == 0 || box_.periodic[1]) && (z == 0 || box_.periodic[2]);
            const Vec3 shift = box_.size().cwiseProduct(Vec3(x, y, z));
            if (exists && (box_.wrap(points_[j]) + shift - box_.wrap(point)).norm() <= radius)
              visit(static_cast<ParticleIndex>(j));
          }
  }

private:
  std::vector<Vec3> points_;
  cdem::geometry::Box box_;
};

/// Points uniform in the box, radii uniform in [smallest, largest]. Overlaps do not matter here.
inline cdem::particles::ParticleSet random_spheres(std::size_t count, const cdem::geometry::Box& box,
                                                   double smallest, double largest, std::uint64_t seed) {
  cdem::core::Random random(seed);
  cdem::particles::ParticleSet particles;
  particles.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k)
      particles.position[i][k] = random.uniform(box.lower[k], box.upper[k]);
    particles.radius[i] = random.uniform(smallest, largest);
  }
  return particles;
}

/// Simple cubic lattice of `edge`^3 touching spheres of diameter 1 that fills the cube [0, edge]^3.
inline cdem::particles::ParticleSet simple_cubic(int edge) {
  cdem::particles::ParticleSet particles;
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      for (int z = 0; z < edge; ++z)
        particles.position.push_back(Vec3(x, y, z) + Vec3::Constant(0.5));
  particles.radius.assign(particles.position.size(), 0.5);
  particles.phase.assign(particles.position.size(), 0);
  return particles;
}

/// Whether two networks are the same to the last bit.
inline bool same_bytes(const cdem::network::BondNetwork& a, const cdem::network::BondNetwork& b) {
  return a.particle_count == b.particle_count && a.first == b.first && a.second == b.second &&
         a.branch.size() == b.branch.size() &&
         (a.branch.empty() ||
          std::memcmp(a.branch.data(), b.branch.data(), a.branch.size() * sizeof(Vec3)) == 0);
}

} // namespace sample
