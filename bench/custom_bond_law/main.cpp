// Forces of a law that is not in the library, nanoseconds a bond: examples/custom_bond_law's softening beam, an energy law
// with a memory, accepted at every call as in an explicit step, beside the same law in a hand-written loop.

#include <cdem/bond/bond_forces.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "../../examples/custom_bond_law/softening_beam.hpp"
#include "../common/raw_bonds.hpp"
#include "../common/report.hpp"
#include "../common/sample.hpp"

namespace {

using namespace cdem;

/// Random motions strain bonds by some 1e-2: most soften, many tear.
SofteningBeam::Parameters parameters() {
  return {.beam = {.materials = {{2536e9, 0.545}}}, .onset = 1e-3, .rupture = 1e-1};
}

/// The hand-written loop's memory and its law.
struct RawSoftening {
  const std::vector<bench::RawBond>& bonds;
  std::vector<double> worst = std::vector<double>(bonds.size(), 0.0);
  SofteningBeam law{parameters()};
  double lost = 0;

  void operator()(const bench::Field& displacement, bench::Field& force) {
    bench::raw_forces(bonds, displacement, force, [&](std::size_t b, double twice_energy) {
      const double before = law.left(worst[b]);
      worst[b] = std::max(worst[b], std::sqrt(twice_energy / bonds[b].kn) / bonds[b].length);
      const double after = law.left(worst[b]);
      lost += 0.5 * (before - after) * twice_energy;
      return after;
    });
  }
};

double bytes(const bench::Sample& sample) { // bonds with their memory read and written, displacements, forces
  return 72 + 16 +
         (64 + 128) * static_cast<double>(sample.particles.size()) /
             static_cast<double>(sample.network.size());
}

void raw_softening(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const bench::Field motion = bench::random_motion(sample.particles.size());
  bench::Field force(motion.size());
  RawSoftening forces{bench::raw_bonds(state.range(0))};
  for (auto _ : state) {
    forces(motion, force);
    benchmark::ClobberMemory();
  }
  bench::count_items(state, static_cast<double>(forces.bonds.size()), bytes(sample), 1);
}

void softening_beam(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const bench::Field motion = bench::random_motion(sample.particles.size());
  bond::BondForces<SofteningBeam> forces(SofteningBeam(parameters()), sample.particles, sample.network);
  core::ThreadPool pool(static_cast<int>(state.range(1)));
  bench::Field force(motion.size()), expected(motion.size());
  forces.advance(motion, force, pool);
  RawSoftening{bench::raw_bonds(state.range(0))}(motion, expected);
  if (!(bench::relative_difference(expected, force) < 1e-12))
    throw std::logic_error("the library and the raw loop differ");
  for (auto _ : state) {
    forces.advance(motion, force, pool);
    benchmark::ClobberMemory();
  }
  bench::count_items(state, static_cast<double>(forces.bond_count()), bytes(sample),
                     static_cast<int>(state.range(1)));
}

} // namespace

BENCHMARK(raw_softening)->ArgsProduct({{100000, 1000000}, {1}})->UseRealTime();
BENCHMARK(softening_beam)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseRealTime();
BENCHMARK_MAIN();
