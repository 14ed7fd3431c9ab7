#pragma once

// How E and nu settle over the steps of a tension test: [L17] section 2.3 and figure 5, beside the static solution that
// they should settle on, the load imposed suddenly and over a ramp.

#include <array>
#include <limits>

#include "rve_tension/scenario.hpp"

namespace cdem::examples::rve_convergence {

namespace rve = rve_tension;

/// The test of rve_tension; the ramp is that of the second loading.
struct Params : rve::Params {
  std::uint64_t ramped_steps = 12500; ///< of the run with the ramp, which settles sooner
  std::string material = "both";      ///< of the paper's, or the name of one

  Params() {
    ramp = 4;
    most_steps = 30000;
    until_converged = false;
  }

  /// @throws core::InvalidInput for what rve_tension does not accept, no ramp, or too few steps to follow it
  void validate() const {
    rve::Params::validate();
    core::expect_positive(ramp, "ramp", "periods");
    core::expect(ramped_steps > convergence.interval, "ramped steps", ramped_steps,
                 "more than the interval of the convergence checks, " + std::to_string(convergence.interval) +
                     ", is expected");
    core::expect(convergence.interval % sample_every == 0, "sample_every", sample_every,
                 "a divisor of the interval of the convergence checks, " +
                     std::to_string(convergence.interval) + ", is expected");
  }
};

/// What is followed over the steps.
enum class Modulus : std::uint8_t { youngs_modulus, poissons_ratio };
constexpr std::array moduli = {Modulus::youngs_modulus, Modulus::poissons_ratio};

/// Which of its values.
enum class Average : std::uint8_t {
  none,  ///< that of the step
  all,   ///< mean over all steps so far, the first included: the paper's
  steady ///< mean over those from the first crossing of the wave, or the end of the ramp, on
};
constexpr std::array averages = {Average::none, Average::all, Average::steady};

/// The explicit steps of one material under one loading.
struct March {
  std::string loading;              ///< "sudden", "ramped"
  rve::MaterialResult run;          ///< without its fields
  std::vector<std::uint64_t> steps; ///< [samples]

  /// [samples] values
  std::vector<double> curve(Modulus modulus, Average average) const {
    std::vector<double> values;
    values.reserve(run.samples.size());
    const bool youngs = modulus == Modulus::youngs_modulus;
    for (const auto& s : run.samples)
      values.push_back(average == Average::none ? (youngs ? s.youngs_modulus : s.poissons_ratio)
                       : average == Average::all
                           ? (youngs ? s.youngs_modulus_average : s.poissons_ratio_average)
                           : (youngs ? s.youngs_modulus_steady : s.poissons_ratio_steady));
    return values;
  }

  /// How strongly force and strain swing against each other once all is under way: root mean square, about its mean, of
  /// (E/E_static - 1) s(t), over that of a single vibration of the body's first frequency after a sudden start, 1/(w sqrt 2).
  double vibration(double asymptote) const {
    homogenize::RunningAverage mean, square;
    for (const auto& sample : run.samples)
      if (sample.step >= static_cast<double>(run.steady_from)) {
        const double swing = (sample.youngs_modulus / asymptote - 1) * run.loading.at(sample.time).way;
        mean.add(swing);
        square.add(swing * swing);
      }
    const double variance = square.mean() - mean.mean() * mean.mean();
    return std::sqrt(2 * std::max(variance, 0.0)) * run.first_frequency;
  }
};

/// One material: the static solution and the ways to it.
struct Approach {
  rve::MaterialResult statics; ///< without its fields
  std::vector<March> marches;

  double asymptote(Modulus modulus) const {
    return modulus == Modulus::youngs_modulus ? statics.moduli.youngs_modulus : statics.moduli.poissons_ratio;
  }
};

struct Result {
  rve::Result body; ///< no materials in it
  std::vector<Approach> materials;
};

namespace detail {

/// The fields of 700,000 particles are in the way when there are six runs.
inline rve::MaterialResult without_fields(rve::MaterialResult run) {
  run.motion.displacement = {};
  run.motion.velocity = {};
  run.motion.acceleration = {};
  run.bond_forces = {};
  return run;
}

inline March march(const rve::Material& material, const std::string& loading, const rve::Params& params,
                   const rve::Result& body, core::ThreadPool& pool, const core::Monitor& monitor) {
  March march{
      loading,
      without_fields(rve::detail::pull(material, material.name + "_" + loading, params, body, pool, monitor)),
      {}};
  for (const auto& sample : march.run.samples)
    march.steps.push_back(static_cast<std::uint64_t>(sample.step));
  return march;
}

} // namespace detail

/// Packs and bonds once; each material is solved at rest, pulled suddenly, and pulled over a ramp.
inline Result run(const Params& params, const core::Monitor& monitor = {}) {
  params.validate();
  core::ThreadPool pool(params.threads);
  Result result{rve::detail::prepare(params, pool, monitor), {}};
  rve::Params statics = params, sudden = params, ramped = params;
  statics.method = rve::Method::statics;
  sudden.ramp = 0;
  sudden.steady_after = 1; // the wave has crossed the body and come back
  ramped.steady_after = params.ramp;
  ramped.most_steps = params.ramped_steps;
  for (const rve::Material& material : rve::paper_materials()) {
    if (params.material != "both" && params.material != material.name)
      continue;
    Approach approach;
    approach.statics = detail::without_fields(
        rve::detail::pull(material, material.name + "_static", statics, result.body, pool, monitor));
    approach.marches.push_back(detail::march(material, "sudden", sudden, result.body, pool, monitor));
    approach.marches.push_back(detail::march(material, "ramped", ramped, result.body, pool, monitor));
    result.materials.push_back(std::move(approach));
  }
  return result;
}

} // namespace cdem::examples::rve_convergence
