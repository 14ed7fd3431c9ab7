// How large a body fits: a periodic packing of 1012 spheres repeated k x k x k, cut to a cube, bonded and solved in tension
// to a relative residual of 1e-8, with the network kept. Prints time and memory of every stage; k = 25 makes 15.8 million
// particles, the largest body of [L17] (section 5.2).
//
//   bench.largest_body [k = 10] [threads = 2]

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/boundary/symmetric_tension.hpp>
#include <cdem/homogenize/tension_gauge.hpp>
#include <cdem/integrate/static_multigrid.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/packing/tiled.hpp>
#include <cdem/simulation/specimen.hpp>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace {

/// A line of this process's account of its memory, kB; 0 where the system keeps none.
double kilobytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(name + ":", 0) == 0)
      return std::atof(line.c_str() + name.size() + 1);
  return 0;
}

class Stages {
public:
  void done(const char* stage, std::size_t particles) {
    const auto now = std::chrono::steady_clock::now();
    std::printf("%-22s %9.1f s %9.2f GiB held %9.2f GiB peak %8.0f bytes a particle at the peak\n", stage,
                std::chrono::duration<double>(now - last_).count(), kilobytes("VmRSS") / 1048576,
                kilobytes("VmHWM") / 1048576, 1024 * kilobytes("VmHWM") / static_cast<double>(particles));
    std::fflush(stdout);
    last_ = std::chrono::steady_clock::now();
  }

private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

} // namespace

int main(int argc, char** argv) {
  using namespace cdem;
  const int copies = argc > 1 ? std::atoi(argv[1]) : 10;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 2;
  if (argc > 3 || copies < 1 || threads < 1) {
    std::fprintf(stderr,
                 "usage: bench.largest_body [copies along an edge, 1 or more] [threads, 1 or more]\n");
    return 2;
  }
  Stages stages;
  core::ThreadPool pool(threads);
  using Packer = packing::Tiled<packing::LubachevskyStillinger>;
  Packer packer({.base = {.particles = 1012, .cov = 0.3, .growth_rate = 0.1, .seed = 1},
                 .copies = static_cast<std::uint32_t>(copies)});
  simulation::Specimen specimen;
  {
    const auto packing = packer.pack();
    stages.done("packing", packing.particles.size());
    specimen = simulation::make_specimen(packing.particles, packing.box, 6.2, pool);
  }
  const std::size_t count = specimen.particles.size();
  stages.done("network", count);

  const bond::CompactLinearForces forces(bond::Beam<>({.materials = {{2536e9, 0.545}}}), specimen.particles,
                                         specimen.network);
  const particles::Inertia inertia = particles::solid_spheres(specimen.particles, std::vector{3900.0});
  const auto setup = boundary::SymmetricTension{.velocity = 1e-5, .tolerance = specimen.gap()}.apply(
      specimen.particles, specimen.network, specimen.box);
  const integrate::Problem<bond::CompactLinearForces> problem{forces, inertia, setup.constraints};
  stages.done("forces, faces", count);

  particles::Motion motion;
  motion.displacement.resize(count); // a static solution has no velocity
  const auto report = integrate::StaticMultigrid().solve(problem, motion, pool);
  stages.done("solution", count);

  const homogenize::TensionGauge gauge(specimen.particles, specimen.network, setup);
  const auto reading = gauge.faces(motion.displacement, integrate::static_reactions(problem, motion, pool));
  stages.done("moduli", count);
  std::printf(
      "\n%zu particles, %zu bonds: %d iterations, work %.0f applications, residual %.1e, set-up %.1f s, "
      "solution %.1f s; E = %.1f GPa, nu = %.4f\n",
      count, specimen.network.size(), report.iterations, report.work, report.relative_residual,
      report.setup_seconds, report.solve_seconds, reading.youngs_modulus() / 1e9, reading.poissons_ratio());
}
