// Young's modulus of a cube, with the law and the integrator chosen on the command line.

#include <cdem/io/output_directory.hpp>
#include <cdem/io/results.hpp>

#include <cstdio>

#include "common/example.hpp"
#include "scenario.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace choice = examples::runtime_choice;
  choice::Params params;
  examples::CommonOptions common;
  common.particles = 2000;
  common.out = "results/runtime_choice";

  CLI::App app("A cube is pulled: law and integrator are chosen here, among those that were compiled",
               "runtime_choice");
  common.add_to(app, 500);
  app.add_option("--law", params.law, "Bond law: beam, spring, or rotating_beam for rotations of any size")
      ->check(CLI::IsMember({"beam", "spring", "rotating_beam"}))
      ->capture_default_str();
  app.add_option("--method", params.method, "Integrator: relaxation (the equilibrium) or verlet (in time)")
      ->check(CLI::IsMember({"relaxation", "verlet"}))
      ->capture_default_str();
  app.add_option("--strain", params.strain, "Strain that the cube is pulled to")->capture_default_str();
  app.add_option("--steps", params.steps, "Steps of velocity Verlet")->capture_default_str();
  examples::PackingOptions packings;
  packings.add_to(app, {"--particles", "--seed"});
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("runtime_choice", [&] {
    if (common.quick && app.count("--particles") == 0)
      common.particles = 600;
    if (common.quick && app.count("--steps") == 0)
      params.steps = 5000;
    params.packing.particles = common.particles;
    params.packing.seed = common.seed;
    params.threads = common.threads;
    params.source = packings.source(common.out);
    params.validate();
    const io::OutputDirectory out(common.out);

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const choice::Result result = choice::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();
    const std::string condition = "[law=" + params.law + "]";
    io::Results table;
    table.add({"cube.youngs_modulus" + condition, "E_M", result.youngs_modulus, "Pa"});
    table.add({"cube.poissons_ratio" + condition, "nu_M", result.poissons_ratio});
    table.add({"cube.elastic_energy" + condition, "", result.elastic_energy, "J"});
    std::printf("%s\n", table.text().c_str());
    table.write_csv(out.file("results.csv"));
    std::printf("Results: %s\n", out.path().c_str());
  });
}
