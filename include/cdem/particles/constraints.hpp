#pragma once

/// @file
/// Prescribed degrees of freedom: the vocabulary that boundaries write and integrators read.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace cdem::particles {

/// One degree of freedom moved at a constant rate: u(t) = rate * t. A rate of 0 holds it.
struct Constraint {
  ParticleIndex particle = 0;
  std::uint8_t dof = 0; ///< 0, 1, 2 translation along x, y, z; 3, 4, 5 rotation about x, y, z
  double rate = 0;      ///< m/s or rad/s; a static solver reads it at unit time, as m or rad

  friend bool operator<(const Constraint& a, const Constraint& b) {
    return a.particle != b.particle ? a.particle < b.particle : a.dof < b.dof;
  }
};

/// The prescribed degrees of freedom of a body, sorted by particle and degree of freedom, each once.
class Constraints {
public:
  /// Adds a prescribed degree of freedom. Adding it again with the same rate changes nothing.
  ///
  /// @throws core::InvalidInput for a dof above 5, a rate that is not finite, or another rate on the same dof
  /// @complexity O(1) when added in increasing order
  void add(Constraint constraint) {
    core::expect(constraint.dof < 6, "constrained degree of freedom", int{constraint.dof},
                 "0 to 5 is expected");
    core::expect_finite(constraint.rate,
                        "rate of the constraint on particle " + std::to_string(constraint.particle));
    auto place = list_.empty() || list_.back() < constraint
                     ? list_.end()
                     : std::lower_bound(list_.begin(), list_.end(), constraint);
    if (place != list_.end() && !(constraint < *place)) {
      core::expect(place->rate == constraint.rate,
                   "rate of the constraint on particle " + std::to_string(constraint.particle) +
                       ", degree of freedom " + std::to_string(constraint.dof),
                   constraint.rate, "it is already prescribed at " + core::to_text(place->rate));
      return;
    }
    list_.insert(place, constraint);
  }

  const std::vector<Constraint>& list() const noexcept { return list_; }
  std::size_t size() const noexcept { return list_.size(); }
  bool empty() const noexcept { return list_.empty(); }

private:
  std::vector<Constraint> list_;
};

} // namespace cdem::particles
