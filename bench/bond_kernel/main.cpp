// Forces of all bonds, nanoseconds a bond: a raw loop, the library with bonds in double and in float.

#include <cdem/bond/linear_forces.hpp>

#include <benchmark/benchmark.h>

#include <cstdint>
#include <map>
#include <stdexcept>
#include <vector>

#include "../common/raw_bonds.hpp"
#include "../common/report.hpp"
#include "../common/sample.hpp"

namespace {

/// Displacements are read once and forces written once (and read before, as caches do): 192 bytes a particle.
double field_bytes(const bench::Sample& sample) {
  return 192.0 * static_cast<double>(sample.particles.size()) / static_cast<double>(sample.network.size());
}

const std::vector<bench::RawBond>& raw(std::int64_t particles) {
  static std::map<std::int64_t, std::vector<bench::RawBond>> made;
  const auto found = made.find(particles);
  return found != made.end()
             ? found->second
             : made.emplace(particles, bench::raw_bonds(bench::sample(particles))).first->second;
}

/// Made once; throws if its forces are not those of the raw loop.
template <class Real>
const cdem::bond::BasicLinearForces<Real>& forces_of(std::int64_t particles) {
  static std::map<std::int64_t, cdem::bond::BasicLinearForces<Real>> made;
  const auto found = made.find(particles);
  if (found != made.end())
    return found->second;
  const bench::Sample& sample = bench::sample(particles);
  const auto& forces =
      made.try_emplace(particles, bench::alumina(), sample.particles, sample.network).first->second;
  const bench::Field motion = bench::random_motion(sample.particles.size());
  bench::Field force(motion.size()), expected(motion.size());
  cdem::core::ThreadPool pool;
  forces.evaluate(motion, force, pool);
  bench::raw_forces(raw(particles), motion, expected);
  if (!(bench::relative_difference(expected, force) < (sizeof(Real) == 8 ? 1e-14 : 1e-6)))
    throw std::logic_error("the library and the raw loop differ");
  return forces;
}

void raw_loop(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const auto& bonds = raw(state.range(0));
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
  const auto& forces = forces_of<Real>(state.range(0));
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
  bench::count_items(state, bonds, 8.0 * sizeof(Real) + field_bytes(sample), threads);
}

constexpr auto milliseconds = benchmark::kMillisecond;
BENCHMARK(raw_loop)->Arg(100000)->Arg(1000000)->UseRealTime()->Unit(milliseconds);
BENCHMARK(library<double>)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseRealTime()->Unit(milliseconds);
BENCHMARK(library<float>)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseRealTime()->Unit(milliseconds);

} // namespace

BENCHMARK_MAIN();
