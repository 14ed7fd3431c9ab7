#pragma once

/// @file
/// Particles as points with their radius, phase and motion.

#include <cdem/io/vtu.hpp>
#include <cdem/particles/motion.hpp>
#include <cdem/particles/particle_set.hpp>

namespace cdem::io {

/// What to write about the particles besides radius and phase; what is left empty is left out.
struct ParticleFields {
  std::span<const Vec3> displacement = {}; ///< [particles] m
  std::span<const Vec3> rotation = {};     ///< [particles] rad
  std::vector<DataArray> extra = {};       ///< any other array of one value a particle
  double time = 0;                         ///< s
  std::string title = {};
};

/// The fields of a body in motion: displacement, rotation, velocity and time.
/// @param motion  must live until the file is written
inline ParticleFields fields_of(const particles::Motion& motion) {
  const auto linear = [](std::string name, const particles::SpatialField<>& field) {
    return DataArray(std::move(name), field.size(),
                     [&field](std::size_t i) -> Vec3 { return field[i].linear(); });
  };
  const auto angular = [](std::string name, const particles::SpatialField<>& field) {
    return DataArray(std::move(name), field.size(),
                     [&field](std::size_t i) -> Vec3 { return field[i].angular(); });
  };
  ParticleFields fields;
  fields.extra = {linear("displacement [m]", motion.displacement),
                  angular("rotation [rad]", motion.displacement), linear("velocity [m/s]", motion.velocity)};
  fields.time = motion.time;
  return fields;
}

/// Writes particles as a `.vtu` file: point data "radius [m]", "phase" and, where given, "displacement [m]" and
/// "rotation [rad]". In ParaView: Glyph, sphere of radius 1, scaled by "radius [m]".
///
/// @throws core::InvalidInput for an array that does not have one value a particle, or particles that are not valid
/// @throws core::FileError    if the file cannot be written; nothing is left behind
/// @complexity O(particles), no copy of the data
inline void write_particles_vtu(const std::filesystem::path& path, const particles::ParticleSet& particles,
                                const ParticleFields& fields = {}) {
  particles.validate();
  Vtu grid(particles.position);
  grid.vertices();
  grid.point_data({"radius [m]", particles.radius});
  grid.point_data({"phase", particles.phase});
  if (!fields.displacement.empty())
    grid.point_data({"displacement [m]", fields.displacement});
  if (!fields.rotation.empty())
    grid.point_data({"rotation [rad]", fields.rotation});
  for (const DataArray& array : fields.extra)
    grid.point_data(array);
  grid.field_data("TimeValue", fields.time);
  if (!fields.title.empty())
    grid.field_data("title", fields.title);
  grid.write(path);
}

} // namespace cdem::io
