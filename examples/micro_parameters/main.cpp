// Why the paper's printed micro parameters give what they give: E_a and nu on packings of many kinds.

#include <cstdio>

#include "common/example.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace study = examples::micro_parameters;
  study::Params params;
  examples::CommonOptions common;
  common.out = "results/micro_parameters";
  examples::PackingOptions packings;

  CLI::App app("E_a and nu of the paper's three materials on packings of many kinds, beside what it prints",
               "micro_parameters");
  common.add_to(app, 500);
  app.add_option("--packings", params.packings, "Packings of each kind")->capture_default_str();
  app.add_option("--cov", params.covs, "CoVs of the Gaussian radii, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--density", params.density,
                 "Volume fraction of the packings that are not grown until they jam")
      ->capture_default_str();
  app.add_option("--growth", params.growth_rate, "Growth rate of the spheres: slower packs denser")
      ->capture_default_str();
  app.add_option("--pressure", params.jammed_pressure, "Reduced pressure at which a packing counts as jammed")
      ->capture_default_str();
  packings.add_to(app,
                  {"--particles", "--seed", "--packings", "--cov", "--density", "--growth", "--pressure"});
  app.add_option("--coordination", params.coordinations, "Coordination numbers Z, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  std::vector<std::string> laws;
  app.add_option("--laws", laws, "Bond laws, separated by commas: beam, timoshenko, two_thirds; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>{"beam", "timoshenko", "two_thirds"}));
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("micro_parameters", [&] {
    if (common.quick) {
      if (app.count("--particles") == 0)
        common.particles = 1000;
      if (app.count("--packings") == 0)
        params.packings = 1;
      if (app.count("--cov") == 0)
        params.covs = {0.03, 0.3};
      if (app.count("--coordination") == 0)
        params.coordinations = {6, 8};
      if (app.count("--pressure") == 0)
        params.jammed_pressure = 1e4;
    }
    if (!laws.empty())
      params.laws.clear();
    for (const study::Law law : study::all_laws)
      if (std::find(laws.begin(), laws.end(), study::name_of(law)) != laws.end())
        params.laws.push_back(law);
    params.particles = common.particles;
    params.seed = common.seed;
    params.threads = common.threads;
    params.source = packings.source(common.out);
    params.validate();
    const io::OutputDirectory out(common.out);
    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const study::Result result = study::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();
    std::printf("%s\n", study::summary(result).c_str());
    study::write(result, out);
    if (common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
