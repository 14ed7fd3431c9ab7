// One explicit step under each kind of law, nanoseconds a bond: what a law that is not linear costs, what a finite
// rotation costs, and that wrappers which do nothing cost nothing. First each side is checked against LinearForces.

#include <cdem/bond/bond_forces.hpp>
#include <cdem/bond/breakable.hpp>
#include <cdem/bond/debonded_interface.hpp>
#include <cdem/bond/finite_rotation.hpp>
#include <cdem/bond/forces_of.hpp>
#include <cdem/bond/thermal.hpp>
#include <cdem/integrate/critical_time_step.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/particles/constraints.hpp>
#include <cdem/particles/inertia.hpp>
#include <cdem/particles/motion.hpp>

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdint>
#include <vector>

#include "../common/report.hpp"
#include "../common/sample.hpp"

namespace {

using namespace cdem;
using bond::BondForces;
using bond::ForcesOf;

constexpr double alpha = 1000;      ///< 1/s
constexpr std::uint64_t steps = 20; ///< between two looks of the observer

/// The beam by its energy alone.
struct EnergyBeam {
  bond::Beam<> beam;
  bond::ChannelStiffness prepare(const bond::BondGeometry& geometry) const {
    return beam.stiffness(geometry);
  }
  template <class Real>
  Real energy(const bond::ChannelStiffness& k, const bond::Deformation<Real>& d) const {
    return 0.5 * (k.normal * d.stretch * d.stretch + k.tangential * d.shear.squared() +
                  k.torsion * d.twist * d.twist + k.bending * d.bend.squared());
  }
  void validate(const particles::ParticleSet& particles) const { beam.validate(particles); }
};

using Beam = bond::Beam<>;
using Finite = bond::FiniteRotation<Beam>;
using Brittle = bond::Breakable<Beam, bond::CombinedStress>;
using Heated = bond::Thermal<Beam>;
using Debonded = bond::DebondedInterface<Beam>;
using All = bond::Thermal<bond::DebondedInterface<bond::Breakable<Finite, bond::CombinedStress>>>;

Heated heated(const Beam& beam) {
  return {beam, {1e-5}, {0}};
}
All all(const Beam& beam) {
  const bond::Breakable brittle(Finite(beam), bond::CombinedStress{});
  return {bond::DebondedInterface(brittle, {1, {}}), {1e-5}, {0}};
}

template <class Forces, class MakeLaw>
void step(benchmark::State& state, MakeLaw&& law) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const auto inertia = particles::solid_spheres(sample.particles, std::vector<double>{3900});
  Forces forces(law(bench::alumina()), sample.particles, sample.network);
  const bond::LinearForces linear(bench::alumina(), sample.particles, sample.network);
  core::ThreadPool pool(1);
  bench::Field small = bench::random_motion(sample.particles.size()), found, expected;
  for (auto& spatial : small)
    for (int c = 0; c < 8; ++c)
      spatial.component[c] *= 1e-4;
  forces.evaluate(small, found, pool);
  linear.evaluate(small, expected, pool);
  if (!(bench::relative_difference(found, expected) < 1e-5)) {
    state.SkipWithError("the forces are not the beam's");
    return;
  }
  const particles::Constraints none;
  const integrate::Problem<Forces> problem{forces, inertia, none};
  const double time_step = 0.5 * integrate::critical_time_step(linear, inertia).time_step;
  const integrate::VelocityVerlet verlet(
      {.time_step = time_step, .damping = {alpha, 0}, .observe_every = steps});
  auto motion = particles::Motion::at_rest(sample.particles.size());
  motion.velocity = small;
  // run() checks its input each time it is called: an observer times the steps alone, from one look to the next
  for (auto _ : state) {
    std::chrono::steady_clock::time_point start, end;
    verlet.run(problem, motion, 2 * steps, pool, [&](const integrate::Step&) {
      start = end;
      end = std::chrono::steady_clock::now();
      return true;
    });
    state.SetIterationTime(std::chrono::duration<double>(end - start).count());
  }
  const auto bonds = static_cast<double>(sample.network.size());
  bench::count_items(state, bonds * static_cast<double>(steps), 72, 1);
}

void linear_forces(benchmark::State& state) {
  step<ForcesOf<Beam>>(state, [](const Beam& beam) { return beam; });
}
void linear_debonded(benchmark::State& state) {
  step<ForcesOf<Debonded>>(state, [](const Beam& beam) { return Debonded(beam, {1, {}}); });
}
void general(benchmark::State& state) {
  step<BondForces<Beam>>(state, [](const Beam& beam) { return beam; });
}
void general_thermal(benchmark::State& state) {
  step<BondForces<Heated>>(state, heated);
}
void general_breakable(benchmark::State& state) {
  step<BondForces<Brittle>>(state, [](const Beam& beam) { return Brittle(beam, bond::CombinedStress{}); });
}
void energy_law(benchmark::State& state) {
  step<BondForces<EnergyBeam>>(state, [](const Beam& beam) { return EnergyBeam{beam}; });
}
void finite_rotation(benchmark::State& state) {
  step<BondForces<Finite>>(state, [](const Beam& beam) { return Finite(beam); });
}
void finite_all_wrappers(benchmark::State& state) {
  step<BondForces<All>>(state, all);
}

#define CDEM_SIDE(name) BENCHMARK(name)->Arg(100000)->UseManualTime()->Unit(benchmark::kMillisecond)
CDEM_SIDE(linear_forces);
CDEM_SIDE(linear_debonded);
CDEM_SIDE(general);
CDEM_SIDE(general_thermal);
CDEM_SIDE(general_breakable);
CDEM_SIDE(energy_law);
CDEM_SIDE(finite_rotation);
CDEM_SIDE(finite_all_wrappers);

} // namespace

BENCHMARK_MAIN();
