#pragma once

/// @file
/// Crystals of equal spheres: packings whose every property is known exactly.

#include <cdem/core/error.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/packing/packing_generator.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace cdem::packing {

/// Which crystal; contacts of a sphere and density where nearest spheres touch.
enum class LatticeKind : std::uint8_t {
  simple_cubic,          ///< 6 contacts, pi/6 = 0.5236
  body_centred_cubic,    ///< 8, pi sqrt(3)/8 = 0.6802
  face_centred_cubic,    ///< 12, pi/sqrt(18) = 0.7405
  hexagonal_close_packed ///< 12, pi/sqrt(18) = 0.7405; stacking ABAB, ideal axis ratio sqrt(8/3)
};

namespace detail {

/// The rectangular cell that a crystal repeats, with nearest neighbours 1 apart.
struct LatticeCell {
  Vec3 edges;
  std::vector<Vec3> points; ///< in parts of the edges, all inside [0, 1)
};

inline LatticeCell lattice_cell(LatticeKind kind) {
  const double root2 = std::sqrt(2.0), root3 = std::sqrt(3.0);
  switch (kind) {
  case LatticeKind::simple_cubic:
    return {Vec3::Ones(), {{0.5, 0.5, 0.5}}};
  case LatticeKind::body_centred_cubic:
    return {Vec3::Constant(2 / root3), {{0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}}};
  case LatticeKind::face_centred_cubic:
    return {Vec3::Constant(root2),
            {{0.25, 0.25, 0.25}, {0.25, 0.75, 0.75}, {0.75, 0.25, 0.75}, {0.75, 0.75, 0.25}}};
  case LatticeKind::hexagonal_close_packed:
    return {
        Vec3(1, root3, std::sqrt(8.0 / 3.0)),
        {{0.25, 1.0 / 12, 0.25}, {0.75, 7.0 / 12, 0.25}, {0.25, 5.0 / 12, 0.75}, {0.75, 11.0 / 12, 0.75}}};
  }
  core::reject("kind of lattice", static_cast<int>(kind), "0 to 3 (sc, bcc, fcc, hcp) is expected");
}

} // namespace detail

/// A crystal, for verification: density, contacts, neighbour shells and structure factor are known exactly.
///
/// Spheres stand on the points of a lattice whose rectangular cell (of 1, 2, 4 or 4 spheres) is repeated along the
/// axes; the box is that many cells, a cube for cubic lattices and equal numbers alone. The points are shifted so that none
/// lies on a face.
/// @complexity  O(spheres)
class Lattice {
public:
  struct Parameters {
    LatticeKind kind = LatticeKind::face_centred_cubic;
    std::array<std::uint32_t, 3> cells{4, 4, 4}; ///< along x, y, z
    double radius = 0.5e-3;                      ///< of the spheres, m
    double spacing = 1; ///< distance of nearest centres over the diameter: 1 touch, below 1 overlap
    bool periodic =
        true; ///< false: the same box with open faces, through which outer spheres of bcc, fcc, hcp reach
  };

  struct Report {
    double density = 0; ///< the spheres' volume over the box's; overlaps count twice
  };

  /// @throws core::InvalidInput  for no cells along an axis, more than 2^32 - 1 spheres, a radius that is not positive,
  ///                             or a spacing outside 0.1 to 100
  explicit Lattice(const Parameters& parameters) : parameters_(parameters) {
    const auto& cells = parameters.cells;
    double count = static_cast<double>(detail::lattice_cell(parameters.kind).points.size());
    for (std::size_t k = 0; k < 3; ++k) {
      core::expect(cells[k] > 0, std::string("cells along ") + "xyz"[k], cells[k], "1 or more is expected");
      count *= cells[k];
    }
    core::expect(count <= std::numeric_limits<ParticleIndex>::max(), "number of particles", count,
                 "at most 2^32 - 1 is expected");
    core::expect_positive(parameters.radius, "radius of the spheres", "m");
    core::expect(parameters.spacing >= 0.1 && parameters.spacing <= 100, "spacing", parameters.spacing,
                 "0.1 to 100 diameters is expected");
  }

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Places the spheres, cell by cell, x first. It is too quick for the monitor to hear of it.
  Packing<Report> pack(const core::Monitor& = core::Monitor()) const {
    const detail::LatticeCell cell = detail::lattice_cell(parameters_.kind);
    const Vec3 edges = cell.edges * (2 * parameters_.radius * parameters_.spacing);
    const auto& [nx, ny, nz] = parameters_.cells;
    const bool periodic = parameters_.periodic;
    Packing<Report> packing;
    packing.box = {Vec3::Zero(), edges.cwiseProduct(Vec3(nx, ny, nz)), {periodic, periodic, periodic}};
    packing.particles.resize(std::size_t{nx} * ny * nz * cell.points.size());
    std::size_t next = 0;
    for (std::uint32_t c = 0; c < nz; ++c)
      for (std::uint32_t b = 0; b < ny; ++b)
        for (std::uint32_t a = 0; a < nx; ++a)
          for (const Vec3& point : cell.points)
            packing.particles.position[next++] = edges.cwiseProduct(Vec3(a, b, c) + point);
    packing.particles.radius.assign(next, parameters_.radius);
    packing.report.density = packing.particles.solid_volume() / packing.box.volume();
    return packing;
  }

private:
  Parameters parameters_;
};

static_assert(PackingGenerator<Lattice>);

} // namespace cdem::packing
