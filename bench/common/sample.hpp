#pragma once

/// @file
/// The body every benchmark is measured on: a random packing at density 0.64 with 6.2 bonds a particle.

#include <cdem/bond/beam.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/core/random.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/network/bonds.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/particles/particle_set.hpp>
#include <cdem/particles/space_filling_order.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace bench {

using cdem::Vec3;
using Field = cdem::particles::SpatialField<>;

/// Particles in space-filling order, the cube they fill and their bonds.
struct Sample {
  cdem::particles::ParticleSet particles;
  cdem::geometry::Box box;
  cdem::network::BondNetwork network;
};

/// The mean number of bonds of a particle, [L17] section 2.1.
inline constexpr double coordination = 6.2;

/// Spheres of a periodic packing of 1000, repeated `edge` times along x, y and z.
inline Sample packed(std::size_t edge) {
  using cdem::packing::LubachevskyStillinger;
  static const auto tile =
      LubachevskyStillinger({.particles = 1000, .cov = 0.3, .growth_rate = 0.1, .seed = 1}).pack({});
  Sample sample;
  const double side = tile.box.size().x();
  sample.box = cdem::geometry::Box::cube(static_cast<double>(edge) * side, false);
  for (std::size_t x = 0; x < edge; ++x)
    for (std::size_t y = 0; y < edge; ++y)
      for (std::size_t z = 0; z < edge; ++z)
        for (std::size_t i = 0; i < tile.particles.size(); ++i) {
          const Vec3 shift =
              side * Vec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
          sample.particles.position.push_back(tile.particles.position[i] + shift);
          sample.particles.radius.push_back(tile.particles.radius[i]);
          sample.particles.phase.push_back(0);
        }
  sample.particles = cdem::particles::reorder(
      sample.particles, cdem::particles::space_filling_order(sample.particles, sample.box));
  cdem::core::ThreadPool pool(2);
  sample.network =
      cdem::network::bonds_at_coordination(sample.particles, sample.box, coordination, pool).network;
  return sample;
}

/// The sample nearest to `particles`, made once.
inline const Sample& sample(std::int64_t particles) {
  static std::map<std::size_t, Sample> samples;
  const auto edge = static_cast<std::size_t>(std::lround(std::cbrt(static_cast<double>(particles) / 1000)));
  const auto found = samples.find(edge);
  return found != samples.end() ? found->second : samples.emplace(edge, packed(edge)).first->second;
}

/// Alumina with the paper's microscopic parameters, [L17] section 3.2.
inline cdem::bond::Beam<> alumina() {
  return cdem::bond::Beam<>({.materials = {{2536e9, 0.545}}});
}

/// Displacements of a micrometre, rotations of a thousandth.
inline Field random_motion(std::size_t particles) {
  cdem::core::Random random(1);
  Field field(particles);
  for (auto& spatial : field)
    for (int dof = 0; dof < 6; ++dof)
      spatial[dof] = random.uniform(-1, 1) * (dof < 3 ? 1e-6 : 1e-3);
  return field;
}

/// Largest difference of two fields over the largest entry, forces and moments apart: proof that two codes that are
/// compared compute the same.
inline double relative_difference(const Field& a, const Field& b) {
  double worst = 0;
  for (const int first : {0, 3}) {
    double difference = 0, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      for (int dof = first; dof < first + 3; ++dof) {
        difference = std::max(difference, std::abs(a[i][dof] - b[i][dof]));
        largest = std::max(largest, std::abs(a[i][dof]));
      }
    worst = std::max(worst, difference / largest);
  }
  return worst;
}

} // namespace bench
