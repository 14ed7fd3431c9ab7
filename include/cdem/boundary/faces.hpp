#pragma once

/// @file
/// Which particles make up the six faces of a body.

#include <cdem/core/error.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/network/coordination.hpp>
#include <cdem/particles/particle_set.hpp>

#include <array>
#include <string>
#include <vector>

namespace cdem::boundary {

/// The particles of one face of the box.
struct Face {
  std::vector<ParticleIndex> particles; ///< in increasing order
  double mean_position = 0;             ///< mean coordinate of their centres along the face's normal, m
};

/// The six faces of a body.
struct Faces {
  std::array<Face, 6> face; ///< lower x, upper x, lower y, upper y, lower z, upper z

  const Face& lower(Axis axis) const { return face[2 * static_cast<std::size_t>(axis)]; }
  const Face& upper(Axis axis) const { return face[2 * static_cast<std::size_t>(axis) + 1]; }

  /// Distance between the mean centres of the two faces along `axis`, m: the length over which the relative motion of
  /// the two faces is a strain. Shorter than the box, since centres lie inside the faces.
  double gauge_length(Axis axis) const { return upper(axis).mean_position - lower(axis).mean_position; }
};

/// The particles that reach each face: centre no farther from the plane than radius + tolerance.
///
/// Walled packings: the particles that touch the wall, [L17] section 2.3, a gap of `tolerance` allowed as between
/// bonded particles. Packings cut out of a periodic one: the spheres that the plane cuts; their centres are spread
/// over one radius inside the face, so that it is not flat.
/// Only particles of the network's largest cluster count: one that hangs on nothing says nothing of the body's motion.
/// @param tolerance  m, 0 or above; eps*D, the gap within which particles are bonded, is the natural choice
/// @throws           core::InvalidInput if no particle reaches one of the faces, or two opposite ones are reached by
///                   particles in one plane
/// @complexity       O(particles + bonds)
inline Faces find_faces(const particles::ParticleSet& particles, const network::BondNetwork& network,
                        const geometry::Box& box, double tolerance) {
  particles.validate();
  core::expect(network.particle_count == particles.size(), "number of particles of the network",
               network.particle_count,
               "that of the particle set, " + std::to_string(particles.size()) + ", is expected");
  const network::Clusters clusters = network::clusters(network);
  box.validate();
  core::expect_not_negative(tolerance, "tolerance of the faces", "m");
  Faces faces;
  for (std::size_t f = 0; f < 6; ++f) {
    const int axis = static_cast<int>(f / 2);
    const bool upper = f % 2 == 1;
    Face& face = faces.face[f];
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const double depth = upper ? box.upper[axis] - particles.position[i][axis]
                                 : particles.position[i][axis] - box.lower[axis];
      if (clusters.of[i] == clusters.largest && depth <= particles.radius[i] + tolerance) {
        face.particles.push_back(static_cast<ParticleIndex>(i));
        face.mean_position += particles.position[i][axis];
      }
    }
    core::expect(!face.particles.empty(),
                 std::string("number of particles on the ") + (upper ? "upper " : "lower ") + "xyz"[axis] +
                     " face",
                 face.particles.size(),
                 "at least 1 is expected: is the tolerance of " + core::to_text(tolerance) + " m too small?");
    face.mean_position /= static_cast<double>(face.particles.size());
  }
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    core::expect_positive(faces.gauge_length(axis),
                          std::string("distance of the two faces along ") + core::name_of(axis), "m");
  return faces;
}

} // namespace cdem::boundary
