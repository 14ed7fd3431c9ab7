// Young's modulus and Poisson's ratio of a homogeneous cube by a tension test: [L17] section 2.3.

#include <cstdio>

#include "common/example.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace rve = examples::rve_tension;
  rve::Params params;
  examples::CommonOptions common;
  common.out = "results/rve_tension";
  packing::Boundary boundary = packing::Boundary::periodic;

  CLI::App app(
      "A cube of bonded particles is pulled: E and nu of alumina and silica glass, [L17] section 2.3",
      "rve_tension");
  common.add_to(app, 500);
  app.add_option("--cov", params.packing.cov, "CoV of the Gaussian radii")->capture_default_str();
  app.add_option("--density", params.packing.density, "Volume fraction of the packing")
      ->capture_default_str();
  app.add_option("--growth", params.packing.growth_rate, "Growth rate of the spheres: slower packs denser")
      ->capture_default_str();
  examples::add_choice<packing::Boundary>(
      app, "--boundary", boundary,
      {{"periodic", packing::Boundary::periodic}, {"walls", packing::Boundary::walls}},
      "Box of the packing: periodic (then cut to a cube) or walls");
  examples::PackingOptions packings;
  packings.add_to(app, {"--particles", "--seed", "--cov", "--density", "--growth", "--boundary"});
  app.add_option("--coordination", params.coordination, "Coordination number Z")->capture_default_str();
  examples::add_choice<Axis>(app, "--axis", params.axis, {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}},
                             "Axis of the tension");
  examples::add_choice<rve::Method>(
      app, "--method", params.method,
      {{"verlet", rve::Method::verlet},
       {"static", rve::Method::statics},
       {"relaxation", rve::Method::relaxation}},
      "The paper's explicit steps, or the equilibrium by multigrid or relaxation");
  app.add_option("--damping", params.damping_ratio, "Damping ratio of the first axial vibration")
      ->capture_default_str();
  using integrate::DensityScaling;
  examples::add_choice<DensityScaling>(
      app, "--scaling", params.scaling,
      {{"per_particle", DensityScaling::per_particle}, {"uniform", DensityScaling::uniform}},
      "Density scaling to the paper's time step");
  app.add_option("--steps", params.most_steps, "Most steps of a run that does not converge before")
      ->capture_default_str();
  app.add_flag("--resume", params.resume, "Go on from the checkpoints in the results folder");
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("rve_tension", [&] {
    if (common.quick) {
      if (app.count("--particles") == 0)
        common.particles = 1000;
      params.convergence.interval = 500;
      if (app.count("--steps") == 0)
        params.most_steps = 3000;
    }
    params.packing.particles = common.particles;
    params.packing.seed = common.seed;
    params.packing.boundary = boundary;
    params.threads = common.threads;
    params.source = packings.source(common.out);
    params.validate();
    const io::OutputDirectory out(common.out);
    params.checkpoints = out.path();

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const rve::Result result = rve::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();

    std::printf("%s\n", rve::tabulate(params, result).text().c_str());
    if (result.packing_reported && !result.packing.reached())
      std::printf("The packing jammed at a density of %.4f, below the %.4g asked for: walls and equal sizes "
                  "keep spheres apart; --growth below %g packs denser.\n",
                  result.packing.density, params.packing.density, params.packing.growth_rate);
    if (result.packing_reported && result.packing.pressure < rve::jammed)
      std::printf("The packing is not jammed (reduced pressure %.0f): hardly any spheres touch, so no "
                  "rattlers are counted.\n",
                  result.packing.pressure);
    for (const auto& m : result.materials)
      if (!m.converged)
        std::printf("%s: E and nu had not settled to %g by step %llu; --steps allows more.\n",
                    m.material.name.c_str(), params.convergence.tolerance,
                    static_cast<unsigned long long>(m.motion.step));
    rve::write(params, result, out);
    if (common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
