// Three ways to the equilibrium of the cube in tension of [L17] section 2.3 (alumina), in one run: StaticMultigrid,
// DynamicRelaxation, and velocity Verlet as in the paper (constant velocity at once, density scaled for each particle).
// Each is timed until its displacements stay within 1e-3 of the largest, and E within 1e-3, of the static solution to 1e-10.
//
//   bench.equilibrium [particles = 100000] [threads = 2] [most steps of Verlet = 60000]

#include <cdem/bond/linear_forces.hpp>
#include <cdem/boundary/symmetric_tension.hpp>
#include <cdem/homogenize/running_average.hpp>
#include <cdem/homogenize/tension_gauge.hpp>
#include <cdem/integrate/density_scaling.hpp>
#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/rayleigh_quotient.hpp>
#include <cdem/integrate/static_multigrid.hpp>
#include <cdem/integrate/velocity_verlet.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "../common/sample.hpp"

namespace {

using namespace cdem;
using Forces = bond::LinearForces;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The cube, and the static solution that all are measured by.
struct Test {
  explicit Test(std::int64_t count, int threads)
      : sample(bench::sample(count)), forces(bench::alumina(), sample.particles, sample.network),
        inertia(particles::solid_spheres(sample.particles, std::vector{3900.0})),
        setup(
            boundary::SymmetricTension{.velocity = 1e-5}.apply(sample.particles, sample.network, sample.box)),
        gauge(sample.particles, sample.network, setup), pool(threads) {}

  integrate::Problem<Forces> problem() const { return {forces, inertia, setup.constraints}; }

  /// Largest difference of two displacements over the largest displacement, the second times `scale`.
  double error(const bench::Field& found, const bench::Field& reference, double scale) const {
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      worst = std::max(worst, (found[i].linear() - scale * reference[i].linear()).norm());
      largest = std::max(largest, scale * reference[i].linear().norm());
    }
    return worst / largest;
  }

  const bench::Sample& sample;
  Forces forces;
  particles::Inertia inertia;
  boundary::TensionSetup setup;
  homogenize::TensionGauge gauge;
  core::ThreadPool pool;
};

void row(const std::string& method, double steps, double work, double seconds, double baseline) {
  std::printf("%-58s %8.0f %8.0f %9.3f %9.1f\n", method.c_str(), steps, work, seconds, seconds / baseline);
}

/// Marches until displacement and E have come within 1e-3; prints when each did so for good.
void march(Test& test, const bench::Field& reference, const homogenize::FaceReading& exact,
           double damping_ratio, std::uint64_t most_steps, double baseline) {
  constexpr std::uint64_t every = 50;
  const double time_step = 2.15e-5; // printed in [L17]; the density is scaled to it
  integrate::scale_density(test.forces, test.inertia, time_step, 0.5, integrate::DensityScaling::per_particle,
                           test.pool);
  const auto problem = test.problem();
  const double omega =
      integrate::first_axial_frequency(problem, test.sample.particles, test.sample.box.lower.x(),
                                       test.sample.box.upper.x(), Axis::x, test.pool);
  const integrate::VelocityVerlet verlet({.time_step = time_step,
                                          .damping = integrate::Damping::of_mode(damping_ratio, omega),
                                          .observe_every = every});
  auto motion = particles::Motion::at_rest(test.sample.particles.size());
  struct Arrival {
    std::uint64_t step = 0;
    double seconds = 0;
  };
  Arrival shape, modulus, average_modulus;
  homogenize::RunningAverage average;
  double looking = 0, shape_error = 1, modulus_error = 1, ratio_error = 1;
  const auto start = Clock::now();
  verlet.run(problem, motion, most_steps, test.pool, [&](const integrate::Step& step) {
    const double now = seconds_since(start) - looking; // the time of these looks is not the method's
    const auto reading = test.gauge.faces(step.motion.displacement, step.reaction);
    average.add(reading.youngs_modulus());
    shape_error = test.error(step.motion.displacement, reference, step.motion.time);
    modulus_error = std::abs(reading.youngs_modulus() / exact.youngs_modulus() - 1);
    ratio_error = std::abs(reading.poissons_ratio() / exact.poissons_ratio() - 1);
    const auto watch = [&](Arrival& arrival, double error) {
      if (error > 1e-3)
        arrival = {};
      else if (arrival.step == 0)
        arrival = {step.motion.step, now};
    };
    watch(shape, shape_error);
    watch(modulus, modulus_error);
    watch(average_modulus, std::abs(average.mean() / exact.youngs_modulus() - 1));
    looking = seconds_since(start) - now;
    return true;
  });
  const std::string name = "velocity Verlet, damping " + core::to_text(damping_ratio) + ", ";
  const auto print = [&](const char* what, const Arrival& arrival) {
    if (arrival.step > 0)
      row(name + what, static_cast<double>(arrival.step), static_cast<double>(arrival.step), arrival.seconds,
          baseline);
    else
      std::printf("%-58s not within %llu steps\n", (name + what).c_str(),
                  static_cast<unsigned long long>(most_steps));
  };
  print("displacements", shape);
  print("E", modulus);
  print("E averaged over all steps", average_modulus);
  std::printf(
      "  at its end: displacements differ by %.1e of the largest, E by %.1e and nu by %.1e of themselves\n",
      shape_error, modulus_error, ratio_error);
}

} // namespace

