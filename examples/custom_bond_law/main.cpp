// A bond law that is not in the library, in every integrator: one bond torn apart, a cube pulled until bonds soften.

#include <cstdio>

#include "common/example.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace custom = examples::custom_bond_law;
  using custom::Method;
  custom::Params params;
  examples::CommonOptions common;
  common.particles = 2000;
  common.out = "results/custom_bond_law";
  std::string method = "all";

  CLI::App app(
      "A beam that softens, a law in one file: one bond torn apart, a cube pulled by each integrator",
      "custom_bond_law");
  common.add_to(app, 500);
  app.add_option("--onset", params.law.onset, "Strain at which a bond begins to soften")
      ->capture_default_str();
  app.add_option("--rupture", params.law.rupture, "Strain at which nothing of a bond is left")
      ->capture_default_str();
  app.add_option("--strain", params.strain, "Strain that the cube is pulled to")->capture_default_str();
  app.add_option("--method", method, "Who pulls the cube: static, relaxation, verlet, or all in turn")
      ->check(CLI::IsMember({"all", "static", "relaxation", "verlet"}))
      ->capture_default_str();
  app.add_option("--steps", params.steps, "Steps of velocity Verlet")->capture_default_str();
  examples::PackingOptions packings;
  packings.add_to(app, {"--particles", "--seed"});
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("custom_bond_law", [&] {
    if (common.quick) {
      if (app.count("--particles") == 0)
        common.particles = 600;
      if (app.count("--steps") == 0)
        params.steps = 5000;
    }
    params.packing.particles = common.particles;
    params.packing.seed = common.seed;
    params.threads = common.threads;
    params.source = packings.source(common.out);
    if (method != "all")
      params.methods = {method == "static"       ? Method::statics
                        : method == "relaxation" ? Method::relaxation
                                                 : Method::verlet};
    params.validate();
    const io::OutputDirectory out(common.out);

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const custom::Result result = custom::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();
    std::printf("%s\n", custom::tabulate(result).text().c_str());
    custom::write(result, out);
    if (common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
