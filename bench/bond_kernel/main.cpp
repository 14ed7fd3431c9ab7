// Forces of all bonds, nanoseconds a bond: a raw loop, the library with bonds in double and in float.

#include <benchmark/benchmark.h>

#include "../common/raw_bonds.hpp"
#include "../common/report.hpp"
#include "../common/sample.hpp"

namespace {

/// Displacements are read once and forces written once (and read before, as caches do): 192 bytes a particle.
double field_bytes(const bench::Sample& sample) {
  return 192.0 * static_cast<double>(sample.particles.size()) / static_cast<double>(sample.network.size());
}

void raw_loop(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const auto& bonds = bench::raw_bonds(state.range(0));
  const bench::Field motion = bench::random_motion(sample.particles.size());
  bench::Field force(motion.size());
  for (auto _ : state) {
    bench::raw_forces(bonds, motion, force);
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
  }
  bench::count_items(state, static_cast<double>(bonds.size()), sizeof(bonds[0]) + field_bytes(sample), 1);
}

template <class Real>
void library(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const auto threads = static_cast<int>(state.range(1));
  const auto& forces = bench::forces_of<Real>(state.range(0));
  const bench::Field motion = bench::random_motion(sample.particles.size());
  bench::Field force(motion.size());
  cdem::core::ThreadPool pool(threads);
  for (auto _ : state) {
    forces.evaluate(motion, force, pool);
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
  }
  const auto bonds = static_cast<double>(sample.network.size());
  state.counters["bytes_per_bond"] = static_cast<double>(forces.memory()) / bonds;
  bench::count_items(
      state, bonds,
      static_cast<double>(sizeof(cdem::bond::detail::BondGroup<Real>)) / 4 + field_bytes(sample), threads);
}

constexpr auto milliseconds = benchmark::kMillisecond;
BENCHMARK(raw_loop)->Arg(100000)->Arg(1000000)->UseRealTime()->Unit(milliseconds);
BENCHMARK(library<double>)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseRealTime()->Unit(milliseconds);
BENCHMARK(library<float>)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseRealTime()->Unit(milliseconds);

} // namespace

BENCHMARK_MAIN();
