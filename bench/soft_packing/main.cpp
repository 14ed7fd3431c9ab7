// Repulsion of soft spheres, nanoseconds in every sphere and evaluation of all forces: a hand-written loop over the same
// pairs (each once, with the square root, forces scattered), beside the library's kernel (each pair twice, four at a
// time, forces and the sums of the descent). Then whole packings: 10,000 and 100,000 spheres to the jamming point, and as
// many as the environment variable CDEM_PACKING_SPHERES says (on two threads or CDEM_PACKING_THREADS, with progress).

#include <cdem/core/parallel.hpp>
#include <cdem/core/random.hpp>
#include <cdem/io/terminal_progress.hpp>
#include <cdem/packing/detail/soft_system.hpp>
#include <cdem/packing/soft_spheres.hpp>

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <vector>

#include "../common/report.hpp"

namespace {

using namespace cdem;
using packing::detail::Quad;
using packing::detail::SoftSystem;

/// Equal spheres on their way to rest at a density of 0.65, in the library's space-filling order.
struct Sample {
  core::ThreadPool pool{2};
  std::unique_ptr<SoftSystem> system;
};

Sample& sample(std::int64_t count) {
  static std::map<std::int64_t, Sample> samples;
  Sample& made = samples[count];
  if (!made.system) {
    core::Random random(1);
    std::vector<Quad> spheres(static_cast<std::size_t>(count));
    for (Quad& sphere : spheres)
      sphere = {{random.uniform(), random.uniform(), random.uniform(), 0.5}};
    const double scale = std::cbrt(0.65 * 6 / (3.141592653589793 * static_cast<double>(count)));
    made.system = std::make_unique<SoftSystem>(spheres, scale, true, made.pool);
    made.system->fix_scale(scale);
    for (int step = 0; step < 300; ++step) {
      made.system->evaluate();
      made.system->advance();
    }
    made.system->evaluate();
  }
  return made;
}

/// Each pair once, from lists of the same pairs.
void raw_loop(benchmark::State& state) {
  const SoftSystem& system = *sample(state.range(0)).system;
  const std::size_t count = system.size();
  std::vector<std::array<double, 3>> position(count), force(count);
  std::vector<std::size_t> begin(1, 0);
  std::vector<ParticleIndex> others;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      position[i][k] = system.spheres()[i].component[k];
    for (const ParticleIndex j : system.lists().of(i))
      if (j > i)
        others.push_back(j);
    begin.push_back(others.size());
  }
  const double diameter = system.scale();
  for (auto _ : state) {
    for (auto& f : force)
      f = {0, 0, 0};
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t n = begin[i]; n < begin[i + 1]; ++n) {
        const ParticleIndex j = others[n];
        double d[3], square = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          d[k] = position[i][k] - position[j][k];
          d[k] -= d[k] > 0.5 ? 1 : (d[k] < -0.5 ? -1 : 0);
          square += d[k] * d[k];
        }
        if (square < diameter * diameter) {
          const double push = 2 * (diameter / std::sqrt(square) - 1);
          for (std::size_t k = 0; k < 3; ++k) {
            force[i][k] += push * d[k];
            force[j][k] -= push * d[k];
          }
        }
      }
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
  }
  bench::count_items(state, static_cast<double>(count),
                     24 + 48 + 4 * static_cast<double>(others.size()) / static_cast<double>(count), 1);
}

template <bool moves>
void library(benchmark::State& state) {
  Sample& made = sample(state.range(0));
  const auto threads = static_cast<int>(state.range(1));
  core::ThreadPool pool(threads);
  SoftSystem system(made.system->spheres(), made.system->scale(), true, pool);
  system.fix_scale(system.scale());
  system.evaluate();
  for (auto _ : state) {
    system.evaluate();
    if constexpr (moves)
      system.advance();
  }
  std::size_t entries = 0;
  for (std::size_t i = 0; i < system.size(); ++i)
    entries += system.lists().of(i).size();
  const auto count = static_cast<double>(system.size());
  bench::count_items(state, count, (moves ? 256 : 128) + 4 + 4 * static_cast<double>(entries) / count,
                     threads);
}
void library_forces(benchmark::State& state) {
  library<false>(state);
}
void library_step(benchmark::State& state) {
  library<true>(state);
}

void packing_to_jamming(benchmark::State& state) {
  packing::SoftSpheres::Report report;
  io::TerminalProgress progress;
  const core::Monitor monitor =
      state.range(0) > 100000 ? core::Monitor(progress.listener()) : core::Monitor();
  for (auto _ : state)
    report = packing::SoftSpheres({.particles = static_cast<std::uint32_t>(state.range(0)),
                                   .target = packing::SoftSpheres::Target::jamming,
                                   .cov = 0,
                                   .threads = static_cast<int>(state.range(1))})
                 .pack(monitor)
                 .report;
  if (!report.reached())
    state.SkipWithError("the jamming point was not reached");
  state.counters["density"] = report.density;
  state.counters["Z"] = report.contact_number;
  state.counters["evaluations"] = static_cast<double>(report.evaluations);
}

BENCHMARK(raw_loop)->Arg(100000)->Arg(1000000)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(library_forces)
    ->ArgsProduct({{100000, 1000000}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(library_step)
    ->ArgsProduct({{100000, 1000000}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(packing_to_jamming)
    ->ArgsProduct({{10000, 100000}, {2}})
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

[[maybe_unused]] const bool more = [] {
  const char* threads = std::getenv("CDEM_PACKING_THREADS");
  if (const char* spheres = std::getenv("CDEM_PACKING_SPHERES"))
    benchmark::RegisterBenchmark("packing_to_jamming", packing_to_jamming)
        ->Args({std::atoll(spheres), threads ? std::atoll(threads) : 2})
        ->Iterations(1)
        ->UseRealTime()
        ->Unit(benchmark::kSecond);
  return true;
}();

} // namespace

BENCHMARK_MAIN();
