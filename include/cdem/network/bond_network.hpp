#pragma once

/// @file
/// Which particles are joined, and along which branch.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace cdem::network {

/// Bonds between particles, a structure of arrays sorted by (first, second), with first < second.
///
/// A bond is 32 bytes. The branch is kept because it cannot be had from the positions alone where a bond runs
/// through a periodic face.
struct BondNetwork {
  std::size_t particle_count = 0;
  std::vector<ParticleIndex> first;  ///< [bonds]
  std::vector<ParticleIndex> second; ///< [bonds]
  std::vector<Vec3> branch;          ///< [bonds] from the first particle's centre to the second's at rest, m

  std::size_t size() const noexcept { return first.size(); }

  /// Coordination number Z = 2 bonds / particles, [L17] section 2.1.
  double coordination() const {
    return particle_count == 0 ? 0 : 2.0 * static_cast<double>(size()) / static_cast<double>(particle_count);
  }

  /// @throws core::InvalidInput for arrays of different lengths, an end outside the particles, a bond of a particle
  ///         with itself, or a branch that is not a finite vector of positive length; names the first such bond
  void validate() const {
    core::expect(second.size() == size() && branch.size() == size(), "number of bonds", size(),
                 "first, second and branch of one length are expected");
    for (std::size_t b = 0; b < size(); ++b) {
      if (first[b] >= particle_count)
        core::reject("first particle of bond " + std::to_string(b), first[b],
                     "a number below " + std::to_string(particle_count) + " is expected");
      if (second[b] >= particle_count || second[b] == first[b])
        core::reject("second particle of bond " + std::to_string(b), second[b],
                     "a number below " + std::to_string(particle_count) +
                         " other than the first's is expected");
      const double length = branch[b].norm();
      if (!(std::isfinite(length) && length > 0))
        core::reject("length of bond " + std::to_string(b), length,
                     "a finite length above 0 m is expected: do two particles share one centre?");
    }
  }
};

} // namespace cdem::network
