#pragma once

// The options of a cube in tension, shared by rve_tension and rve_convergence.

#include "common/example.hpp"
#include "scenario.hpp"

namespace cdem::examples::rve_tension {

/// Body, test and time stepping; the values go straight into the Params, whose defaults are the options'.
struct TensionOptions {
  CommonOptions common;
  PackingOptions packings;
  Params& params;

  TensionOptions(CLI::App& app, Params& wanted, const char* out) : params(wanted) {
    common.out = out;
    common.add_to(app, 500);
    add_packing_parameters(app, params.packing);
    packings.add_to(app, {"--particles", "--seed", "--cov", "--density", "--growth", "--boundary"});
    app.add_option("--coordination", params.coordination, "Coordination number Z")->capture_default_str();
    add_choice<Axis>(app, "--axis", params.axis, {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}},
                     "Axis of the tension");
    app.add_option("--damping", params.damping_ratio, "Damping ratio of the first axial vibration")
        ->capture_default_str();
    using integrate::DensityScaling;
    add_choice<DensityScaling>(
        app, "--scaling", params.scaling,
        {{"per_particle", DensityScaling::per_particle}, {"uniform", DensityScaling::uniform}},
        "Density scaling to the paper's time step");
    app.add_option("--ramp", params.ramp,
                   "Periods of that vibration over which the loaded face is accelerated; 0: at once")
        ->capture_default_str();
    app.add_flag("--resume", params.resume, "Go on from the checkpoints in the results folder");
  }
  TensionOptions(const TensionOptions&) = delete;

  /// Takes over what was parsed. A quick run is small, and looks more often.
  void apply(const CLI::App& app) {
    if (common.quick) {
      if (app.count("--particles") == 0)
        common.particles = 1000;
      params.convergence.interval = 500;
      if (app.count("--steps") == 0)
        params.most_steps = 3000;
    }
    params.packing.particles = common.particles;
    params.packing.seed = common.seed;
    params.threads = common.threads;
    params.source = packings.source(common.out);
    params.validate();
  }
};

} // namespace cdem::examples::rve_tension
