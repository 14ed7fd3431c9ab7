#pragma once

/// @file
/// How evenly the bonds point in all directions.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>
#include <cdem/network/bond_network.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>

namespace cdem::network {

/// Root-mean-square deviation from the even share 1/N_c that chance alone gives to n isotropic bonds.
///
/// sqrt(E[E_k^2]) = sqrt( (1/N_c)(1 - 1/N_c)/n ), since n P_i is binomial with n draws of probability 1/N_c
/// @param bonds    n, above 0
/// @param classes  N_c, at least 1
/// @throws         core::InvalidInput if either is 0
inline double isotropic_deviation(std::uint64_t bonds, std::size_t classes = 32) {
  core::expect(bonds > 0, "number of bonds", bonds, "at least 1 is expected");
  core::expect(classes > 0, "number of angle classes", classes, "at least 1 is expected");
  const double share = 1 / static_cast<double>(classes);
  return std::sqrt(share * (1 - share) / static_cast<double>(bonds));
}

/// Distribution of the bonds' angles in the three coordinate planes.
///
/// Plane k is that orthogonal to axis k: (y, z), (z, x), (x, y) for k = 0, 1, 2; the angle runs from its first axis to
/// its second.
template <std::size_t Classes = 32>
struct Anisotropy {
  std::array<double, 3> deviation{};                     ///< E_k of eq. 2
  std::array<std::array<double, Classes>, 3> fraction{}; ///< P_i^k; the classes of a plane add up to 1
  std::array<std::uint64_t, 3> bonds{};                  ///< bonds that have a direction in the plane

  /// Angle in the middle of class i, rad in [0, pi): i pi/N_c.
  static constexpr double angle(std::size_t i) {
    return static_cast<double>(i) * std::numbers::pi / static_cast<double>(Classes);
  }
};

/// Geometric anisotropy of a network.
///
/// E_k = sqrt( (1/N_c) sum_i (P_i^k - 1/N_c)^2 )                                        [L17] eq. 2, N_c = 32
///
/// P_i^k is the share of the bonds, projected on the plane orthogonal to axis k, whose angle falls in class i. A bond
/// has a line but no sense: its angle is taken modulo pi, and the N_c classes, pi/N_c wide, share the half turn. Angles
/// of one sense over the full turn would depend on how the particles are numbered; both senses over the full turn
/// would count each bond twice, in 16 independent classes only. Class i is centred on i pi/N_c, so that the axes and the
/// diagonals lie in the middle of a class, not on the border of two. A bond along axis k (within 1e-9) has no
/// direction in the plane and is left out there.
/// @tparam Classes  N_c, at least 2
/// @deviation       the paper does not say whether one sense, both or the line is counted
/// @throws          core::InvalidInput for a network that is not valid or has no bond with a direction in a plane
/// @complexity      O(bonds)
template <std::size_t Classes = 32>
Anisotropy<Classes> anisotropy(const BondNetwork& network) {
  static_assert(Classes >= 2, "one class alone cannot deviate from the even share");
  network.validate();
  Anisotropy<Classes> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto along = static_cast<Eigen::Index>((k + 1) % 3);
    const auto across = static_cast<Eigen::Index>((k + 2) % 3);
    std::array<std::uint64_t, Classes> count{};
    for (const Vec3& branch : network.branch) {
      if (std::hypot(branch[along], branch[across]) <= 1e-9 * branch.norm())
        continue;
      const double angle = std::atan2(branch[across], branch[along]); // [-pi, pi]
      const long nearest =
          std::lround(angle * (static_cast<double>(Classes) / std::numbers::pi));        // [-N_c, N_c]
      ++count[static_cast<std::size_t>(nearest + static_cast<long>(Classes)) % Classes]; // modulo pi
      ++result.bonds[k];
    }
    core::expect(result.bonds[k] > 0,
                 std::string("number of bonds with a direction across the ") + "xyz"[k] + " axis",
                 result.bonds[k], "at least 1 is expected");
    double sum = 0;
    for (std::size_t i = 0; i < Classes; ++i) {
      result.fraction[k][i] = static_cast<double>(count[i]) / static_cast<double>(result.bonds[k]);
      const double difference = result.fraction[k][i] - 1 / static_cast<double>(Classes);
      sum += difference * difference;
    }
    result.deviation[k] = std::sqrt(sum / static_cast<double>(Classes));
  }
  return result;
}

} // namespace cdem::network
