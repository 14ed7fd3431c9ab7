#pragma once

/// @file
/// What the bonds carry, as a stress estimator is given it.

#include <cdem/core/error.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/particles/particle_set.hpp>

#include <Eigen/Geometry> // cross product

#include <concepts>
#include <cstddef>
#include <span>
#include <string>

namespace cdem::stress {

/// Forces of the bonds and, where the law has them, the moments at their middles. A list of forces alone is taken for
/// bonds without moments.
///
/// Across a cut at the part s of the branch d (0 at the first particle, 1 at the second) what lies beyond pulls with the
/// force f and turns with the moment
///
///     T(s) = M + (1/2 - s) d x f
///
/// M being the moment at the middle: with the beam of [L17] section 2.2, T(0) = M + (L/2) n x f is the moment on the
/// first particle and -T(1) = -M + (L/2) n x f that on the second.
struct BondLoads {
  std::span<const Vec3> forces;  ///< [bonds] N, on the bond's first particle
  std::span<const Vec3> moments; ///< [bonds] N m, M: on the first half, half-way between the ends; or empty

  /// @param bond_forces   [bonds] N; must live as long as the loads are used
  /// @param bond_moments  [bonds] N m, or empty: no couple stress then
  template <class Forces>
  requires std::convertible_to<Forces, std::span<const Vec3>>
  BondLoads(Forces&& bond_forces, std::span<const Vec3> bond_moments = {})
      : forces(bond_forces), moments(bond_moments) {}

  bool has_moments() const noexcept { return !moments.empty(); }

  /// T(s), N m. Needs moments.
  Vec3 moment_at(std::size_t bond, const Vec3& branch, double s) const {
    return moments[bond] + (0.5 - s) * branch.cross(forces[bond]);
  }
};

namespace detail {

inline std::string text_of(const Vec3& vector) {
  return core::to_text(vector.x()) + " " + core::to_text(vector.y()) + " " + core::to_text(vector.z());
}

inline void expect_matching_sizes(const particles::ParticleSet& particles,
                                  const network::BondNetwork& network, const BondLoads& loads) {
  core::expect(network.particle_count == particles.size(), "number of particles of the network",
               network.particle_count,
               "that of the particle set, " + std::to_string(particles.size()) + ", is expected");
  core::expect(network.second.size() == network.size() && network.branch.size() == network.size(),
               "number of bonds", network.size(), "first, second and branch of one length are expected");
  core::expect(loads.forces.size() == network.size(), "number of forces", loads.forces.size(),
               "one per bond (" + std::to_string(network.size()) + ") is expected");
  core::expect(!loads.has_moments() || loads.moments.size() == network.size(), "number of moments",
               loads.moments.size(),
               "one per bond (" + std::to_string(network.size()) + ") is expected, or none at all");
}

/// Rejects a bond whose load, ends or branch cannot be used.
inline void expect_sound(const network::BondNetwork& network, const BondLoads& loads, std::size_t bond) {
  const auto name = [&](const char* what) { return what + std::string(" of bond ") + std::to_string(bond); };
  if (!loads.forces[bond].allFinite()) [[unlikely]]
    core::reject(name("force"), text_of(loads.forces[bond]), "a finite vector, in N, is expected");
  if (loads.has_moments() && !loads.moments[bond].allFinite()) [[unlikely]]
    core::reject(name("moment"), text_of(loads.moments[bond]), "a finite vector, in N m, is expected");
  if (network.first[bond] >= network.particle_count) [[unlikely]]
    core::reject(name("first particle"), network.first[bond],
                 "a number below " + std::to_string(network.particle_count) + " is expected");
  if (network.second[bond] >= network.particle_count) [[unlikely]]
    core::reject(name("second particle"), network.second[bond],
                 "a number below " + std::to_string(network.particle_count) + " is expected");
  const double square = network.branch[bond].squaredNorm();
  if (!(std::isfinite(square) && square > 0)) [[unlikely]]
    core::reject(name("branch"), text_of(network.branch[bond]),
                 "a finite vector of positive length, in m, is expected");
}

} // namespace detail

} // namespace cdem::stress
