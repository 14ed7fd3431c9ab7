#pragma once

// How many particles make a representative volume: [L17] section 2.3, figure 6.

#include <cdem/bond/beam.hpp>
#include <cdem/homogenize/sample_statistics.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/simulation/specimen.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/measures.hpp"
#include "common/packings.hpp"
#include "common/paper_materials.hpp"

namespace cdem::examples::rve_size {

struct Params {
  std::vector<std::uint32_t> sizes = {10000,  30000,  100000,
                                      300000, 700000, 2000000}; ///< numbers of particles
  int packings = 15;                                            ///< of each size, [L17] section 2.3
  int packings_large = 5;                                       ///< of each size above 700,000
  int packings_periodic = 3;    ///< of each size on which the whole periodic stiffness is measured too
  std::uint32_t large = 700000; ///< largest size that gets all packings
  packing::LubachevskyStillinger::Parameters packing = {}; ///< particles and seed are set one by one
  PackingSource source = {};                               ///< a packing given stands for all
  double coordination = 6.2;                               ///< Z, [L17] section 2.1
  Axis axis = Axis::x;                                     ///< of the tension
  int threads = 0;

  int count(std::uint32_t size) const {
    if (!source.file.empty())
      return 1;
    return size <= large ? packings : std::min(packings, packings_large);
  }
  packing::LubachevskyStillinger::Parameters packing_of(std::uint32_t size, int number) const {
    auto one = packing;
    one.particles = size;
    one.seed = packing.seed + static_cast<std::uint64_t>(number);
    return one;
  }

  /// @throws core::InvalidInput for what no stage would accept, before anything is computed or written
  void validate() const {
    core::expect(!sizes.empty(), "number of sizes", sizes.size(), "1 or more is expected");
    core::expect(packings >= 1, "packings", packings, "1 or more is expected");
    core::expect(packings_large >= 1, "packings of large sizes", packings_large, "1 or more is expected");
    core::expect(packings_periodic >= 0, "packings of the periodic test", packings_periodic,
                 "0 or more is expected");
    core::expect_positive(coordination, "coordination");
    for (const std::uint32_t size : sizes)
      packing::LubachevskyStillinger{packing_of(size, 0)};
  }
};

/// What one material gave on one packing.
struct Sample {
  std::uint32_t particles = 0;
  std::uint64_t seed = 0;
  std::string material;
  MeasuredModuli moduli;
  double anisotropy = std::numeric_limits<double>::quiet_NaN(); ///< universal index of the periodic stiffness
  double density = 0;
  double pressure = std::numeric_limits<double>::quiet_NaN(); ///< reduced, of the packing; NaN for a file
  double eps = 0;                                             ///< of eq. 1, cut cube
  double eps_periodic = std::numeric_limits<double>::quiet_NaN();
  double solve_seconds = 0; ///< wall clock of the tension test
};

/// Every sample, and what they say of each size.
struct Result {
  std::vector<Sample> samples; ///< by size, seed, material

