// How the stress of a homogeneous cube scatters from specimen to specimen: [L17] section 2.5, figure 9.

#include <cstdio>

#include "common/example.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace homogeneous = examples::stress_homogeneous;
  using examples::rve_tension::Method;
  homogeneous::Params params;
  auto& tension = params.tension;
  examples::CommonOptions common;
  common.particles = 100000;
  common.out = "results/stress_homogeneous";

  CLI::App app(
      "A cube of silica glass in tension, cut into specimens of many sizes and shapes: how the stress "
      "scatters, [L17] section 2.5",
      "stress_homogeneous");
  common.add_to(app, 500);
  examples::add_packing_parameters(app, tension.packing);
  examples::PackingOptions packings;
  packings.add_to(app, {"--particles", "--seed", "--cov", "--density", "--growth", "--boundary"});
  app.add_option("--coordination", tension.coordination, "Coordination number Z")->capture_default_str();
  app.add_option("--strain", params.strain, "Strain between the faces, to which the solution is scaled")
      ->capture_default_str();
  examples::add_choice<Method>(
      app, "--method", tension.method,
      {{"static", Method::statics}, {"verlet", Method::verlet}, {"relaxation", Method::relaxation}},
      "The equilibrium by multigrid or relaxation, or the paper's explicit steps, averaged over time");
  app.add_option(
         "--divisions", params.divisions,
         "Hexahedra along an edge, separated by commas; default: the particles a specimen of the paper")
      ->delimiter(',');
  app.add_option("--volumes", params.volumes,
                 "Particles in the volumes over which estimators are compared, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("stress_homogeneous", [&] {
    if (common.quick) {
      if (app.count("--particles") == 0)
        common.particles = 2000;
      if (app.count("--volumes") == 0)
        params.volumes = {8};
      tension.convergence.interval = 500;
      tension.most_steps = 3000;
    }
    tension.packing.particles = common.particles;
    tension.packing.seed = common.seed;
    tension.threads = common.threads;
    tension.source = packings.source(common.out);
    params.validate();
    const io::OutputDirectory out(common.out);

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const auto result = homogeneous::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();

    std::printf("%s\n", homogeneous::headline(result).text().c_str());
    for (const std::string& table :
         {homogeneous::variability_text(result), homogeneous::distribution_text(result),
          homogeneous::estimators_text(result)})
      if (!table.empty())
        std::printf("%s\n", table.c_str());
    homogeneous::write(result, out);
    if (common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
