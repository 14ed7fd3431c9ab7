#pragma once

// What the paper's printed micro parameters give on packings of many kinds: which kind was the paper's?

#include <cdem/bond/beam.hpp>
#include <cdem/bond/timoshenko_beam.hpp>
#include <cdem/homogenize/sample_statistics.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/simulation/specimen.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/measures.hpp"
#include "common/packings.hpp"
#include "common/paper_materials.hpp"

namespace cdem::examples::micro_parameters {

/// How the bonds resist; stretch, torsion and bending are the beam's in all of them.
enum class Law : std::uint8_t {
  beam,       ///< the paper's: Euler-Bernoulli, K_t = 12 E_mu I / L^3
  timoshenko, ///< bond::TimoshenkoBeam: K_t less by 1 + Phi, the beam's own shear
  two_thirds, ///< K_t two thirds of the beam's whatever its radius: a lead of the study, not a model
};
inline constexpr std::array all_laws{Law::beam, Law::timoshenko, Law::two_thirds};

inline const char* name_of(Law law) {
  constexpr std::array names{"beam", "timoshenko", "two_thirds"};
  return names[static_cast<std::size_t>(law)];
}

/// A bond law chosen at run time.
struct StudiedLaw {
  Law law;
  bond::Beam<> beam;
  bond::TimoshenkoBeam<> timoshenko;

  StudiedLaw(Law chosen, const bond::Material& material)
      : law(chosen), beam({.materials = {material}}), timoshenko({.materials = {material}}) {}

  bond::ChannelStiffness stiffness(const bond::BondGeometry& bond) const {
    if (law == Law::timoshenko)
      return timoshenko.stiffness(bond);
    bond::ChannelStiffness k = beam.stiffness(bond);
    if (law == Law::two_thirds)
      k.tangential *= 2.0 / 3;
    return k;
  }
  void validate(const particles::ParticleSet& particles) const { beam.validate(particles); }
};
static_assert(bond::BondLaw<StudiedLaw>);

/// A kind of packing.
struct Kind {
  double cov = 0;
  packing::Boundary boundary = packing::Boundary::periodic;
  bool jammed =
      false; ///< grown on until it jams; otherwise stopped at the density asked for, where it gets so far

  std::string name() const {
    return "cov=" + core::to_text(cov) + (boundary == packing::Boundary::periodic ? ",periodic" : ",walls") +
           (jammed ? ",jammed" : "");
  }
};

struct Params {
  std::vector<double> covs = {0, 0.03, 0.1, 0.3};
  std::vector<double> coordinations = {5.5, 6, 6.2, 6.5, 7, 8}; ///< Z
  std::vector<Law> laws{all_laws.begin(), all_laws.end()};
  std::uint32_t particles = 10000;
  int packings = 3; ///< of each kind
  std::uint64_t seed = 1;
  double density = 0.64;        ///< [L17] section 2.1
  double growth_rate = 0.02;    ///< the fastest at which equal spheres reach 0.64
  double jammed_pressure = 1e5; ///< reduced pressure that counts as jammed
  PackingSource source = {};    ///< a packing given stands for all kinds
  int threads = 0;

  std::vector<Kind> kinds() const {
    std::vector<Kind> all;
    for (const double cov : covs)
      for (const auto boundary : {packing::Boundary::periodic, packing::Boundary::walls})
        for (const bool jammed : {false, true})
          all.push_back({cov, boundary, jammed});
    return all;
  }
  packing::LubachevskyStillinger::Parameters packing_of(const Kind& kind, int number) const {
    return {.particles = particles,
            .density = kind.jammed ? 0.74 : density,
            .cov = kind.cov,
            .growth_rate = growth_rate,
            .pressure_limit = jammed_pressure,
            .boundary = kind.boundary,
            .seed = seed + static_cast<std::uint64_t>(number)};
  }
  /// @throws core::InvalidInput for what no stage would accept, before anything is computed or written
  void validate() const {
    core::expect(!covs.empty(), "number of CoVs", covs.size(), "1 or more is expected");
    core::expect(!coordinations.empty(), "number of coordinations", coordinations.size(),
                 "1 or more is expected");
    for (const double z : coordinations)
      core::expect_positive(z, "coordination");
    core::expect(!laws.empty(), "number of laws", laws.size(), "1 or more is expected");
    core::expect(packings >= 1, "packings", packings, "1 or more is expected");
    for (const Kind& kind : kinds())
      packing::LubachevskyStillinger{packing_of(kind, 0)};
  }
};

/// The paper's three materials, in the order of every array here: r_mu 0.169, 0.545, 0.722.
inline std::array<PaperMaterial, 3> materials() {
  return {aluminium(), alumina(), silica()};
}

/// E_a and nu of the three materials on one kind of packing, at one Z, by one measure.
struct Case {
  Kind kind;
  double coordination = 0;
  Law law = Law::beam;
  Measure measure = Measure::faces;
  std::array<homogenize::SampleStatistics, 3> relative_modulus; ///< E_a = E_M / E_mu
  std::array<homogenize::SampleStatistics, 3> poissons_ratio;   ///< nu_M
  double eps = 0; ///< of eq. 1, mean over the packings; of the body that was measured

