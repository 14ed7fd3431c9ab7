#pragma once

// How even a packing's bonds are, and how far apart bonded spheres are, against the number of particles:
// [L17] section 2.1, figures 1 and 2.

#include <cdem/packing/quality.hpp>
#include <cdem/simulation/specimen.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "common/packings.hpp"

namespace cdem::examples::ecd_isotropy {

/// Who makes the packings; one line here and one in pack() for each.
enum class GeneratorKind : std::uint8_t { lubachevsky_stillinger, soft_spheres };

struct Params {
  std::vector<std::uint32_t> sizes = {10000, 20000, 50000, 100000}; ///< numbers of particles
  std::vector<double> covs = {0, 0.03, 0.1, 0.3};                   ///< CoV of the Gaussian radii; paper: 0.3
  GeneratorKind generator = GeneratorKind::lubachevsky_stillinger;
  double density = 0.64;       ///< [L17] section 2.1
  double growth_rate = 0.02;   ///< of LubachevskyStillinger: the fastest at which equal spheres reach 0.64
  double pressure_limit = 1e6; ///< of LubachevskyStillinger
  double coordination = 6.2;   ///< Z, [L17] section 2.1
  std::uint64_t seed = 1;
  int threads = 0;
  PackingSource source = {}; ///< a packing given stands for all sizes and CoV

  packing::LubachevskyStillinger::Parameters lubachevsky_stillinger(double cov,
                                                                    std::uint32_t particles) const {
    return {.particles = particles,
            .density = density,
            .cov = cov,
            .growth_rate = growth_rate,
            .pressure_limit = pressure_limit,
            .seed = seed};
  }

  packing::SoftSpheres::Parameters soft_spheres(double cov, std::uint32_t particles) const {
    packing::SoftSpheres::Parameters p;
    p.particles = particles;
    p.density = density;
    p.cov = cov;
    p.seed = seed;
    p.threads = threads;
    return p;
  }

  /// @throws core::InvalidInput for what no stage would accept, before anything is computed or written
  void validate() const {
    core::expect(!sizes.empty(), "number of sizes", sizes.size(), "1 or more is expected");
    core::expect(!covs.empty(), "number of CoVs", covs.size(), "1 or more is expected");
    core::expect_positive(coordination, "coordination");
    for (const double cov : covs)
      for (const std::uint32_t particles : sizes)
        if (generator == GeneratorKind::soft_spheres)
          packing::SoftSpheres{soft_spheres(cov, particles)};
        else
          packing::LubachevskyStillinger{lubachevsky_stillinger(cov, particles)};
  }
};

/// One packing and what was found.
struct Case {
  double cov = 0; ///< asked for; of the sample for a packing given
  std::uint32_t particles = 0;
  packing::Quality quality;   ///< of the periodic packing
  double eps_cut = 0;         ///< eps of the cube cut out of it, whose faces bond to nothing
  bool jammed_before = false; ///< below the density asked for
  double pack_seconds = 0;    ///< when it was made; 0 for a packing given
  bool loaded = false;        ///< from the cache or the file given

  /// Root mean square of E_k over the three planes.
  double anisotropy() const {
    double sum = 0;
    for (const double deviation : quality.anisotropy.deviation)
      sum += deviation * deviation / 3;
    return std::sqrt(sum);
  }
  std::string condition() const {
    return "cov=" + core::to_text(cov) + ",particles=" + std::to_string(particles);
  }
};

struct Result {
  std::vector<Case> cases; ///< CoV by CoV, sizes in the order given

  /// The case of a CoV with the most particles.
  const Case& largest(double cov) const {
    const Case* found = nullptr;
    for (const Case& one : cases)
      if (one.cov == cov && (!found || one.particles > found->particles))
        found = &one;
    core::expect(found != nullptr, "CoV", cov, "one of the run is expected");
    return *found;
  }
};

namespace detail {

/// A packing without its generator's type.
struct Made {
  particles::ParticleSet particles;
  geometry::Box box;
  std::optional<double> pressure;
  bool reached = true, loaded = false;
  double seconds = 0;
};

template <class Generator>
Made made_by(const typename Generator::Parameters& parameters, const Params& params, core::ThreadPool& pool,
             const core::Monitor& monitor) {
  // One that jams up to a tenth below the density asked for is of use all the same.
  const auto judge = [&](const typename Generator::Report& report) {
    if (report.density < 0.9 * params.density)
      report.require_reached();
  };
  auto [packing, loaded, reported] =
      obtain_packing<Generator>(parameters, params.source, judge, monitor, &pool);
  Made made{std::move(packing.particles), packing.box, {}, true, loaded, packing.report.wall_seconds};
  if (reported) {
    if constexpr (std::is_same_v<Generator, packing::LubachevskyStillinger>)
      made.pressure = packing.report.pressure; // the reduced one, of hard spheres
    made.reached = packing.report.reached();
  }
  return made;
}

inline Made pack(double cov, std::uint32_t particles, const Params& params, core::ThreadPool& pool,
                 const core::Monitor& monitor) {
  switch (params.generator) {
  case GeneratorKind::soft_spheres:
    return made_by<packing::SoftSpheres>(params.soft_spheres(cov, particles), params, pool, monitor);
  case GeneratorKind::lubachevsky_stillinger:
    break;
  }
  return made_by<packing::LubachevskyStillinger>(params.lubachevsky_stillinger(cov, particles), params, pool,
                                                 monitor);
}

inline Made pack_or_say_how_to_go_on(double cov, std::uint32_t particles, const Params& params,
                                     core::ThreadPool& pool, const core::Monitor& monitor) {
  try {
    return pack(cov, particles, params, pool, monitor);
  } catch (const core::Interrupted& interrupted) {
    throw core::Interrupted(
        std::string(interrupted.what()) +
        (params.source.cache.empty() ? "" : "; the same command goes on with this packing"));
  }
}

} // namespace detail

/// Packs, or loads, each case in turn and looks at it.
inline Result run(const Params& params, const core::Monitor& monitor = {}) {
  params.validate();
  core::ThreadPool pool(params.threads);
  Result result;
  const bool given = !params.source.file.empty();
  for (const double cov : given ? std::vector{0.0} : params.covs)
    for (const std::uint32_t particles : given ? std::vector<std::uint32_t>{0} : params.sizes) {
      Case one;
      one.cov = cov;
      one.particles = particles;
      const std::string stage =
          given ? params.source.file.filename().string()
                : "CoV " + core::to_text(cov) + ", " + std::to_string(particles) + " particles";
      const core::Monitor shown([&](const core::Progress& progress) {
        monitor.report({stage, progress.fraction, progress.detail});
      });
      const detail::Made made = detail::pack_or_say_how_to_go_on(cov, particles, params, pool, shown);
      one.quality =
          packing::quality(made.particles, made.box,
                           {.coordination = params.coordination, .reduced_pressure = made.pressure}, pool);
      one.eps_cut = simulation::make_specimen(made.particles, made.box, params.coordination, pool).eps;
      if (given) {
        one.cov = one.quality.radius.cov();
        one.particles = static_cast<std::uint32_t>(made.particles.size());
      }
      one.jammed_before = !made.reached;
      one.pack_seconds = made.seconds;
      one.loaded = made.loaded;
      monitor.report(
          {stage, 1, "E_k " + core::to_text(one.anisotropy()) + ", eps " + core::to_text(one.quality.eps)});
      result.cases.push_back(std::move(one));
    }
  return result;
}

} // namespace cdem::examples::ecd_isotropy
