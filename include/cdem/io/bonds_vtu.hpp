#pragma once

/// @file
/// Bonds as lines with their force.

#include <cdem/io/vtu.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/particles/particle_set.hpp>

namespace cdem::io {

/// What to write about the bonds besides length and phases; what is left empty is left out.
struct BondFields {
  std::span<const Vec3> force = {};        ///< [bonds] N, on each bond's first particle
  std::span<const Vec3> displacement = {}; ///< [particles] m, so that the lines can be warped
  std::vector<DataArray> extra = {};       ///< any other array of one value a bond
  double time = 0;                         ///< s
  std::string title = {};
};

namespace detail {

/// Bonds that do not end at their second particle but at an image of it: those through a periodic face.
inline std::vector<BondIndex> bonds_to_images(const particles::ParticleSet& particles,
                                              const network::BondNetwork& network) {
  std::vector<BondIndex> bonds;
  for (BondIndex b = 0; b < network.size(); ++b) {
    const Vec3 straight = particles.position[network.second[b]] - particles.position[network.first[b]];
    if ((straight - network.branch[b]).norm() > 0.5 * network.branch[b].norm())
      bonds.push_back(b);
  }
  return bonds;
}

} // namespace detail

/// Writes bonds as a `.vtu` file of lines: cell data "length [m]" (at rest), "phases" (of the first and the second
/// particle) and, where given, "force [N]" (on the first particle) and "normal force [N]" (tension positive).
///
/// The points are the particles, so that point p is particle p. A bond through a periodic face is drawn from its
/// first particle along the branch, to a point of its own, not across the box.
///
/// @throws core::InvalidInput for an array of another length than asked, or a network that does not fit the particles
/// @throws core::FileError    if the file cannot be written; nothing is left behind
/// @complexity O(bonds); memory: one number for each bond through a periodic face
inline void write_bonds_vtu(const std::filesystem::path& path, const particles::ParticleSet& particles,
                            const network::BondNetwork& network, const BondFields& fields = {}) {
  particles.validate();
  network.validate();
  core::expect(network.particle_count == particles.size(), "particle_count of the network",
               network.particle_count,
               "the number of particles, " + std::to_string(particles.size()) + ", is expected");
  core::expect(fields.force.empty() || fields.force.size() == network.size(), "number of bond forces",
               fields.force.size(), "one a bond (" + std::to_string(network.size()) + ") is expected");
  core::expect(fields.displacement.empty() || fields.displacement.size() == particles.size(),
               "number of displacements", fields.displacement.size(),
               "one a particle (" + std::to_string(particles.size()) + ") is expected");

  const std::size_t count = particles.size();
  const std::vector<BondIndex> to_image = detail::bonds_to_images(particles, network);
  Vtu grid(count + to_image.size(), [&](std::size_t p) -> Vec3 {
    if (p < count)
      return particles.position[p];
    const BondIndex b = to_image[p - count];
    return particles.position[network.first[b]] + network.branch[b];
  });
  grid.cells(CellType::line, network.size(), [&](std::size_t k) -> std::size_t {
    const BondIndex b = k / 2;
    if (k % 2 == 0)
      return network.first[b];
    const auto image = std::lower_bound(to_image.begin(), to_image.end(), b);
    if (image == to_image.end() || *image != b)
      return network.second[b];
    return count + static_cast<std::size_t>(image - to_image.begin());
  });

  grid.cell_data({"length [m]", network.size(), [&](std::size_t b) { return network.branch[b].norm(); }});
  grid.cell_data({"phases", network.size(), [&](std::size_t b) {
                    return std::array{particles.phase[network.first[b]], particles.phase[network.second[b]]};
                  }});
  if (!fields.force.empty()) {
    grid.cell_data({"force [N]", fields.force});
    grid.cell_data({"normal force [N]", network.size(), [&](std::size_t b) {
                      return fields.force[b].dot(network.branch[b]) / network.branch[b].norm();
                    }});
  }
  for (const DataArray& array : fields.extra)
    grid.cell_data(array);
  if (!fields.displacement.empty())
    grid.point_data({"displacement [m]", grid.point_count(), [&](std::size_t p) -> Vec3 {
                       return fields.displacement[p < count ? p : network.second[to_image[p - count]]];
                     }});
  grid.field_data("TimeValue", fields.time);
  if (!fields.title.empty())
    grid.field_data("title", fields.title);
  grid.write(path);
}

} // namespace cdem::io