  /// Root mean square of the relative deviations of E_a and nu from the paper's, six values; NaN if nu was not measured.
  double deviation() const {
    double sum = 0;
    for (std::size_t m = 0; m < 3; ++m) {
      const PaperMaterial material = materials()[m];
      const double E_a = material.youngs_modulus / material.micro.youngs_modulus;
      sum += std::pow(relative_modulus[m].mean / E_a - 1, 2) / 6;
      sum += std::pow(poissons_ratio[m].mean / material.poissons_ratio - 1, 2) / 6;
    }
    return std::sqrt(sum);
  }
};

/// What was packed.
struct KindResult {
  Kind kind;
  homogenize::SampleStatistics density, pressure;
};

struct Result {
  std::vector<KindResult> kinds;
  std::vector<Case> cases; ///< by kind, Z, law, measure

  /// The cases from the closest to the paper's six values on; those without nu are left out.
  std::vector<Case> closest() const {
    std::vector<Case> sorted;
    for (const Case& one : cases)
      if (std::isfinite(one.deviation()))
        sorted.push_back(one);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Case& a, const Case& b) { return a.deviation() < b.deviation(); });
    return sorted;
  }
};

namespace detail {

/// CoV of the radii of a packing given as a file, to three digits.
inline double sample_cov(const particles::ParticleSet& particles) {
  const auto radii = homogenize::sample_statistics(particles.radius);
  return std::round(1e3 * radii.deviation / radii.mean) / 1e3;
}

inline void judge(const packing::LubachevskyStillinger::Report& report) {
  if (report.reason != packing::StopReason::pressure_limit) // jammed is as good
    report.require_reached();
}

/// Everything about one packing at one Z with one law: what each measure gives for the three materials.
inline std::array<MeasuredModuli, 3> measure(const simulation::Specimen& body,
                                             const simulation::Specimen* cell, Law law,
                                             core::ThreadPool& pool, const core::Monitor& monitor) {
  std::array<MeasuredModuli, 3> moduli;
  const StaticSolver solver;
  for (std::size_t m = 0; m < 3; ++m) {
    const StudiedLaw bonds(law, materials()[m].micro);
    measure_tension(moduli[m], bonds, body, Axis::x, solver, pool, monitor);
    if (cell)
      measure_periodic(moduli[m], bonds, *cell, pool, monitor);
  }
  return moduli;
}

/// What the packings of one kind gave.
struct Samples {
  /// At one Z with one law, a value a packing.
  struct Condition {
    double coordination;
    Law law;
    std::vector<double> eps = {}, eps_periodic = {}; ///< of the walled or cut body, of the periodic one
    std::vector<std::array<MeasuredModuli, 3>> moduli = {};
  };
  std::vector<Condition> conditions;
  std::vector<double> density, pressure;
  bool all_jammed = true; ///< below the density asked for

  explicit Samples(const Params& params) {
    for (const double z : params.coordinations)
      for (const Law law : params.laws)
        conditions.push_back({z, law});
  }

