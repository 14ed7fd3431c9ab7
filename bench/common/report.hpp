#pragma once

/// @file
/// Counters that all benchmarks give.

#include <benchmark/benchmark.h>

#include <cstddef>
#include <string>

#include "stream.hpp"

namespace bench {

/// Nanoseconds in every item, and the least that memory would need for the bytes it moves: `bound` = bytes an item /
/// the triad's speed on as many threads. Data that stay in a cache may be faster.
inline void count_items(benchmark::State& state, double items_per_iteration, double bytes_per_item,
                        int threads) {
  static const double one = triad_bandwidth(1), two = triad_bandwidth(2);
  using benchmark::Counter;
  state.counters["ns"] =
      Counter(1e-9 * items_per_iteration, Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["bound_ns"] = 1e9 * bytes_per_item / (threads == 1 ? one : two);
  state.counters["triad_GBps"] = 1e-9 * (threads == 1 ? one : two);
}

} // namespace bench
