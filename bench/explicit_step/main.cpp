// One explicit step, all told, nanoseconds a bond: VelocityVerlet on a body that vibrates freely with mass damping,
// beside a hand-written step on the raw loop's forces.

#include <cdem/integrate/critical_time_step.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/particles/constraints.hpp>
#include <cdem/particles/inertia.hpp>
#include <cdem/particles/motion.hpp>

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "../common/raw_bonds.hpp"
#include "../common/report.hpp"
#include "../common/sample.hpp"

namespace {

using namespace cdem;

constexpr double alpha = 1000;      ///< 1/s
constexpr std::uint64_t steps = 20; ///< between two looks of the observer

/// What moves: its inertia and a stable step. Made once a size.
struct Body {
  particles::Inertia inertia;
  double time_step;
};
const Body& body_of(std::int64_t count) {
  static std::map<std::int64_t, Body> made;
  const auto found = made.find(count);
  if (found != made.end())
    return found->second;
  const bench::Sample& sample = bench::sample(count);
  const std::vector<double> density{3900};
  Body body{particles::solid_spheres(sample.particles, density), 0};
  body.time_step =
      0.5 * integrate::critical_time_step(bench::forces_of<double>(count), body.inertia).time_step;
  return made.emplace(count, body).first->second;
}

particles::Motion moving(std::size_t particles) {
  auto motion = particles::Motion::at_rest(particles);
  motion.velocity = bench::random_motion(particles);
  return motion;
}

/// Displacement read, velocity changed, the coming displacement written, inertia read: per bond. A store first reads its
/// line.
double field_bytes(const bench::Sample& sample) {
  const double particle = 64 + 128 + 128 + 16;
  return particle * static_cast<double>(sample.particles.size()) / static_cast<double>(sample.network.size());
}

void raw_step(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const Body& body = body_of(state.range(0));
  const auto& bonds = bench::raw_bonds(state.range(0));
  auto motion = moving(sample.particles.size());
  bench::Field force(motion.size());
  motion.acceleration.resize(motion.size());
  const double dt = body.time_step, implicit = 1 / (1 + 0.5 * alpha * dt);
  for (auto _ : state)
    for (std::uint64_t step = 0; step < steps; ++step) {
      for (std::size_t i = 0; i < motion.size(); ++i)
        for (int c = 0; c < 8; ++c) {
          motion.velocity[i].component[c] += 0.5 * dt * motion.acceleration[i].component[c];
          motion.displacement[i].component[c] += dt * motion.velocity[i].component[c];
        }
      bench::raw_forces(bonds, motion.displacement, force);
      for (std::size_t i = 0; i < motion.size(); ++i) {
        const double inverse[2] = {1 / body.inertia.mass[i], 1 / body.inertia.moment[i]};
        for (int c = 0; c < 8; ++c) {
          const double free = force[i].component[c] * inverse[c / 4];
          double& velocity = motion.velocity[i].component[c];
          velocity = (velocity + 0.5 * dt * free) * implicit;
          motion.acceleration[i].component[c] = free - alpha * velocity;
        }
      }
      benchmark::ClobberMemory();
    }
  bench::count_items(state, static_cast<double>(bonds.size() * steps), 72 + field_bytes(sample), 1);
}

template <class Real>
void library_step(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const auto threads = static_cast<int>(state.range(1));
  const Body& body = body_of(state.range(0));
  const auto& forces = bench::forces_of<Real>(state.range(0));
  const particles::Constraints none;
  const integrate::Problem<bond::BasicLinearForces<Real>> problem{forces, body.inertia, none};
  const integrate::VelocityVerlet verlet(
      {.time_step = body.time_step, .damping = {alpha, 0}, .observe_every = steps});
  auto motion = moving(sample.particles.size());
  core::ThreadPool pool(threads);
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
  const auto particles = static_cast<double>(sample.particles.size());
  // displacement, velocity, acceleration, mass and moment, bonds
  state.counters["bytes_per_particle"] = 3 * 64 + 16 + static_cast<double>(forces.memory()) / particles;
  bench::count_items(
      state, bonds * static_cast<double>(steps),
      static_cast<double>(sizeof(cdem::bond::detail::BondGroup<Real>)) / 4 + field_bytes(sample), threads);
}

constexpr auto milliseconds = benchmark::kMillisecond;
BENCHMARK(raw_step)->Arg(100000)->Arg(1000000)->UseRealTime()->Unit(milliseconds);
BENCHMARK(library_step<double>)
    ->ArgsProduct({{100000, 1000000}, {1, 2}})
    ->UseManualTime()
    ->Unit(milliseconds);
BENCHMARK(library_step<float>)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseManualTime()->Unit(milliseconds);

} // namespace

BENCHMARK_MAIN();