  /// Bonds and measures one packing under every condition. @param tell  called with the share done and the condition
  template <class Obtained, class Tell>
  void add(const Obtained& obtained, core::ThreadPool& pool, Tell&& tell) {
    const auto& packing = obtained.packing;
    density.push_back(packing.particles.solid_volume() / packing.box.volume());
    pressure.push_back(obtained.reported ? packing.report.pressure
                                         : std::numeric_limits<double>::quiet_NaN());
    all_jammed &= obtained.reported && packing.report.reason == packing::StopReason::pressure_limit;
    for (std::size_t c = 0; c < conditions.size(); ++c) {
      Condition& condition = conditions[c];
      tell(static_cast<double>(c) / static_cast<double>(conditions.size()), condition);
      const auto body =
          simulation::make_specimen(packing.particles, packing.box, condition.coordination, pool);
      condition.eps.push_back(body.eps);
      std::optional<simulation::Specimen> cell;
      if (packing.box.periodic[0])
        cell =
            simulation::make_periodic_specimen(packing.particles, packing.box, condition.coordination, pool);
      condition.eps_periodic.push_back(cell ? cell->eps : 0);
      condition.moduli.push_back(measure(body, cell ? &*cell : nullptr, condition.law, pool, {}));
    }
  }
};

/// The statistics of one condition by one measure.
inline Case case_of(const Kind& kind, const Samples::Condition& condition, Measure measure) {
  const auto& eps = measure == Measure::periodic ? condition.eps_periodic : condition.eps;
  Case one{
      kind, condition.coordination, condition.law, measure, {}, {}, homogenize::sample_statistics(eps).mean};
  for (std::size_t m = 0; m < 3; ++m) {
    std::vector<double> relative_modulus, poissons_ratio;
    for (const auto& of_packing : condition.moduli) {
      relative_modulus.push_back(of_packing[m][measure].youngs_modulus / materials()[m].micro.youngs_modulus);
      poissons_ratio.push_back(of_packing[m][measure].poissons_ratio);
    }
    one.relative_modulus[m] = homogenize::sample_statistics(relative_modulus);
    one.poissons_ratio[m] = homogenize::sample_statistics(poissons_ratio);
  }
  return one;
}

} // namespace detail

/// Packs, bonds and measures every combination.
inline Result run(const Params& params, const core::Monitor& monitor = {}) {
  params.validate();
  core::ThreadPool pool(params.threads);
  const bool given = !params.source.file.empty();
  const std::vector<Kind> kinds = given ? std::vector<Kind>(1) : params.kinds();
  const int packings = given ? 1 : params.packings;
  Result result;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    Kind kind = kinds[k];
    const auto report = [&](double fraction, const std::string& detail) {
      monitor.report(
          {kind.name(), (static_cast<double>(k) + fraction) / static_cast<double>(kinds.size()), detail});
    };
    const core::Monitor packs(
        [&](const core::Progress& progress) { report(0.5 * progress.fraction, progress.detail); });
    std::vector<packing::LubachevskyStillinger::Parameters> wanted;
    for (int number = 0; number < packings; ++number)
      wanted.push_back(params.packing_of(kind, number));
    make_packings_ahead<packing::LubachevskyStillinger>(wanted, params.source, detail::judge, packs, pool);

    detail::Samples samples(params);
    for (int number = 0; number < packings; ++number) {
      const auto obtained = obtain_packing<packing::LubachevskyStillinger>(
          wanted[static_cast<std::size_t>(number)], params.source, detail::judge, packs, &pool);
      if (given)
        kind = {detail::sample_cov(obtained.packing.particles),
                obtained.packing.box.periodic[0] ? packing::Boundary::periodic : packing::Boundary::walls,
                false};
      samples.add(obtained, pool, [&](double fraction, const detail::Samples::Condition& condition) {
        report(0.5 + 0.5 * (number + fraction) / packings, "Z " + core::to_text(condition.coordination));
      });
    }
    if (samples.all_jammed && !kind.jammed) { // growing on gives the same packings once more
      kind.jammed = true;
      ++k;
    }
    result.kinds.push_back({kind, homogenize::sample_statistics(samples.density),
                            homogenize::sample_statistics(samples.pressure)});
    for (const auto& condition : samples.conditions)
      for (const Measure measure : all_measures)
        if (condition.moduli.front().front().has(measure))
          result.cases.push_back(detail::case_of(kind, condition, measure));
  }
  return result;
}

} // namespace cdem::examples::micro_parameters