int main(int argc, char** argv) {
  const std::int64_t count = argc > 1 ? std::atoll(argv[1]) : 100000;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 2;
  const std::uint64_t most_steps = argc > 3 ? static_cast<std::uint64_t>(std::atoll(argv[3])) : 60000;
  if (count < 1000 || threads < 1 || most_steps < 100) {
    std::fprintf(
        stderr,
        "usage: bench.equilibrium [particles, 1000 or more] [threads] [most steps of Verlet, 100 or more]\n");
    return 2;
  }
  Test test(count, threads);
  const auto problem = test.problem();
  const auto size = test.sample.particles.size();

  auto exact = particles::Motion::at_rest(size);
  integrate::StaticMultigrid({.relative_residual = 1e-10}).solve(problem, exact, test.pool);
  const auto reading =
      test.gauge.faces(exact.displacement, integrate::static_reactions(problem, exact, test.pool));
  std::printf("%zu particles, %d thread(s); static solution to 1e-10: E = %.4f GPa, nu = %.5f\n\n", size,
              threads, reading.youngs_modulus() / 1e9, reading.poissons_ratio());
  std::printf("%-58s %8s %8s %9s %9s\n", "to 1e-3 of the largest displacement", "steps", "K u", "s", "over");

  // the residual at which displacements are within 1e-3: tried from loose to tight, the last alone is timed
  double baseline = 0;
  for (const double residual : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    auto motion = particles::Motion::at_rest(size);
    const auto start = Clock::now();
    const auto report =
        integrate::StaticMultigrid({.relative_residual = residual}).solve(problem, motion, test.pool);
    baseline = seconds_since(start);
    if (test.error(motion.displacement, exact.displacement, 1) < 1e-3) {
      row("static multigrid, residual " + core::to_text(residual), report.iterations, report.work, baseline,
          baseline);
      break;
    }
  }
  for (const double residual : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
    auto motion = particles::Motion::at_rest(size);
    const auto report =
        integrate::DynamicRelaxation({.relative_residual = residual}).solve(problem, motion, test.pool);
    if (test.error(motion.displacement, exact.displacement, 1) < 1e-3) {
      row("dynamic relaxation, residual " + core::to_text(residual), static_cast<double>(report.steps),
          static_cast<double>(report.evaluations), report.seconds, baseline);
      break;
    }
  }
  for (const double damping : {0.01, 0.05})
    march(test, exact.displacement, reading, damping, most_steps, baseline);
}
