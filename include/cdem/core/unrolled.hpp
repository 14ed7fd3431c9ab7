#pragma once

/// @file
/// Short loops written out.

#include <cstddef>
#include <utility>

namespace cdem::core {

/// Calls use(0) to use(count - 1); written out, as compilers do not unroll such a loop at -O2 and would keep what it runs
/// over in memory instead of registers.
///
/// @param use  void(std::size_t), a lambda that is always inlined
template <std::size_t count, class Use>
[[gnu::always_inline]] inline void unrolled(Use&& use) {
  [&]<std::size_t... k>(std::index_sequence<k...>) __attribute__((always_inline)) {
    (use(k), ...);
  }
  (std::make_index_sequence<count>{});
}

} // namespace cdem::core
