#pragma once

// E_a and nu against r_mu over several packings, charts, micro parameters of three materials: [L17] section 2.4.

#include <cdem/homogenize/calibration_measurement.hpp>
#include <cdem/homogenize/static_tension.hpp>
#include <cdem/io/csv.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/packings.hpp"
#include "common/static_solver.hpp"

namespace cdem::examples::calibration {

using Generator = packing::LubachevskyStillinger;

enum class Test { periodic, symmetric };

/// A material of the paper, and the micro parameters it prints.
struct Material {
  std::string name;
  homogenize::TargetModuli macro;
  double printed_modulus, printed_ratio; ///< E_mu, Pa, and r_mu
};

inline const std::array<Material, 3>& materials() {
  static const std::array<Material, 3> list{{{"alumina", {350e9, 0.24}, 2536e9, 0.545},
                                             {"silica", {65e9, 0.20}, 220.2e9, 0.722},
                                             {"aluminium", {72.5e9, 0.33}, 12020e9, 0.169}}};
  return list;
}

/// A kind of packing.
struct Kind {
  double cov = 0.3;
  double growth_rate = 0.03;
};

struct Params {
  std::vector<Kind> kinds{{0.3, 0.03}, {0.03, 0.02}};
  std::uint32_t particles = 100000;
  std::uint64_t seed =
      1; ///< of the first packing; the others have the next ones, and the one to verify with the last
  std::uint32_t packings = 5; ///< a kind
  double density = 0.64;
  homogenize::CalibrationStudy study;
  std::vector<double> micro_ratios{0, 0.15, 0.49}; ///< nu_mu tried beside the study's, on the first packing
  std::vector<double> micro_at{0.2, 0.5, 0.8};     ///< r_mu at which they are tried
  Test test = Test::periodic;
  int threads = 0;
  PackingSource source;
  std::filesystem::path table; ///< file in which measurements are kept; empty: none

  Generator::Parameters packing(const Kind& kind, std::uint64_t with_seed) const {
    Generator::Parameters p{.particles = particles, .density = density, .cov = kind.cov};
    p.growth_rate = kind.growth_rate;
    p.seed = with_seed;
    return p;
  }
  void validate() const {
    core::expect(!kinds.empty(), "number of CoVs", kinds.size(), "1 or more is expected");
    core::expect(packings >= 1, "packings", packings, "1 or more is expected");
    core::expect(study.radius_ratios.size() >= 4, "number of r_mu", study.radius_ratios.size(),
                 "4 or more is expected");
    for (const double r : study.radius_ratios)
      core::expect(r > 0 && r <= 1, "r_mu", r, "a number in ]0, 1] is expected");
    core::expect_positive(study.coordination, "coordination");
    for (const Kind& kind : kinds)
      Generator{packing(kind, seed)};
  }
};

/// One measurement: what the table keeps.
struct Measurement {
  std::string key; ///< everything it depends on
  double cov = 0;
  std::uint64_t seed = 0;
  double radius_ratio = 0, micro_ratio = 0, micro_modulus = 1;
  double relative_modulus = 0, poissons_ratio = 0;
  double affine_modulus = 0, affine_poissons = 0;                 ///< Voigt's bound; NaN where not measured
  double distance = 0, anisotropy = 0, smallest = 0, largest = 0; ///< likewise, extremes over E_mu
  double asymmetry = 0;                                           ///< likewise
  std::uint64_t iterations = 0;
  double seconds = 0;
};

/// Measurements made so far, in a file that is whole after each.
class Table {
public:
  explicit Table(std::filesystem::path file) : file_(std::move(file)) {
    std::error_code ignored;
    if (file_.empty() || !std::filesystem::exists(file_, ignored))
      return;
    const io::CsvTable kept = io::read_csv(file_);
    const std::size_t key = kept.column("key");
    std::vector<std::vector<double>> columns;
    for (const char* name : numbers)
      columns.push_back(kept.numbers(name));
    for (std::size_t r = 0; r < kept.rows.size(); ++r) {
      const auto at = [&](std::size_t c) { return columns[c][r]; };
      rows_.push_back({kept.rows[r][key], at(0), static_cast<std::uint64_t>(at(1)), at(2), at(3), at(4),
                       at(5), at(6), at(7), at(8), at(9), at(10), at(11), at(12), at(13),
                       static_cast<std::uint64_t>(at(14)), at(15)});
    }
  }

  const Measurement* find(const std::string& key) const {
    for (const Measurement& row : rows_)
      if (row.key == key)
        return &row;
    return nullptr;
  }

