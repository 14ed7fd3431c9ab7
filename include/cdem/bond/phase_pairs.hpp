#pragma once

/// @file
/// A number for each pair of phases: cohesion, strength.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace cdem::bond {

/// A number for each pair of phases, the same in both orders. A phase with itself is a pair too.
struct PhasePairs {
  struct Pair {
    PhaseIndex first = 0;
    PhaseIndex second = 0;
    double value = 0;

    bool is(PhaseIndex a, PhaseIndex b) const {
      return (first == a && second == b) || (first == b && second == a);
    }
  };

  double otherwise = 0;         ///< of pairs that are not listed
  std::vector<Pair> pairs = {}; ///< each pair at most once

  /// @complexity O(listed pairs)
  double between(PhaseIndex a, PhaseIndex b) const {
    for (const Pair& pair : pairs)
      if (pair.is(a, b))
        return pair.value;
    return otherwise;
  }

  /// @param accepts   bool(double)
  /// @param name      how messages call the number
  /// @param accepted  what messages say is accepted
  /// @throws core::InvalidInput for a number that is not accepted, or a pair that is listed twice
  template <class Accepts>
  void validate(std::string_view name, Accepts&& accepts, std::string_view accepted) const {
    core::expect(accepts(otherwise), name, otherwise, accepted);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const Pair& pair = pairs[k];
      const std::string of_pair = std::string(name) + " of phases " + std::to_string(int{pair.first}) +
                                  " and " + std::to_string(int{pair.second});
      core::expect(accepts(pair.value), of_pair, pair.value, accepted);
      for (std::size_t before = 0; before < k; ++before)
        core::expect(!pairs[before].is(pair.first, pair.second), of_pair, pair.value,
                     "it was given before, as " + core::to_text(pairs[before].value));
    }
  }
};

} // namespace cdem::bond
