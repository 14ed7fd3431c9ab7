#pragma once

/// @file
/// What a packing generator is, and what it returns.

#include <cdem/core/progress.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/particles/particle_set.hpp>

#include <concepts>
#include <cstdint>

namespace cdem::packing {

/// What bounds the cube that is packed.
enum class Boundary : std::uint8_t {
  periodic, ///< the opposite face follows
  walls     ///< six flat walls
};

/// Spheres in a box, with the account their generator gives of them.
template <class ReportType>
struct Packing {
  using Report = ReportType;
  particles::ParticleSet particles; ///< centres inside the box, all of phase 0
  geometry::Box box;
  Report report;
};

/// Has `Parameters`, from which it is made; bad ones throw core::InvalidInput in the constructor.
template <class G>
concept HasParameters = requires {
  typename G::Parameters;
}
&&std::constructible_from<G, typename G::Parameters>;

/// Has `Report`, which says at least the density reached (the spheres' volume over the box's).
template <class G>
concept HasDensityReport = requires(const typename G::Report& report) {
  { report.density } -> std::convertible_to<double>;
};

/// `generator.pack(monitor)` makes the packing.
template <class G>
concept Packs = requires(G generator, const core::Monitor& monitor) {
  { generator.pack(monitor) } -> std::same_as<Packing<typename G::Report>>;
};

/// A way to fill a box with spheres. Models: LubachevskyStillinger, SoftSpheres, Lattice, Tiled, io::FromFile.
template <class G>
concept PackingGenerator = HasParameters<G> && HasDensityReport<G> && Packs<G>;

} // namespace cdem::packing