  void add(Measurement row) {
    rows_.push_back(std::move(row));
    if (file_.empty())
      return;
    std::vector<std::string> columns{"key"};
    columns.insert(columns.end(), numbers.begin(), numbers.end());
    io::CsvWriter writer(file_, columns);
    for (const Measurement& m : rows_)
      writer.row(m.key, m.cov, m.seed, m.radius_ratio, m.micro_ratio, m.micro_modulus, m.relative_modulus,
                 m.poissons_ratio, m.affine_modulus, m.affine_poissons, m.distance, m.anisotropy, m.smallest,
                 m.largest, m.asymmetry, m.iterations, m.seconds);
    writer.commit();
  }

private:
  static constexpr std::array<const char*, 16> numbers{"cov",
                                                       "seed",
                                                       "radius_ratio",
                                                       "micro_poissons_ratio",
                                                       "micro_modulus_pa",
                                                       "relative_modulus",
                                                       "poissons_ratio",
                                                       "affine_modulus",
                                                       "affine_poissons_ratio",
                                                       "distance_from_isotropy",
                                                       "universal_anisotropy",
                                                       "smallest_modulus",
                                                       "largest_modulus",
                                                       "asymmetry",
                                                       "iterations",
                                                       "seconds"};
  std::filesystem::path file_;
  std::vector<Measurement> rows_;
};

/// The chart of one kind of packing, and what it was tried on.
struct KindResult {
  Kind kind;
  std::uint32_t particles = 0;
  bool given = false;                  ///< a packing that was given: one, and none to verify with
  std::vector<Measurement> points;     ///< that the chart is made of
  std::vector<Measurement> micro;      ///< of other nu_mu
  std::vector<Measurement> other_unit; ///< of other E_mu
  homogenize::CalibrationFit fit;
  std::array<std::optional<homogenize::MicroParameters>, 3> calibrated; ///< none: out of reach
  std::array<std::string, 3> out_of_reach;
  std::array<std::optional<Measurement>, 3> verified; ///< on the packing that the chart has not seen
};

struct Result {
  std::vector<KindResult> kinds;
};

namespace detail {

/// Packings and bodies are made when a measurement is not in the table yet, and the last one is held.
class Bench {
public:
  Bench(const Params& params, core::ThreadPool& pool, const core::Monitor& monitor)
      : params_(params), pool_(pool), monitor_(monitor), table_(params.table) {}

  std::uint32_t given_particles() { return static_cast<std::uint32_t>(body({}, 0).particles.size()); }

  Measurement measure(const Kind& kind, std::uint64_t seed, const bond::Material& material) {
    const std::string identity = packing_identity<Generator>(params_.packing(kind, seed), params_.source);
    Measurement m;
    m.key = (params_.test == Test::periodic ? "periodic-" : "symmetric-") +
            examples::detail::in_hexadecimal(examples::detail::hash_of(identity)) + "-z" +
            core::to_text(params_.study.coordination) + "-e" + io::number_to_text(material.youngs_modulus) +
            "-r" + io::number_to_text(material.radius_ratio) + "-nu" +
            io::number_to_text(material.poissons_ratio);
    if (const Measurement* kept = table_.find(m.key))
      return *kept;
    m.cov = kind.cov;
    m.seed = seed;
    m.radius_ratio = material.radius_ratio;
    m.micro_ratio = material.poissons_ratio;
    m.micro_modulus = material.youngs_modulus;
    const simulation::Specimen& specimen = body(kind, seed);
    const std::string stage = name(kind, seed) + ", r_mu " + core::to_text(material.radius_ratio);
    const core::Monitor shown([&](const core::Progress&) { monitor_.report({stage, 0, ""}); }); // and stops
    const auto start = std::chrono::steady_clock::now();
    const bond::LinearForces forces(bond::Beam<>({.materials = {material}}), specimen.particles,
                                    specimen.network);
    if (params_.test == Test::periodic)
      periodic(m, forces, specimen, material.youngs_modulus, shown);
    else
      symmetric(m, forces, specimen, material.youngs_modulus, shown);
    m.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    monitor_.report(
        {stage, 1, "E_a " + core::to_text(m.relative_modulus) + ", nu " + core::to_text(m.poissons_ratio)});
    table_.add(m);
    return m;
  }

private:
  static constexpr StaticSolver solver{.relative_residual = 1e-6};

  static std::string name(const Kind& kind, std::uint64_t seed) {
    return "CoV " + core::to_text(kind.cov) + ", seed " + std::to_string(seed);
  }
  void periodic(Measurement& m, const bond::LinearForces& forces, const simulation::Specimen& specimen,
                double unit, const core::Monitor& monitor) {
    const auto found = homogenize::periodic_stiffness(forces, specimen.box, solver, pool_, monitor);
    const auto extremes = found.stiffness.youngs_modulus_extremes();
    m.relative_modulus = found.stiffness.youngs_modulus() / unit;
    m.poissons_ratio = found.stiffness.poissons_ratio();
    m.affine_modulus = found.affine.youngs_modulus() / unit;
    m.affine_poissons = found.affine.poissons_ratio();
    m.distance = found.stiffness.distance_from_isotropy();
    m.anisotropy = found.stiffness.universal_anisotropy();
    m.smallest = extremes.smallest / unit;
    m.largest = extremes.largest / unit;
    m.asymmetry = found.stiffness.asymmetry();
    for (const auto& report : found.reports)
      m.iterations += report.iterations;
  }

