// How even the bonds of a packing are, and how wide its gaps, against the number of particles: [L17] figures 1 and 2.

#include <cstdio>

#include "common/example.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace ecd = examples::ecd_isotropy;
  ecd::Params params;
  examples::CommonOptions common;
  common.particles = 100000;
  common.out = "results/ecd_isotropy";
  examples::PackingOptions packings;
  std::vector<std::uint32_t> sizes;

  CLI::App app(
      "Anisotropy E_k and eps of the bonds at Z = 6.2 against the number of particles, [L17] section 2.1",
      "ecd_isotropy");
  common.add_to(app, 500);
  app.get_option("--particles")
      ->description("Largest number of particles: sizes are 10000, 20000, 50000, ... up to it");
  app.add_option("--sizes", sizes,
                 "Numbers of particles, separated by commas, instead of those up to --particles")
      ->delimiter(',')
      ->check(CLI::Range(std::uint32_t{500}, std::uint32_t{100000000}))
      ->excludes(app.get_option("--particles"));
  app.add_option("--cov", params.covs, "CoVs of the Gaussian radii, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  examples::add_choice<ecd::GeneratorKind>(
      app, "--generator", params.generator,
      {{"lsa", ecd::GeneratorKind::lubachevsky_stillinger}, {"soft", ecd::GeneratorKind::soft_spheres}},
      "Who packs: lsa, the Lubachevsky-Stillinger algorithm; soft, soft spheres in balance");
  app.add_option("--density", params.density, "Volume fraction of the packing")->capture_default_str();
  app.add_option("--growth", params.growth_rate, "Growth rate of the spheres: slower packs denser")
      ->capture_default_str();
  app.add_option("--pressure", params.pressure_limit, "Reduced pressure at which a packing counts as jammed")
      ->capture_default_str();
  app.add_option("--coordination", params.coordination, "Coordination number Z")->capture_default_str();
  packings.add_to(app, {"--particles", "--sizes", "--seed", "--cov", "--generator", "--density", "--growth",
                        "--pressure"});
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("ecd_isotropy", [&] {
    if (common.quick && app.count("--particles") == 0)
      common.particles = 1000;
    if (common.quick && app.count("--cov") == 0)
      params.covs = {0, 0.3};
    if (sizes.empty()) // a third of a decade apart, and the two of which the paper prints something
      for (const std::uint32_t size : {10000U, 20000U, 50000U, 100000U, 200000U, 500000U, 700000U, 1000000U})
        if (size <= common.particles)
          sizes.push_back(size);
    if (app.count("--sizes") == 0 && (sizes.empty() || sizes.back() != common.particles))
      sizes.push_back(common.particles);
    params.sizes = sizes;
    params.seed = common.seed;
    params.threads = common.threads;
    params.source = packings.source(common.out);
    params.validate();
    const io::OutputDirectory out(common.out);

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const ecd::Result result = ecd::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();
    std::printf("%s\n", ecd::summary(result).c_str());
    for (const ecd::Case& one : result.cases)
      if (one.jammed_before)
        std::printf("CoV %g, %u particles: jammed at a density of %.4f, below the %.4g asked for; --growth "
                    "below %g packs "
                    "denser.\n",
                    one.cov, one.particles, one.quality.density, params.density, params.growth_rate);
    ecd::write(result, out);
    if (common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
