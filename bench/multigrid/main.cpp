// Static tension to a relative residual of 1e-8: conjugate gradients preconditioned by 6x6 blocks, written by hand on the
// library's operator, beside the static multigrid. Arguments: particles, threads, 1000 r_mu, contrast (stiffness of a
// sphere of radius 0.3 sides over that around it, as a power of ten). `bound` is what the bytes of all applications of K need.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/boundary/symmetric_tension.hpp>
#include <cdem/integrate/static_multigrid.hpp>

#include <Eigen/Cholesky>
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#ifdef __unix__
#include <sys/resource.h>
#endif

#include "../common/report.hpp"
#include "../common/sample.hpp"

namespace {

using namespace cdem;
using Forces = bond::LinearForces;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// A cube under symmetric tension along x, with a spherical inclusion.
struct Tension {
  explicit Tension(const benchmark::State& state)
      : sample(bench::sample(state.range(0))), particles(with_inclusion(sample)),
        forces(law(static_cast<double>(state.range(2)) / 1000,
                   std::pow(10.0, static_cast<double>(state.range(3)))),
               particles, sample.network),
        setup(boundary::SymmetricTension{.velocity = 1e-6}.apply(particles, sample.network, sample.box)),
        inertia{std::vector<double>(particles.size(), 1), std::vector<double>(particles.size(), 1)},
        motion(particles::Motion::at_rest(particles.size())) {}

  static particles::ParticleSet with_inclusion(const bench::Sample& sample) {
    particles::ParticleSet particles = sample.particles;
    const Vec3 centre = 0.5 * (sample.box.lower + sample.box.upper);
    const double radius = 0.3 * sample.box.size().x();
    for (std::size_t i = 0; i < particles.size(); ++i)
      particles.phase[i] = (particles.position[i] - centre).norm() < radius ? 1 : 0;
    return particles;
  }
  static bond::Beam<> law(double radius_ratio, double contrast) {
    return bond::Beam<>({{{1e11, radius_ratio}, {1e11 * contrast, radius_ratio}}, {}});
  }

