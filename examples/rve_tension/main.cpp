// Young's modulus and Poisson's ratio of a homogeneous cube by a tension test: [L17] section 2.3.

#include <cstdio>

#include "options.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace rve = examples::rve_tension;
  CLI::App app(
      "A cube of bonded particles is pulled: E and nu of alumina and silica glass, [L17] section 2.3",
      "rve_tension");
  rve::Params params;
  rve::TensionOptions options(app, params, "results/rve_tension");
  examples::add_choice<rve::Method>(
      app, "--method", params.method,
      {{"verlet", rve::Method::verlet},
       {"static", rve::Method::statics},
       {"relaxation", rve::Method::relaxation}},
      "The paper's explicit steps, or the equilibrium by multigrid or relaxation");
  app.add_option("--steps", params.most_steps, "Most steps of a run that does not converge before")
      ->capture_default_str();
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("rve_tension", [&] {
    options.apply(app);
    const io::OutputDirectory out(options.common.out);
    params.checkpoints = out.path();

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const rve::Result result = rve::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();

    std::printf("%s\n", rve::tabulate(params, result).text().c_str());
    rve::remark(params, result);
    for (const auto& m : result.materials)
      if (!m.converged)
        std::printf("%s: E and nu had not settled to %g by step %llu; --steps allows more.\n",
                    m.material.name.c_str(), params.convergence.tolerance,
                    static_cast<unsigned long long>(m.motion.step));
    rve::write(params, result, out);
    if (options.common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
