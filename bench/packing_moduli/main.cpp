// The two packing generators side by side, seed by seed: density, contacts, E_a = E/E_mu and nu of the bonded cube in
// static tension. Usage: bench.packing_moduli [particles] [seeds] [CoV] [density] [growth rate of the hard spheres]

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/boundary/symmetric_tension.hpp>
#include <cdem/homogenize/tension_gauge.hpp>
#include <cdem/integrate/static_multigrid.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/packing/soft_spheres.hpp>
#include <cdem/simulation/specimen.hpp>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using namespace cdem;

constexpr double micro_modulus = 1e11, radius_ratio = 0.545, coordination = 6.2;

struct Moduli {
  double apparent = 0, poissons_ratio = 0; ///< E/E_mu and nu, from the slopes of the interior
  double eps = 0;
};

Moduli pull(const particles::ParticleSet& particles, const geometry::Box& box, core::ThreadPool& pool) {
  const auto body = simulation::make_specimen(particles, box, coordination, pool);
  const bond::Beam<> law({.materials = {{.youngs_modulus = micro_modulus, .radius_ratio = radius_ratio}}});
  const bond::LinearForces forces(law, body.particles, body.network);
  const auto inertia = particles::solid_spheres(body.particles, std::vector{3900.0});
  const auto test =
      boundary::SymmetricTension{Axis::x, 1e-6, body.gap()}.apply(body.particles, body.network, body.box);
  const integrate::Problem<bond::LinearForces> problem{forces, inertia, test.constraints};
  auto motion = particles::Motion::at_rest(body.particles.size());
  integrate::StaticMultigrid().solve(problem, motion, pool);
  const homogenize::TensionGauge gauge(body.particles, body.network, test);
  const auto faces = gauge.faces(motion.displacement, integrate::static_reactions(problem, motion, pool));
  const auto interior = gauge.interior(motion.displacement);
  return {interior.youngs_modulus(faces.stress) / micro_modulus, interior.poissons_ratio(), body.eps};
}

/// Mean and standard deviation of a sample.
struct Sample {
  double sum = 0, squares = 0, count = 0;
  void add(double value) {
    sum += value;
    squares += value * value;
    count += 1;
  }
  double mean() const { return sum / count; }
  double deviation() const {
    return count > 1 ? std::sqrt(std::max(0.0, (squares - sum * sum / count) / (count - 1))) : 0;
  }
};

template <class Pack>
void table(const char* name, int seeds, core::ThreadPool& pool, Pack&& pack) {
  Sample apparent, poisson;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto packed = pack(static_cast<std::uint64_t>(seed));
    const Moduli moduli = pull(packed.particles, packed.box, pool);
    apparent.add(moduli.apparent);
    poisson.add(moduli.poissons_ratio);
    std::printf(
        "%-22s seed %d  density %.4f  contacts %.3f  rattlers %.3f  eps %.2e  E_a %.4f  nu %.4f  %.1f s\n",
        name, seed, packed.report.density, packed.report.contact_number,
        packed.report.rattlers / static_cast<double>(packed.particles.size()), moduli.eps, moduli.apparent,
        moduli.poissons_ratio, packed.report.wall_seconds);
    std::fflush(stdout);
  }
  std::printf("%-22s E_a %.4f +- %.4f  nu %.4f +- %.4f\n", name, apparent.mean(), apparent.deviation(),
              poisson.mean(), poisson.deviation());
}

} // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int k, double standard) { return argc > k ? std::atof(argv[k]) : standard; };
  const auto count = static_cast<std::uint32_t>(argument(1, 10000));
  const int seeds = static_cast<int>(argument(2, 5));
  const double cov = argument(3, 0), density = argument(4, 0.64), growth = argument(5, 0.01);
  core::ThreadPool pool(2);
  table("SoftSpheres", seeds, pool, [&](std::uint64_t seed) {
    return packing::SoftSpheres(
               {.particles = count, .density = density, .cov = cov, .seed = seed, .threads = 2})
        .pack();
  });
  table("LubachevskyStillinger", seeds, pool, [&](std::uint64_t seed) {
    return packing::LubachevskyStillinger(
               {.particles = count, .density = density, .cov = cov, .growth_rate = growth, .seed = seed})
        .pack();
  });
}