  const bench::Sample& sample;
  particles::ParticleSet particles;
  Forces forces;
  boundary::TensionSetup setup;
  particles::Inertia inertia;
  particles::Motion motion;
};

/// Most memory the process has held so far, bytes: the body, its network and the solver's, and what making them took.
double peak_memory() {
#ifdef __unix__
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
#else
  return 0;
#endif
}

void static_multigrid(benchmark::State& state) {
  Tension tension(state);
  core::ThreadPool pool(static_cast<int>(state.range(1)));
  const integrate::Problem<Forces> problem{tension.forces, tension.inertia, tension.setup.constraints};
  integrate::StaticMultigrid::Report report;
  for (auto _ : state) {
    tension.motion = particles::Motion::at_rest(tension.particles.size());
    report = integrate::StaticMultigrid().solve(problem, tension.motion, pool);
  }
  const auto count = static_cast<double>(tension.particles.size());
  state.counters["particles"] = count;
  state.counters["iterations"] = report.iterations;
  state.counters["work"] = report.work;
  state.counters["complexity"] = report.operator_complexity;
  state.counters["setup_s"] = report.setup_seconds;
  state.counters["solve_s"] = report.solve_seconds;
  state.counters["us_per_particle"] = 1e6 * (report.setup_seconds + report.solve_seconds) / count;
  state.counters["bytes_per_particle"] = static_cast<double>(report.bytes) / count;
  state.counters["peak_per_particle"] = peak_memory() / count;
  // an application reads the links, and reads and writes a line of 32 bytes a node in a field each of x, residual, sum
  const double fields = 4 * 32;
  bench::count_items(state, count,
                     report.work * (static_cast<double>(report.levels[0].bytes) / count + fields),
                     static_cast<int>(state.range(1)));
  // work by level: applications, and bytes over those of the particles' level
  for (std::size_t k = 0; k < report.levels.size(); ++k) {
    const auto& level = report.levels[k];
    const std::string name = "level" + std::to_string(k);
    state.counters[name + "_nodes"] = static_cast<double>(level.nodes);
    state.counters[name + "_applications"] = level.applications;
    state.counters[name + "_work"] =
        level.applications * static_cast<double>(level.bytes) / static_cast<double>(report.levels[0].bytes);
  }
}

Vector6 vector_of(const particles::Spatial<>& spatial) {
  Vector6 vector;
  vector << spatial.linear(), spatial.angular();
  return vector;
}

void raw_block_jacobi(benchmark::State& state) {
  Tension tension(state);
  core::ThreadPool pool(static_cast<int>(state.range(1)));
  const std::size_t count = tension.particles.size();
  int iterations = 0;
  for (auto _ : state) {
    std::vector<Vector6> free(count, Vector6::Ones()), r(count), p(count, Vector6::Zero());
    particles::SpatialField<> u(count), direction(count), force(count);
    for (const auto& constraint : tension.setup.constraints.list()) {
      free[constraint.particle][constraint.dof] = 0;
      u[constraint.particle][constraint.dof] = constraint.rate;
    }
    std::vector<Matrix6> inverse(count, Matrix6::Zero());
    for (ParticleIndex i = 0; i < count; ++i) {
      if (tension.forces.bonds_of(i).size() == 0)
        continue;
      Matrix6 block = free[i].asDiagonal() * tension.forces.diagonal_block(i) * free[i].asDiagonal();
      for (int d = 0; d < 6; ++d)
        if (free[i][d] == 0)
          block(d, d) = 1;
      inverse[i] = free[i].asDiagonal() * block.inverse() * free[i].asDiagonal();
    }
    tension.forces.evaluate(u, force, pool);
    double norm0 = 0, rz_before = 1, norm = 0;
    for (std::size_t i = 0; i < count; ++i) {
      r[i] = vector_of(force[i]).cwiseProduct(free[i]);
      norm0 += r[i].squaredNorm();
    }
    for (iterations = 0, norm = norm0; norm > 1e-16 * norm0 && iterations < 20000; ++iterations) {
      double rz = 0, curvature = 0;
      for (std::size_t i = 0; i < count; ++i)
        rz += r[i].dot(inverse[i] * r[i]);
      for (std::size_t i = 0; i < count; ++i) {
        p[i] = inverse[i] * r[i] + (iterations == 0 ? 0 : rz / rz_before) * p[i];
        direction[i].linear() = p[i].head<3>();
        direction[i].angular() = p[i].tail<3>();
      }
      tension.forces.evaluate(direction, force, pool);
      for (std::size_t i = 0; i < count; ++i)
        curvature -= p[i].dot(vector_of(force[i]));
      norm = 0;
      for (std::size_t i = 0; i < count; ++i) {
        r[i] += rz / curvature * vector_of(force[i]).cwiseProduct(free[i]);
        norm += r[i].squaredNorm();
      }
      rz_before = rz;
    }
  }
  state.counters["particles"] = static_cast<double>(count);
  state.counters["iterations"] = iterations;
  const double bytes =
      static_cast<double>(tension.forces.memory()) / static_cast<double>(count) + 288 + 8 * 64;
  bench::count_items(state, static_cast<double>(count), iterations * bytes, static_cast<int>(state.range(1)));
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  for (const std::int64_t particles : {10'000, 100'000, 1'000'000})
    for (const std::int64_t radius_ratio : {545, 169})
      for (const std::int64_t contrast : {0, -2, 2})
        benchmark->Args({particles, 2, radius_ratio, contrast});
}

constexpr auto milliseconds = benchmark::kMillisecond;
BENCHMARK(raw_block_jacobi)
    ->Args({10'000, 2, 545, 0})
    ->Args({100'000, 2, 545, 0})
    ->UseRealTime()
    ->Unit(milliseconds);
BENCHMARK(static_multigrid)->Apply(sizes)->UseRealTime()->Unit(milliseconds);
BENCHMARK(static_multigrid)
    ->Args({100'000, 1, 545, 0})
    ->Args({700'000, 2, 545, 0})
    ->Args({4'000'000, 2, 545, 0})
    ->UseRealTime()
    ->Unit(milliseconds);

} // namespace

BENCHMARK_MAIN();
