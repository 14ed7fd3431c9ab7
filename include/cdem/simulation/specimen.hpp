#pragma once

/// @file
/// From a packing to a bonded body.

#include <cdem/network/bonds.hpp>
#include <cdem/packing/packing_generator.hpp>
#include <cdem/particles/space_filling_order.hpp>

#include <utility>

namespace cdem::simulation {

/// A bonded body: the equivalent continuous domain of [L17] section 2.1.
struct Specimen {
  particles::ParticleSet particles; ///< in space-filling order
  geometry::Box box;                ///< walled, a periodic packing being cut at its faces, or periodic
  network::BondNetwork network;
  double eps = 0; ///< of eq. 1: bonded where the gap of two surfaces is at most eps*D

  /// Widest gap of two bonded surfaces, eps*D, m; 0 where bonded particles all overlap.
  double gap() const { return std::max(0.0, eps * network::characteristic_length(box)); }
  /// Volume of the spheres over that of the box.
  double density() const { return particles.solid_volume() / box.volume(); }
};

/// Orders a packing's particles along a Hilbert curve and bonds the closest pairs, through the box's periodic faces too.
///
/// @param coordination  Z = 2 bonds / particles, [L17] section 2.1: 6.2
/// @throws              core::InvalidInput for particles or a coordination number that are not accepted
/// @complexity          O(particles log particles)
inline Specimen make_periodic_specimen(const particles::ParticleSet& particles, const geometry::Box& box,
                                       double coordination, core::ThreadPool& pool) {
  Specimen specimen;
  specimen.box = box;
  specimen.particles = particles::reorder(particles, particles::space_filling_order(particles, specimen.box));
  auto bonds = network::bonds_at_coordination(specimen.particles, specimen.box, coordination, pool);
  specimen.network = std::move(bonds.network);
  specimen.eps = bonds.eps;
  return specimen;
}

/// The same with free faces: cuts a packing out of its box.
///
/// @param coordination  as above. In a body cut from a periodic packing the particles at the faces lack neighbours, and
///                      eps is larger than within the periodic packing.
inline Specimen make_specimen(const particles::ParticleSet& particles, const geometry::Box& box,
                              double coordination, core::ThreadPool& pool) {
  return make_periodic_specimen(particles, box.without_periodicity(), coordination, pool);
}

} // namespace cdem::simulation
