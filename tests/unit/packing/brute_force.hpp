#pragma once

/// @file
/// What the tests of the generators compare packings by: all pairs one by one, and bytes.

#include <cdem/core/types.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/particles/particle_set.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

namespace sample {

using cdem::Vec3;

/// What a packing's overlaps come to, from all pairs and walls of the finished packing.
struct BruteForce {
  double contacts = 0, mean_overlap = 0, largest_overlap = 0, mean_force = 0, residual = 0, virial = 0;
  double contact_number = 0; ///< of those with four contacts or more, again and again
  std::size_t rattlers = 0;
};

inline BruteForce brute_force(const cdem::particles::ParticleSet& spheres, const cdem::geometry::Box& box) {
  struct Pair {
    std::size_t i, j;
  };
  BruteForce sums;
  std::vector<Pair> pairs;
  std::vector<Vec3> force(spheres.size(), Vec3::Zero());
  std::vector<int> contacts(spheres.size(), 0);
  const auto touch = [&](double overlap, double f, double r) {
    sums.contacts += 1;
    sums.mean_overlap += overlap;
    sums.largest_overlap = std::max(sums.largest_overlap, overlap);
    sums.mean_force += f;
    sums.virial += f * r;
  };
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 d = box.minimum_image(spheres.position[i] - spheres.position[j]);
      const double r = d.norm(), reach = spheres.radius[i] + spheres.radius[j];
      if (r >= reach)
        continue;
      const Vec3 push = (1 - r * r / (reach * reach)) * d;
      force[i] += push;
      force[j] -= push;
      ++contacts[i];
      ++contacts[j];
      pairs.push_back({i, j});
      touch(1 - r / reach, push.norm(), r);
    }
    for (int k = 0; k < 3 && !box.periodic[0]; ++k)
      for (const int side : {1, -1}) {
        const double h =
            side > 0 ? spheres.position[i][k] - box.lower[k] : box.upper[k] - spheres.position[i][k];
        if (h >= spheres.radius[i])
          continue;
        force[i][k] += side * 2 * (spheres.radius[i] - h);
        ++contacts[i];
        touch(1 - h / spheres.radius[i], 2 * (spheres.radius[i] - h), h);
      }
  }
  sums.mean_overlap /= std::max(sums.contacts, 1.0);
  sums.mean_force /= std::max(sums.contacts, 1.0);
  double squares = 0;
  for (const Vec3& f : force)
    squares += f.squaredNorm() / static_cast<double>(spheres.size());
  sums.residual = sums.mean_force > 0 ? std::sqrt(squares) / sums.mean_force : 0;

  std::vector<char> held(spheres.size(), 1);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < held.size(); ++i)
      if (held[i] && contacts[i] < 4) {
        held[i] = 0;
        changed = true;
        for (const Pair& pair : pairs)
          if (pair.i == i || pair.j == i)
            --contacts[pair.i == i ? pair.j : pair.i];
      }
  }
  double ends = 0;
  for (std::size_t i = 0; i < held.size(); ++i) {
    sums.rattlers += held[i] ? 0U : 1U;
    ends += held[i] ? contacts[i] : 0;
  }
  sums.contact_number = ends / static_cast<double>(held.size() - sums.rattlers);
  return sums;
}

/// Whether two packings have the same spheres to the last bit.
inline bool same_bytes(const cdem::particles::ParticleSet& a, const cdem::particles::ParticleSet& b) {
  return a.size() == b.size() &&
         std::memcmp(a.position.data(), b.position.data(), a.size() * sizeof(Vec3)) == 0 &&
         std::memcmp(a.radius.data(), b.radius.data(), a.size() * sizeof(double)) == 0;
}

} // namespace sample
