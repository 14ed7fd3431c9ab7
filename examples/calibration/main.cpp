// E and nu of packings of beams against r_mu, and the micro parameters of three materials: [L17] section 2.4, figure 7.

#include <cstdio>

#include "common/example.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace cal = examples::calibration;
  cal::Params params;
  examples::CommonOptions common;
  common.particles = params.particles;
  common.out = "results/calibration";
  examples::PackingOptions packings;
  std::vector<double> covs, growths;

  CLI::App app("Charts of E_mu and r_mu against E and nu, and the micro parameters of three materials, [L17] "
               "section 2.4",
               "calibration");
  common.add_to(app, 200);
  app.add_option("--packings", params.packings,
                 "Packings of each kind, one seed after the other; one more verifies")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--cov", covs, "CoVs of the Gaussian radii, separated by commas")
      ->delimiter(',')
      ->default_str("0.3,0.03");
  app.add_option("--growth", growths,
                 "Growth rate for each CoV, or one for all; default: 0.03, below a CoV of 0.1 0.02")
      ->delimiter(',');
  app.add_option("--density", params.density, "Volume fraction of the packing")->capture_default_str();
  app.add_option("--coordination", params.study.coordination, "Coordination number Z")->capture_default_str();
  app.add_option("--ratios", params.study.radius_ratios, "r_mu to measure at, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--micro-poisson", params.study.micro_poissons_ratio,
                 "Microscopic Poisson's ratio: sets G_mu")
      ->capture_default_str();
  examples::add_choice<cal::Test>(
      app, "--test", params.test, {{"periodic", cal::Test::periodic}, {"symmetric", cal::Test::symmetric}},
      "A mean strain on the periodic packing, or the paper's tension test on cubes cut out of it");
  packings.add_to(app, {"--particles", "--seed", "--packings", "--cov", "--growth", "--density"});
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("calibration", [&] {
    if (common.quick) {
      if (app.count("--particles") == 0)
        common.particles = 500;
      if (app.count("--packings") == 0)
        params.packings = 2;
      if (app.count("--ratios") == 0)
        params.study.radius_ratios = {0.1, 0.2, 0.3, 0.5, 0.7, 0.9};
      params.micro_at = {0.5};
    }
    if (covs.empty())
      for (const cal::Kind& kind : params.kinds)
        covs.push_back(kind.cov);
    core::expect(growths.size() <= 1 || growths.size() == covs.size(), "number of growth rates",
                 growths.size(), "one for all or one for each CoV is expected");
    params.kinds.clear();
    for (std::size_t k = 0; k < covs.size(); ++k)
      params.kinds.push_back(
          {covs[k], growths.empty() ? (covs[k] < 0.1 ? 0.02 : 0.03) : growths[growths.size() == 1 ? 0 : k]});
    params.particles = common.particles;
    params.seed = common.seed;
    params.threads = common.threads;
    params.source = packings.source(common.out);
    params.validate();
    const io::OutputDirectory out(common.out);
    params.table = out.file("calibration_measurements.csv");

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const cal::Result result = cal::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();
    std::printf("%s\n", cal::tabulate(result).text().c_str());
    for (const cal::KindResult& kind : result.kinds)
      for (const std::string& complaint : kind.out_of_reach)
        if (!complaint.empty())
          std::printf("%s: %s\n", kind.fit.chart.name.c_str(), complaint.c_str());
    cal::write(result, out);
    if (common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
