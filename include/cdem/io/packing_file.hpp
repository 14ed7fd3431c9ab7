#pragma once

/// @file
/// Packings kept in a file: a good one is worth hours.

#include <cdem/geometry/box.hpp>
#include <cdem/io/checkpoint.hpp>
#include <cdem/particles/particle_set.hpp>

#include <cmath>

namespace cdem::io {

/// What a packing file holds.
struct PackingFile {
  particles::ParticleSet particles;
  geometry::Box box;
  std::string parameters; ///< how it was made: free text
  std::string report;     ///< what its generator said of it: free text
};

/// How many digits a packing file keeps.
enum class PackingDigits : std::uint8_t {
  all,    ///< reads back to the same bits; 32 bytes a sphere, 24 where all radii are equal
  compact ///< 16 bytes a sphere, 12 where all radii are equal; see save_packing()
};

/// What goes into a packing file beside the spheres.
struct PackingNotes {
  std::string_view parameters = ""; ///< how the packing was made, one `name = value` a line by custom
  std::string_view report = "";     ///< what the generator says of it, likewise
  PackingDigits digits = PackingDigits::all;
};

namespace detail {

/// A coordinate as a part of the edge, in steps of 2^-32 of it.
inline std::uint32_t edge_fraction(double coordinate, double lower, double edge) {
  const double steps = std::floor((coordinate - lower) / edge * 0x1p32);
  return static_cast<std::uint32_t>(std::clamp(steps, 0.0, 0x1p32 - 1));
}

inline void add_compact(CheckpointWriter& file, const particles::ParticleSet& particles,
                        const geometry::Box& box) {
  std::vector<std::array<std::uint32_t, 3>> fractions(particles.size());
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    const Vec3 point = box.wrap(particles.position[i]);
    for (int k = 0; k < 3; ++k) {
      if (!(point[k] >= box.lower[k] && point[k] <= box.upper[k]))
        core::reject(std::string("position ") + "xyz"[k] + " of particle " + std::to_string(i), point[k],
                     "a centre inside the box is expected in a compact packing file");
      fractions[i][static_cast<std::size_t>(k)] =
          edge_fraction(point[k], box.lower[k], box.upper[k] - box.lower[k]);
    }
  }
  file.add("position in 2^-32 of the edges", fractions);
}

inline void read_compact(const CheckpointReader& file, particles::ParticleSet& particles,
                         const geometry::Box& box) {
  const auto fractions = file.read<std::array<std::uint32_t, 3>>("position in 2^-32 of the edges");
  particles.position.resize(fractions.size());
  for (std::size_t i = 0; i < fractions.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      particles.position[i][axis] =
          box.lower[axis] + (fractions[i][k] + 0.5) * 0x1p-32 * (box.upper[axis] - box.lower[axis]);
    }
}

} // namespace detail

/// Saves particles and their box as a checkpoint: self-checking on loading (length, checksum, version; see checkpoint.hpp).
///
/// Phases are left out where all are 0, and equal radii are kept once. In the compact form a coordinate is the middle of one of
/// 2^32 equal parts of the edge, at most 2^-33 of the edge off, and a radius a float, at most 6e-8 of itself off: at
/// 1,000,000 spheres about 2e-8 of a diameter, far below any gap that bonds are made by (eps D is 1e-3 to 1e-1 of a
/// diameter), but not below the gaps of a packing jammed at a pressure above 1e6. Only centres inside the box can be kept so.
/// @throws core::InvalidInput if particles or box are not valid, or a centre lies outside the walls in the compact form
/// @throws core::FileError    if the file cannot be written; nothing is left behind
/// @complexity O(particles), no copy of the particles but in the compact form
inline void save_packing(const std::filesystem::path& path, const particles::ParticleSet& particles,
                         const geometry::Box& box, const PackingNotes& notes = {}) {
  particles.validate();
  box.validate();
  CheckpointWriter file(path);
  const bool compact = notes.digits == PackingDigits::compact;
  if (compact)
    detail::add_compact(file, particles, box);
  else
    file.add("position", particles.position);
  const auto& radius = particles.radius;
  const bool equal = std::all_of(radius.begin(), radius.end(), [&](double r) { return r == radius[0]; });
  if (equal)
    file.add("radius", std::span(radius).first(1));
  else if (compact)
    file.add("radius in single precision", std::vector<float>(radius.begin(), radius.end()));
  else
    file.add("radius", radius);
  if (std::any_of(particles.phase.begin(), particles.phase.end(),
                  [](PhaseIndex phase) { return phase != 0; }))
    file.add("phase", particles.phase);
  file.add("box", std::array{box.lower.x(), box.lower.y(), box.lower.z(), box.upper.x(), box.upper.y(),
                             box.upper.z()});
  std::array<std::uint8_t, 3> periodic{};
  for (std::size_t k = 0; k < 3; ++k)
    periodic[k] = box.periodic[k] ? 1 : 0;
  file.add("periodic", periodic);
  file.add("parameters", notes.parameters);
  file.add("report", notes.report);
  file.commit();
}

/// Loads what save_packing() wrote, to the same bits unless it was compact.
///
/// @throws core::FileError naming the file if it is missing, damaged, or holds no valid packing
inline PackingFile load_packing(const std::filesystem::path& path) {
  const CheckpointReader file(path);
  PackingFile packing;
  particles::ParticleSet& particles = packing.particles;
  const bool compact = file.has("position in 2^-32 of the edges");
  if (!compact)
    file.read("position", particles.position);
  const auto corners = file.read<double>("box");
  const auto periodic = file.read<std::uint8_t>("periodic");
  if (corners.size() != 6 || periodic.size() != 3)
    file.fail("its box is not given by 6 coordinates and 3 marks");
  packing.box = {Vec3(corners[0], corners[1], corners[2]),
                 Vec3(corners[3], corners[4], corners[5]),
                 {periodic[0] != 0, periodic[1] != 0, periodic[2] != 0}};
  if (compact)
    detail::read_compact(file, particles, packing.box);
  const std::size_t count = particles.size();
  if (!file.has("radius in single precision")) {
    file.read("radius", particles.radius);
    if (particles.radius.size() == 1)
      particles.radius.assign(count, particles.radius[0]);
  } else {
    const auto radius = file.read<float>("radius in single precision");
    particles.radius.assign(radius.begin(), radius.end());
  }
  if (file.has("phase"))
    file.read("phase", particles.phase);
  else
    particles.phase.assign(count, PhaseIndex{0});
  packing.parameters = file.read_text("parameters");
  if (file.has("report"))
    packing.report = file.read_text("report");
  try {
    particles.validate();
    packing.box.validate();
  } catch (const core::InvalidInput& invalid) {
    file.fail(invalid.what());
  }
  return packing;
}

} // namespace cdem::io