  /// Mean of the three axes.
  void symmetric(Measurement& m, const bond::LinearForces& forces, const simulation::Specimen& specimen,
                 double unit, const core::Monitor& monitor) {
    m.affine_modulus = m.affine_poissons = m.distance = m.anisotropy = m.smallest = m.largest = m.asymmetry =
        std::numeric_limits<double>::quiet_NaN();
    for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
      const auto moduli =
          homogenize::StaticTension{.axis = axis}.measure(solver, forces, specimen, pool_, monitor).faces;
      m.relative_modulus += moduli.youngs_modulus() / unit / 3;
      m.poissons_ratio += moduli.poissons_ratio() / 3;
    }
  }

  const simulation::Specimen& body(const Kind& kind, std::uint64_t seed) {
    const std::string identity = packing_identity<Generator>(params_.packing(kind, seed), params_.source);
    if (identity == held_)
      return specimen_;
    const core::Monitor shown([&](const core::Progress& progress) {
      monitor_.report({name(kind, seed) + ", packing", progress.fraction, progress.detail});
    });
    const auto judge =
        [&](const Generator::Report& report) { // small ones jam a little earlier, each at its own
          if (report.density < 0.99 * params_.density)
            report.require_reached();
        };
    const auto packing =
        obtain_packing<Generator>(params_.packing(kind, seed), params_.source, judge, shown, &pool_).packing;
    specimen_ =
        params_.test == Test::periodic
            ? simulation::make_periodic_specimen(packing.particles, packing.box, params_.study.coordination,
                                                 pool_)
            : simulation::make_specimen(packing.particles, packing.box, params_.study.coordination, pool_);
    held_ = identity;
    return specimen_;
  }

  const Params& params_;
  core::ThreadPool& pool_;
  const core::Monitor& monitor_;
  Table table_;
  std::string held_;
  simulation::Specimen specimen_;
};

inline homogenize::CalibrationChart blank_chart(const Params& params, const KindResult& kind) {
  homogenize::CalibrationChart chart;
  chart.coordination = params.study.coordination;
  chart.micro_poissons_ratio = params.study.micro_poissons_ratio;
  chart.particles = kind.particles;
  chart.name = kind.given
                   ? params.source.file.filename().string()
                   : "Lubachevsky-Stillinger, density " + core::to_text(params.density) + ", CoV " +
                         core::to_text(kind.kind.cov) + ", growth " + core::to_text(kind.kind.growth_rate);
  chart.name += ", Z " + core::to_text(params.study.coordination) +
                (params.test == Test::periodic ? ", periodic" : ", symmetric tension of cut cubes");
  chart.ecd = packing_identity<Generator>(params.packing(kind.kind, params.seed), params.source) +
              "packings = " + std::to_string(params.packings) + "\n";
  return chart;
}

inline void invert_and_verify(const Params& params, KindResult& kind, Bench& bench) {
  for (std::size_t k = 0; k < materials().size(); ++k)
    try {
      kind.calibrated[k] = homogenize::calibrate(materials()[k].macro, kind.fit.chart);
    } catch (const core::InvalidInput& error) {
      kind.out_of_reach[k] = error.what();
    }
  if (kind.given)
    return;
  for (std::size_t k = 0; k < materials().size(); ++k)
    if (kind.calibrated[k])
      kind.verified[k] =
          bench.measure(kind.kind, params.seed + params.packings, kind.calibrated[k]->material());
}

} // namespace detail

/// Measures packing by packing, fits, inverts, verifies. What the table holds is not measured again.
inline Result run(const Params& params, const core::Monitor& monitor = {}) {
  params.validate();
  core::ThreadPool pool(params.threads);
  detail::Bench bench(params, pool, monitor);
  Result result;
  const bool given = !params.source.file.empty();
  for (const Kind& kind : given ? std::vector<Kind>{{}} : params.kinds) {
    KindResult one;
    one.kind = kind;
    one.given = given;
    one.particles = given ? bench.given_particles() : params.particles;
    const double nu = params.study.micro_poissons_ratio;
    for (std::uint64_t p = 0; p < (given ? 1 : params.packings); ++p) {
      for (const double r : params.study.radius_ratios)
        one.points.push_back(bench.measure(kind, params.seed + p, {1, r, nu}));
      if (p > 0)
        continue;
      for (const double r : params.micro_at)
        for (const double other : params.micro_ratios)
          one.micro.push_back(bench.measure(kind, params.seed, {1, r, other}));
      for (const double unit : {2e9, 1e12}) // the range of [L17] figure 7
        one.other_unit.push_back(bench.measure(kind, params.seed, {unit, params.micro_at[0], nu}));
    }
    std::vector<homogenize::CalibrationPoint> points;
    for (const Measurement& m : one.points)
      points.push_back({m.seed, m.radius_ratio, m.relative_modulus, m.poissons_ratio});
    one.fit = homogenize::fit_chart(points, detail::blank_chart(params, one));
    detail::invert_and_verify(params, one, bench);
    result.kinds.push_back(std::move(one));
  }
  return result;
}

} // namespace cdem::examples::calibration
