#pragma once

/// @file
/// A periodic packing repeated: millions of spheres for the price of thousands, and what that costs.

#include <cdem/core/error.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/packing/packing_generator.hpp>

#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

namespace cdem::packing {

/// A periodic packing repeated k x k x k, with its box: k^3 times the spheres in k^3 times the volume.
///
/// Sphere i of copy c = (a, b, c) is number i + n (a + k (b + k c)), with n spheres in a copy; phases are repeated too.
/// @param copies  k, 1 or more
/// @throws        core::InvalidInput if the box is not periodic in all directions (copies of a packing between walls do not
///                fit each other), k is 0, or there would be more than 2^32 - 1 spheres
/// @complexity    O(k^3 spheres)
inline std::pair<particles::ParticleSet, geometry::Box> tile(const particles::ParticleSet& particles,
                                                             const geometry::Box& box, std::uint32_t copies) {
  particles.validate();
  box.validate();
  for (std::size_t k = 0; k < 3; ++k)
    core::expect(box.periodic[k], std::string("box along ") + "xyz"[k], "walled",
                 "a periodic packing is expected: copies of one between walls do not fit each other");
  core::expect(copies > 0, "copies", copies, "1 or more is expected");
  const std::size_t n = particles.size();
  core::expect(static_cast<double>(n) * copies * copies * copies <= std::numeric_limits<ParticleIndex>::max(),
               "copies", copies, "at most 2^32 - 1 spheres in all are expected");

  const Vec3 edges = box.size();
  std::pair<particles::ParticleSet, geometry::Box> tiled{{}, box};
  tiled.second.upper = box.lower + edges * copies;
  tiled.first.resize(n * copies * copies * copies);
  std::size_t next = 0;
  for (std::uint32_t c = 0; c < copies; ++c)
    for (std::uint32_t b = 0; b < copies; ++b)
      for (std::uint32_t a = 0; a < copies; ++a)
        for (std::size_t i = 0; i < n; ++i, ++next) {
          tiled.first.position[next] = box.wrap(particles.position[i]) + edges.cwiseProduct(Vec3(a, b, c));
          tiled.first.radius[next] = particles.radius[i];
          tiled.first.phase[next] = particles.phase[i];
        }
  return tiled;
}

/// The packing of another generator, periodic, repeated k x k x k.
///
/// Everything that depends on pairs of near spheres (density, contact numbers, g(r) up to half the edge of a copy, the
/// directions of bonds) is that of one copy: E_k does not fall as 1/sqrt(bonds) but stays what it is in the copy. Nothing
/// exists at wavelengths between the edge of a copy and that of the box: the structure factor is exactly 0 there, and the
/// scatter of moduli over seeds is that of one copy under periodic loads. k^3 copies are one sample, not k^3.
/// docs/packing_files.md has the numbers.
/// @tparam Generator  of one copy; the box it fills must be periodic
/// @complexity        that of Generator, and O(spheres)
template <PackingGenerator Generator>
class Tiled {
public:
  struct Parameters {
    typename Generator::Parameters base = {}; ///< of one copy; its lengths are not rescaled
    std::uint32_t copies = 2;                 ///< k, along each axis
  };

  struct Report {
    double density = 0;
    typename Generator::Report base = {}; ///< of the copy
  };

  /// @throws core::InvalidInput  for parameters that Generator does not accept, or copies outside 1 to 1625 (where single
  ///                             spheres would be too many)
  explicit Tiled(const Parameters& parameters) : parameters_(parameters), generator_(parameters.base) {
    core::expect(parameters.copies >= 1 && parameters.copies <= 1625, "copies", parameters.copies,
                 "1 to 1625 is expected");
  }

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Packs one copy and repeats it.
  /// @throws core::InvalidInput  if the copy's box is not periodic; what Generator throws
  Packing<Report> pack(const core::Monitor& monitor = core::Monitor()) {
    auto base = generator_.pack(monitor);
    Packing<Report> packing;
    std::tie(packing.particles, packing.box) = tile(base.particles, base.box, parameters_.copies);
    packing.report.density = base.report.density;
    packing.report.base = std::move(base.report);
    return packing;
  }

private:
  Parameters parameters_;
  Generator generator_;
};

} // namespace cdem::packing
