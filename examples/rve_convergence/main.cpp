// E and nu of a cube in tension over the steps, and what they settle on: [L17] section 2.3, figure 5.

#include "report.hpp"
#include "rve_tension/options.hpp"

int main(int argc, char** argv) {
  using namespace cdem;
  namespace rve = examples::rve_tension;
  namespace convergence = examples::rve_convergence;
  CLI::App app(
      "E and nu of a cube in tension against time and steps, pulled suddenly and over a ramp, beside "
      "the static solution: [L17] figure 5",
      "rve_convergence");
  convergence::Params params;
  rve::TensionOptions options(app, params, "results/rve_convergence");
  app.add_option("--material", params.material, "alumina, silica or both")
      ->check(CLI::IsMember({"both", "alumina", "silica"}))
      ->capture_default_str();
  app.add_option("--steps", params.most_steps, "Steps of the run that is suddenly loaded")
      ->capture_default_str();
  app.add_option("--ramped-steps", params.ramped_steps, "Steps of the run with the ramp")
      ->capture_default_str();
  app.add_option("--observe", params.observe_every, "Steps from one reading of E and nu to the next")
      ->capture_default_str();
  app.add_option("--sample", params.sample_every,
                 "Steps from one point of the curves to the next, a multiple of those between readings")
      ->capture_default_str();
  if (const int status = examples::parse(app, argc, argv); status >= 0)
    return status;

  return examples::guarded("rve_convergence", [&] {
    if (options.common.quick && app.count("--sample") == 0)
      params.sample_every = 10;
    if (options.common.quick && app.count("--ramped-steps") == 0)
      params.ramped_steps = 2000;
    options.apply(app);
    params.validate();
    const io::OutputDirectory out(options.common.out);
    params.checkpoints = out.path();

    const io::Interrupt interrupt;
    io::TerminalProgress progress;
    const convergence::Result result =
        convergence::run(params, core::Monitor(progress.listener(), interrupt.flag()));
    progress.end_line();

    std::printf("%s\n", convergence::tabulate(params, result).text().c_str());
    rve::remark(params, result.body);
    std::printf("Steps are those from which a value stays within %g of the static solution; nan: it does not "
                "within the run.\n",
                convergence::wanted_error);
    convergence::write(params, result, out);
    if (options.common.plot)
      examples::draw(out.path());
    std::printf("Results: %s\n", out.path().c_str());
  });
}
