#pragma once

/// @file
/// The speed of memory, measured in the same run as what it bounds.

#include <cdem/core/parallel.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

namespace bench {

/// Bytes a second that `threads` threads move in a STREAM triad a = b + s c, [J. D. McCalpin, IEEE TCCA Newsletter
/// (1995)]: 24 bytes an element are counted, the line that a store first reads is not. Best of ten, over 192 MiB.
inline double triad_bandwidth(int threads) {
  constexpr std::size_t count = std::size_t{8} << 20;
  std::vector<double> a(count, 0), b(count, 1), c(count, 2);
  cdem::core::ThreadPool pool(threads);
  double best = 0;
  for (int repetition = 0; repetition < 10; ++repetition) {
    const double scale = 3 + repetition;
    const auto start = std::chrono::steady_clock::now();
    cdem::core::parallel_for(pool, count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        a[i] = b[i] + scale * c[i];
    });
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    best = std::max(best, 24.0 * count / time.count());
  }
  return best;
}

} // namespace bench
