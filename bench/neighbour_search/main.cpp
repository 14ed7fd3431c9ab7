// All bonds within a gap, nanoseconds a particle: a hand-written grid of cells, beside the library's k-d tree, which
// also builds and sorts the network.

#include <cdem/core/parallel.hpp>
#include <cdem/network/bonds.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "../common/report.hpp"
#include "../common/sample.hpp"

namespace {

constexpr double eps = 1e-4; ///< of eq. 1

/// Pairs closer than eps D, counted from a grid of cells one largest cutoff wide.
std::size_t raw_pairs(const bench::Sample& sample) {
  const auto& position = sample.particles.position;
  const auto& radius = sample.particles.radius;
  const double side = sample.box.size().x(), gap = eps * side;
  const double cutoff = 2 * *std::max_element(radius.begin(), radius.end()) + gap;
  const int cells = std::max(1, static_cast<int>(side / cutoff));
  const auto cell_of = [&](double x) { return std::clamp(static_cast<int>(x / side * cells), 0, cells - 1); };
  const auto number = [&](int x, int y, int z) {
    return static_cast<std::size_t>((x * cells + y) * cells + z);
  };
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> head(static_cast<std::size_t>(cells * cells * cells), none),
      next(position.size());
  std::size_t pairs = 0;
  for (std::uint32_t i = 0; i < position.size(); ++i) {
    const auto& p = position[i];
    const int x = cell_of(p.x()), y = cell_of(p.y()), z = cell_of(p.z());
    for (int a = std::max(0, x - 1); a <= std::min(cells - 1, x + 1); ++a)
      for (int b = std::max(0, y - 1); b <= std::min(cells - 1, y + 1); ++b)
        for (int c = std::max(0, z - 1); c <= std::min(cells - 1, z + 1); ++c)
          for (std::uint32_t j = head[number(a, b, c)]; j != none; j = next[j])
            pairs += (position[j] - p).norm() - (radius[i] + radius[j]) <= gap;
    next[i] = head[number(x, y, z)];
    head[number(x, y, z)] = i;
  }
  return pairs;
}

void raw_cells(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(raw_pairs(sample));
  bench::count_items(state, static_cast<double>(sample.particles.size()), 32, 1);
}

void library(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const auto threads = static_cast<int>(state.range(1));
  cdem::core::ThreadPool pool(threads);
  std::size_t bonds = 0;
  for (auto _ : state)
    bonds = cdem::network::bonds_within(sample.particles, sample.box, eps, pool).size();
  if (bonds != raw_pairs(sample))
    state.SkipWithError("the library and the grid of cells find different pairs");
  const auto particles = static_cast<double>(sample.particles.size());
  bench::count_items(state, particles, 32 + 32 * static_cast<double>(bonds) / particles, threads);
}

constexpr auto milliseconds = benchmark::kMillisecond;
BENCHMARK(raw_cells)->Arg(100000)->Arg(1000000)->UseRealTime()->Unit(milliseconds);
BENCHMARK(library)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseRealTime()->Unit(milliseconds);

} // namespace

BENCHMARK_MAIN();