  std::vector<std::uint32_t> sizes() const {
    std::vector<std::uint32_t> found;
    for (const Sample& sample : samples)
      found.push_back(sample.particles);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Statistics of one quantity over the packings of a size.
  homogenize::SampleStatistics statistics(std::uint32_t size, const std::string& material,
                                          const std::function<double(const Sample&)>& quantity) const {
    std::vector<double> values;
    for (const Sample& sample : samples)
      if (sample.particles == size && sample.material == material)
        values.push_back(quantity(sample));
    return homogenize::sample_statistics(values);
  }
  homogenize::SampleStatistics youngs_modulus(std::uint32_t size, const std::string& material,
                                              Measure measure) const {
    return statistics(size, material,
                      [measure](const Sample& sample) { return sample.moduli[measure].youngs_modulus; });
  }
  homogenize::SampleStatistics poissons_ratio(std::uint32_t size, const std::string& material,
                                              Measure measure) const {
    return statistics(size, material,
                      [measure](const Sample& sample) { return sample.moduli[measure].poissons_ratio; });
  }

  /// The body without faces: E against N^(-1/3), the part of the particles that lie at the faces, followed to 0.
  /// @return  the line, if there are two sizes or more of two packings or more
  std::optional<homogenize::Line> limit(const std::string& material, Measure measure) const {
    std::vector<double> x, y, error;
    for (const std::uint32_t size : sizes())
      if (const auto sample = youngs_modulus(size, material, measure);
          sample.count >= 2 && sample.standard_error() > 0) {
        x.push_back(std::cbrt(1.0 / size));
        y.push_back(sample.mean);
        error.push_back(sample.standard_error());
      }
    if (x.size() < 2)
      return std::nullopt;
    return homogenize::fit_line(x, y, error);
  }
};

/// Where samples of an earlier run come from, and where each new one goes at once.
struct Ledger {
  std::vector<Sample> kept = {};                             ///< measured before
  std::function<void(const std::vector<Sample>&)> keep = {}; ///< called after every packing with all so far
};

namespace detail {

inline void judge(const packing::LubachevskyStillinger::Report& report) {
  // One that jams up to a tenth below the density asked for is of use all the same.
  if (!(report.reason == packing::StopReason::pressure_limit &&
        report.density >= 0.9 * report.wanted_density))
    report.require_reached();
}

/// What packing a particle costs; measuring it by two tension tests is the unit, by both tests 7.
inline constexpr double packing_cost = 8;

/// How far a run is; what is shown never goes back.
class Account {
public:
  explicit Account(const core::Monitor& monitor) : monitor_(monitor) {}

  double total = 0; ///< of all that is to be done
  double done = 0;

