#pragma once

/// @file
/// Packings kept in a file: a good one is worth hours.

#include <cdem/geometry/box.hpp>
#include <cdem/io/checkpoint.hpp>
#include <cdem/particles/particle_set.hpp>

namespace cdem::io {

/// What a packing file holds.
struct PackingFile {
  particles::ParticleSet particles;
  geometry::Box box;
  std::string parameters; ///< how it was made: free text
};

/// Saves particles and their box as a checkpoint with the sections position, radius, phase, box and parameters.
///
/// @param parameters  how the packing was made, one `name = value` a line by custom
/// @throws core::InvalidInput if particles or box are not valid
/// @throws core::FileError    if the file cannot be written; nothing is left behind
/// @complexity O(particles), no copy
inline void save_packing(const std::filesystem::path& path, const particles::ParticleSet& particles,
                         const geometry::Box& box, std::string_view parameters = "") {
  particles.validate();
  box.validate();
  CheckpointWriter file(path);
  file.add("position", particles.position);
  file.add("radius", particles.radius);
  file.add("phase", particles.phase);
  file.add("box", std::array{box.lower.x(), box.lower.y(), box.lower.z(), box.upper.x(), box.upper.y(),
                             box.upper.z()});
  std::array<std::uint8_t, 3> periodic{};
  for (std::size_t k = 0; k < 3; ++k)
    periodic[k] = box.periodic[k] ? 1 : 0;
  file.add("periodic", periodic);
  file.add("parameters", parameters);
  file.commit();
}

/// Loads what save_packing() wrote, to the same bits.
///
/// @throws core::FileError naming the file if it is missing, damaged, or holds no valid packing
inline PackingFile load_packing(const std::filesystem::path& path) {
  const CheckpointReader file(path);
  PackingFile packing;
  file.read("position", packing.particles.position);
  file.read("radius", packing.particles.radius);
  file.read("phase", packing.particles.phase);
  const auto corners = file.read<double>("box");
  const auto periodic = file.read<std::uint8_t>("periodic");
  if (corners.size() != 6 || periodic.size() != 3)
    file.fail("its box is not given by 6 coordinates and 3 marks");
  packing.box = {Vec3(corners[0], corners[1], corners[2]),
                 Vec3(corners[3], corners[4], corners[5]),
                 {periodic[0] != 0, periodic[1] != 0, periodic[2] != 0}};
  packing.parameters = file.read_text("parameters");
  try {
    packing.particles.validate();
    packing.box.validate();
  } catch (const core::InvalidInput& invalid) {
    file.fail(invalid.what());
  }
  return packing;
}

} // namespace cdem::io
