// E and nu of a homogeneous cube against the number of particles, over many packings: [L17] section 2.3, figure 6.

#include <cstdio>

#include "common/example.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace rve = examples::rve_size;
  rve::Params params;
  examples::CommonOptions common;
  common.particles = 2000000;
  common.out = "results/rve_size";
  examples::PackingOptions packings;
  std::vector<std::uint32_t> sizes;

  CLI::App app("E and nu against the number of particles, over many packings: [L17] section 2.3, figure 6",
               "rve_size");
  common.add_to(app, 500);
  app.get_option("--particles")
      ->description("Largest number of particles: sizes are 10000, 30000, 100000, ... up to it");
  app.get_option("--seed")->description(
      "Seed of the first packing of each size; the next have the next numbers");
  app.add_option("--sizes", sizes,
                 "Numbers of particles, separated by commas, instead of those up to --particles")
      ->delimiter(',')
      ->check(CLI::Range(std::uint32_t{500}, std::uint32_t{100000000}))
      ->excludes(app.get_option("--particles"));
  app.add_option("--packings", params.packings, "Packings of each size up to 700000")->capture_default_str();
  app.add_option("--packings-large", params.packings_large, "Packings of each size above")
      ->capture_default_str();
  app.add_option("--packings-periodic", params.packings_periodic,
                 "Packings of each size whose whole periodic stiffness is measured too")
      ->capture_default_str();
  app.add_option("--cov", params.packing.cov, "CoV of the Gaussian radii")->capture_default_str();
  app.add_option("--density", params.packing.density, "Volume fraction of the packing")
      ->capture_default_str();
  app.add_option("--growth", params.packing.growth_rate, "Growth rate of the spheres: slower packs denser")
      ->capture_default_str();
  packings.add_to(app, {"--particles", "--sizes", "--seed", "--packings", "--packings-large", "--cov",
                        "--density", "--growth"});
  app.add_option("--coordination", params.coordination, "Coordination number Z")->capture_default_str();
  examples::add_choice<Axis>(app, "--axis", params.axis, {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}},
                             "Axis of the tension");
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("rve_size", [&] {
    if (common.quick) {
      if (app.count("--particles") == 0)
        sizes = app.count("--sizes") ? sizes : std::vector<std::uint32_t>{1000, 2000, 4000};
      if (app.count("--packings") == 0)
        params.packings = 4;
      if (app.count("--packings-periodic") == 0)
        params.packings_periodic = 2;
    }
    if (sizes.empty()) { // half a decade apart, the paper's 700,000 and 2,000,000
      std::erase_if(params.sizes, [&](std::uint32_t size) { return size > common.particles; });
      if (params.sizes.empty() || params.sizes.back() != common.particles)
        params.sizes.push_back(common.particles);
    } else {
      params.sizes = sizes;
    }
    params.packing.seed = common.seed;
    params.threads = common.threads;
    params.source = packings.source(common.out);
    const bool given = !params.source.file.empty();
    if (given)
      params.sizes = {
          static_cast<std::uint32_t>(io::FromFile({.file = params.source.file}).pack().particles.size())};
    params.validate();
    const io::OutputDirectory out(common.out);
    const auto table = out.file("samples.csv");

    rve::Ledger ledger;
    if (!given)
      ledger.kept = rve::read_samples(params, table);
    if (!ledger.kept.empty())
      std::printf("%zu rows of an earlier run are kept: %s\n", ledger.kept.size(), table.c_str());
    ledger.keep = [&](const std::vector<rve::Sample>& samples) {
      rve::write_samples(params, samples, table);
    };

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    rve::Result result;
    try {
      result = rve::run(params, std::move(ledger), core::Monitor(progress.listener(), interrupt.flag()));
    } catch (const core::Interrupted& interrupted) {
      throw core::Interrupted(std::string(interrupted.what()) + "; the same command goes on from there");
    }
    progress.end_line();
    std::printf("%s\n", rve::summary(result).c_str());
    rve::write(result, out);
    if (common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