  void report(const std::string& stage, const std::string& detail) {
    shown_ = std::max(shown_, total > 0 ? std::min(1.0, done / total) : 0);
    monitor_.report({stage, shown_, detail});
  }
  /// For a part that costs so much, as it goes from 0 to 1.
  core::Monitor part(const std::string& stage, double cost) {
    return core::Monitor([this, stage, cost](const core::Progress& progress) {
      shown_ = std::max(shown_, total > 0 ? std::min(1.0, (done + cost * progress.fraction) / total) : 0);
      monitor_.report({stage, shown_, progress.detail});
    });
  }

private:
  const core::Monitor& monitor_;
  double shown_ = 0;
};

/// The samples of one packing, one a material.
inline std::vector<Sample> measure(const Params& params,
                                   const ObtainedPacking<packing::LubachevskyStillinger>& made,
                                   std::uint64_t seed, bool periodic, core::ThreadPool& pool,
                                   const core::Monitor& monitor) {
  const auto& packing = made.packing;
  const simulation::Specimen body =
      simulation::make_specimen(packing.particles, packing.box, params.coordination, pool);
  const StaticSolver solver;
  const double solutions = periodic ? 14 : 2;
  double solved = 0;
  const auto shown = [&](double count) { // as many solutions, told by the first of them
    const double before = std::exchange(solved, solved + count);
    return core::Monitor([&, before, count](const core::Progress& progress) {
      monitor.report({progress.stage, (before + count * progress.fraction) / solutions, progress.detail});
    });
  };
  std::vector<Sample> samples;
  for (const PaperMaterial& material : {alumina(), silica()}) {
    const bond::Beam<> law({.materials = {material.micro}});
    Sample sample;
    sample.particles = static_cast<std::uint32_t>(packing.particles.size());
    sample.seed = seed;
    sample.material = material.name;
    sample.density = body.density();
    if (made.reported)
      sample.pressure = packing.report.pressure;
    sample.eps = body.eps;
    const auto start = std::chrono::steady_clock::now();
    measure_tension(sample.moduli, law, body, params.axis, solver, pool, shown(1));
    sample.solve_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (periodic) {
      const simulation::Specimen cell =
          simulation::make_periodic_specimen(packing.particles, packing.box, params.coordination, pool);
      sample.anisotropy = measure_periodic(sample.moduli, law, cell, pool, shown(6)).universal_anisotropy();
      sample.eps_periodic = cell.eps;
    }
    samples.push_back(std::move(sample));
  }
  return samples;
}

} // namespace detail

/// Packs, or loads, and measures what the ledger lacks.
///
/// Packings are made several at a time, one thread each, and measured one after another by all threads.
inline Result run(const Params& params, Ledger ledger = {}, const core::Monitor& monitor = {}) {
  params.validate();
  core::ThreadPool pool(params.threads);
  Result result{std::move(ledger.kept)};
  const auto find = [&](std::uint32_t size, std::uint64_t seed) {
    return std::find_if(result.samples.begin(), result.samples.end(), [&](const Sample& sample) {
      return sample.particles == size && sample.seed == seed;
    });
  };
  const auto lacks = [&](std::uint32_t size, int number) {
    const auto found = find(size, params.packing_of(size, number).seed);
    return found == result.samples.end() ||
           (number < params.packings_periodic && !found->moduli.has(Measure::periodic));
  };
  const bool given = !params.source.file.empty();
  detail::Account account(monitor);
  const auto must_pack = [&](const auto& packing) {
    std::error_code ignored;
    return !given && (params.source.cache.empty() ||
                      !std::filesystem::exists(
                          cached_packing<packing::LubachevskyStillinger>(packing, params.source), ignored));
  };
  const auto cost_of_packing = [&](const auto& packing) {
    return must_pack(packing) ? detail::packing_cost * packing.particles : 0;
  };
  const auto cost_of_measuring = [&](std::uint32_t size, int number) {
    return static_cast<double>(size) * (number < params.packings_periodic ? 7 : 1);
  };
  for (const std::uint32_t size : params.sizes)
    for (int number = 0; number < params.count(size); ++number)
      if (lacks(size, number))
        account.total += cost_of_packing(params.packing_of(size, number)) + cost_of_measuring(size, number);

  for (const std::uint32_t size : params.sizes) {
    const std::string stage = std::to_string(size) + " particles";
    for (int first = 0; first < params.count(size); first += pool.size()) {
      std::vector<packing::LubachevskyStillinger::Parameters> batch;
      std::vector<int> numbers;
      double packing = 0;
      for (int number = first; number < std::min(first + pool.size(), params.count(size)); ++number)
        if (lacks(size, number)) {
          batch.push_back(params.packing_of(size, number));
          numbers.push_back(number);
          packing += cost_of_packing(batch.back());
        }
      make_packings_ahead<packing::LubachevskyStillinger>(batch, params.source, detail::judge,
                                                          account.part(stage, packing), pool);
      for (std::size_t k = 0; k < batch.size(); ++k) {
        const auto made = obtain_packing<packing::LubachevskyStillinger>(
            batch[k], params.source, detail::judge, account.part(stage, packing), &pool);
        if (k + 1 == batch.size())
          account.done += packing;
        const double cost = cost_of_measuring(size, numbers[k]);
        const auto samples =
            detail::measure(params, made, batch[k].seed,
                            made.packing.box.periodic[0] && numbers[k] < params.packings_periodic, pool,
                            account.part(stage, cost));
        account.done += cost;
        std::erase_if(result.samples, [&](const Sample& sample) {
          return !given && sample.particles == size && sample.seed == batch[k].seed;
        });
        result.samples.insert(result.samples.end(), samples.begin(), samples.end());
        std::stable_sort(result.samples.begin(), result.samples.end(), [](const Sample& a, const Sample& b) {
          return std::pair(a.particles, a.seed) < std::pair(b.particles, b.seed);
        });
        if (ledger.keep)
          ledger.keep(result.samples);
        account.report(
            stage, "seed " + std::to_string(batch[k].seed) + ", E " +
                       core::to_text(1e-9 * samples.front().moduli[Measure::faces].youngs_modulus) + " GPa");
      }
    }
  }
  return result;
}

} // namespace cdem::examples::rve_size
