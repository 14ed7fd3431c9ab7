#pragma once

/// @file
/// Random packings by the Lubachevsky–Stillinger algorithm: hard spheres that move, collide and grow.

#include <cdem/core/error.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/core/random.hpp>
#include <cdem/packing/detail/contact_survey.hpp>
#include <cdem/packing/detail/growing_spheres.hpp>
#include <cdem/packing/detail/random_start.hpp>
#include <cdem/packing/packing_generator.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace cdem::packing {

/// Why the growth of a packing ended.
enum class StopReason : std::uint8_t {
  density_reached, ///< the density asked for
  pressure_limit,  ///< jammed before
  stalled ///< time stood still in spite of all efforts: a rounding problem, never seen at the default limit
};

/// "density reached", "pressure limit" or "stalled".
constexpr std::string_view to_string(StopReason reason) {
  switch (reason) {
  case StopReason::density_reached:
    return "density reached";
  case StopReason::pressure_limit:
    return "pressure limit";
  case StopReason::stalled:
    break;
  }
  return "stalled";
}

/// Event-driven packing of hard spheres whose radii grow in proportion (Lubachevsky and Stillinger 1990; polydisperse:
/// Kansal, Torquato and Stillinger 2002), the packing of [L17] section 2.1.
///
/// Spheres of equal mass start at random in a loose arrangement with Maxwellian velocities, fly straight, and collide
/// elastically while every radius grows at a rate in proportion to itself, so that the distribution keeps its shape.
/// Collisions are found exactly and handled in the order of time. Growth adds energy; the velocities are scaled back
/// to the same temperature every few collisions. It ends at the very moment the density is reached, or jammed.
/// @complexity  O(1) per collision; about 300 bytes a sphere. Slow growth needs collisions as 1/growth_rate.
class LubachevskyStillinger {
public:
  struct Parameters {
    std::uint32_t particles = 10000; ///< number of spheres, 1 to 1e8
    double density = 0.64;           ///< wanted: volume of the spheres over that of the cube, walls included
    /// Standard deviation over mean of the normal law of the radii, 0 to 0.5. The cuts below make the
    /// sample's lower: 0.296 for 0.3 cut at 3 standard deviations.
    double cov = 0.3;
    double truncation = 3; ///< radii further from the mean than this many standard deviations are drawn again
    double smallest_radius = 0.1; ///< so are radii below this part of the mean; if this cuts, the mean rises
    double growth_rate =
        0.03; ///< rate of the mean diameter over the thermal speed sqrt(kT/m): slower is denser
    double fluid_growth_rate =
        0.3; ///< the same at densities below 0.5, where spheres mix fast; raised to growth_rate
    /// Ends the run when PV/NkT is above. At 1e8 the density is within 3e-8 of that of the jammed packing, so that a
    /// higher limit gains nothing; at most 1e12, where gaps are as small as rounding errors.
    double pressure_limit = 1e8;
    double side = 0.01; ///< edge of the cube, m
    Boundary boundary = Boundary::periodic;
    std::uint64_t seed = 1; ///< the same seed gives the same bytes
  };

  struct Report {
    StopReason reason = StopReason::stalled;
    double wanted_density = 0;
    double density = 0; ///< spheres' volume over the cube's
    /// Reduced pressure PV/NkT of the last collisions (at least one a sphere), from the virial with its kinetic part.
    double pressure = 0;
    std::uint64_t collisions = 0;       ///< of two spheres, or of one with a wall
    double collisions_per_particle = 0; ///< collisions / particles
    std::uint64_t events = 0;           ///< collisions, renewals of neighbour lists and second looks
    double events_per_second = 0;       ///< events / wall_seconds
    double wall_seconds = 0;            ///< all of pack()
    /// Largest overlap over the sum of the two radii (at a wall: over the radius), found by a search over the result.
    double largest_overlap = 0;
    double contact_tolerance =
        0; ///< gaps below this part of the sum of the radii are contacts: 100/pressure, at most 0.01
    std::uint32_t rattlers = 0; ///< spheres with fewer than four contacts, taken out again and again
    double contact_number = 0;  ///< mean number of contacts of the others; 6 when jammed
    double mean_radius = 0;     ///< of the sample, m
    double cov = 0;             ///< of the sample's radii

    /// Whether the wanted density was reached.
    bool reached() const noexcept { return reason == StopReason::density_reached; }

    /// @throws core::NotReached  if the wanted density was not reached; names it, the density reached and the pressure
    void require_reached() const {
      if (!reached())
        throw core::NotReached("density " + core::to_text(wanted_density) +
                               " was not reached: " + std::string(to_string(reason)) + " at density " +
                               core::to_text(density) + ", reduced pressure " + core::to_text(pressure) +
                               "; a lower density or a smaller growth rate is needed");
    }
  };

  /// Checks the parameters and draws the radii.
  /// @throws core::InvalidInput  if a parameter is out of its range, the density is beyond the densest packing
  ///         (equal spheres: pi/sqrt(18)), or the spheres would be too large for the box: periodic images may not
  ///         see each other, so the largest diameter must stay below 0.45 of the side (walls: below the side)
  explicit LubachevskyStillinger(const Parameters& parameters);

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Packs the spheres. Their order has nothing to do with their radii.
  ///
  /// The monitor hears of stage "packing" about four times a second, and once at the end.
  /// @return             report.reached() says whether the density is the one asked for; report.require_reached()
  ///                     throws if it is not
  /// @throws core::Interrupted  when the monitor asks to stop
  Packing<Report> pack(const core::Monitor& monitor = core::Monitor()) const;

private:
  using Clock = std::chrono::steady_clock;

  static constexpr double start_density = 0.2; // random addition is still quick
  static constexpr double fluid_density = 0.5; // just above the freezing point of equal spheres, 0.494
  static constexpr double densest_of_equal = std::numbers::pi / (3 * std::numbers::sqrt2);

  static void validate(const Parameters& parameters);
  void draw_sizes();
  double density_at(double scale) const { return size_volume_ * scale * scale * scale; }
  double scale_at(double density) const { return std::cbrt(density / size_volume_); }
  double growth_at(double density) const;
  double skin_at(double scale, double pressure) const;
  detail::GrowingSpheres start_loose() const;
  void grow(detail::GrowingSpheres& spheres, Report& report, const core::Monitor& monitor) const;
  Packing<Report> result(const detail::GrowingSpheres& spheres) const;
  static void complete(Report& report, const particles::ParticleSet& spheres, const geometry::Box& box);

  Parameters parameters_;
  core::Random random_; ///< as it is once the sizes are drawn
  bool periodic_;
  std::vector<double> sizes_; ///< [spheres] radii at a mean diameter of 1
  double size_volume_ = 0;    ///< of the spheres at a mean diameter of 1
  double largest_size_ = 0;
};

inline LubachevskyStillinger::LubachevskyStillinger(const Parameters& parameters)
    : parameters_(parameters), random_(parameters.seed),
      periodic_(parameters.boundary == Boundary::periodic) {
  validate(parameters_);
  draw_sizes();
}

inline void LubachevskyStillinger::validate(const Parameters& p) {
  core::expect(p.particles >= 1 && p.particles <= 100000000, "number of particles", p.particles,
               "1 to 100000000 is expected");
  core::expect(p.cov >= 0 && p.cov <= 0.5, "CoV of the radii", p.cov, "0 to 0.5 is expected");
  core::expect(p.truncation >= 1 && p.truncation <= 6, "truncation", p.truncation,
               "1 to 6 standard deviations is expected");
  core::expect(p.smallest_radius >= 0.01 && p.smallest_radius <= 0.9, "smallest radius over the mean",
               p.smallest_radius, "0.01 to 0.9 is expected");
  if (p.cov == 0)
    core::expect(p.density > 0 && p.density < densest_of_equal, "density", p.density,
                 "above 0 and below pi/sqrt(18) = 0.7405, the densest packing of equal spheres, is expected");
  else
    core::expect(p.density > 0 && p.density < 1, "density", p.density, "above 0 and below 1 is expected");
  core::expect(p.growth_rate >= 1e-6 && p.growth_rate <= 1, "growth rate", p.growth_rate,
               "1e-6 to 1 thermal speed is expected");
  core::expect(p.fluid_growth_rate >= 1e-6 && p.fluid_growth_rate <= 1, "growth rate of the fluid",
               p.fluid_growth_rate, "1e-6 to 1 thermal speed is expected");
  core::expect(p.pressure_limit >= 100 && p.pressure_limit <= 1e12, "pressure limit", p.pressure_limit,
               "a reduced pressure of 100 to 1e12 is expected");
  core::expect_positive(p.side, "side of the cube", "m");
  core::expect(p.boundary == Boundary::periodic || p.boundary == Boundary::walls, "boundary",
               static_cast<int>(p.boundary), "periodic or walls is expected");
}

inline void LubachevskyStillinger::draw_sizes() {
  const double half_width = parameters_.truncation * parameters_.cov;
  sizes_ = detail::truncated_normal(parameters_.particles, parameters_.cov,
                                    std::max(1 - half_width, parameters_.smallest_radius), 1 + half_width,
                                    random_);
  const double mean = std::accumulate(sizes_.begin(), sizes_.end(), 0.0) / static_cast<double>(sizes_.size());
  for (double& size : sizes_)
    size /= 2 * mean;
  size_volume_ = detail::volume_of_spheres(sizes_);
  largest_size_ = *std::max_element(sizes_.begin(), sizes_.end());

  const double diameter = 2 * largest_size_ * scale_at(parameters_.density);
  const double limit = periodic_ ? 0.45 : 1;
  core::expect(diameter < limit, "number of particles", parameters_.particles,
               "more are expected: the largest sphere's diameter would be " + core::to_text(diameter) +
                   " of the side, and below " + core::to_text(limit) + " is needed");
}

inline Packing<LubachevskyStillinger::Report>
LubachevskyStillinger::pack(const core::Monitor& monitor) const {
  const auto start = Clock::now();
  Report report;
  detail::GrowingSpheres spheres = start_loose();
  grow(spheres, report, monitor);
  Packing<Report> packing = result(spheres);
  complete(report, packing.particles, packing.box);
  report.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  report.events_per_second = static_cast<double>(report.events) / report.wall_seconds;
  packing.report = report;
  return packing;
}

/// Random places and Maxwellian velocities; a periodic system is at rest as a whole.
inline detail::GrowingSpheres LubachevskyStillinger::start_loose() const {
  core::Random random = random_;
  std::vector<Vec3> centres;
  double scale = 0;
  for (double density = std::min(start_density, parameters_.density / 2); centres.empty(); density /= 2) {
    scale = scale_at(density);
    std::vector<double> radii = sizes_;
    for (double& radius : radii)
      radius *= scale;
    centres = detail::add_sequentially(radii, periodic_, random);
  }
  std::vector<Vec3> velocities(sizes_.size());
  Vec3 drift = Vec3::Zero();
  for (Vec3& velocity : velocities) {
    for (int k = 0; k < 3; ++k)
      velocity[k] = random.normal();
    drift += velocity / static_cast<double>(sizes_.size());
  }
  if (periodic_)
    for (Vec3& velocity : velocities)
      velocity -= drift;
  return {centres, sizes_, velocities, scale, periodic_};
}

/// Rate of the mean diameter over the thermal speed.
inline double LubachevskyStillinger::growth_at(double density) const {
  return density < fluid_density ? std::max(parameters_.fluid_growth_rate, parameters_.growth_rate)
                                 : parameters_.growth_rate;
}

/// Room that a sphere gets to move in before its list of neighbours is renewed: about its free path, which falls as
/// the inverse of the pressure. Any value gives the same motion; this one is quick.
inline double LubachevskyStillinger::skin_at(double scale, double pressure) const {
  const double skin = scale * std::clamp(4 / pressure, 0.03, 0.3);
  // Shells may not meet a periodic image of what they meet already.
  return periodic_ ? std::min(skin, 0.25 - largest_size_ * scale_at(parameters_.density)) : skin;
}

inline void LubachevskyStillinger::grow(detail::GrowingSpheres& spheres, Report& report,
                                        const core::Monitor& monitor) const {
  constexpr std::uint64_t slice = 16384; // events between two looks at the clock
  const auto count = static_cast<double>(spheres.size());
  const double first_density = density_at(spheres.scale());
  const double final_scale = scale_at(parameters_.density);

  double pressure = 1;
  detail::CollisionSums last;
  detail::StallWatch watch;
  double interval = 0.02 * spheres.scale() / count;
  auto reported = Clock::now();
  const auto report_progress = [&] {
    const double density = density_at(spheres.scale());
    monitor.report({"packing",
                    std::clamp((density - first_density) / (parameters_.density - first_density), 0.0, 1.0),
                    "density " + core::to_text(density) + ", reduced pressure " + core::to_text(pressure)});
    reported = Clock::now();
  };
  const auto stop = [&](StopReason reason, double final_pressure) {
    report.reason = reason;
    report.pressure = pressure = final_pressure;
    report_progress();
  };

  report.wanted_density = parameters_.density;
  for (;;) {
    // A cycle is short enough for the growth not to heat the spheres by much before they are cooled again.
    const double growth = growth_at(density_at(spheres.scale()));
    const auto events =
        static_cast<std::uint64_t>(std::max(std::clamp(0.2 / growth, 1.0, 10.0) * count, 1000.0));
    spheres.begin_cycle(growth, skin_at(spheres.scale(), pressure), interval);
    bool reached = false;
    for (std::uint64_t done = 0; done < events && !reached; done += slice) {
      reached = spheres.run(std::min(slice, events - done), final_scale);
      if (monitor.stop_requested() || Clock::now() - reported > std::chrono::milliseconds(250))
        report_progress();
    }
    spheres.synchronise();
    const detail::CollisionSums sums = spheres.sums();
    report.events += sums.events;
    report.collisions += sums.collisions;
    if (reached)
      return stop(StopReason::density_reached,
                  (sums.collisions < spheres.size() ? last + sums : sums).reduced_pressure());

    switch (watch.judge(sums.duration)) {
    case detail::StallWatch::Verdict::stalled:
      return stop(StopReason::stalled, pressure);
    case detail::StallWatch::Verdict::hesitates:
      spheres.shrink(1e-13);
      continue;
    case detail::StallWatch::Verdict::advances:
      break;
    }
    last = sums;
    interval = sums.duration / static_cast<double>(sums.events);
    pressure = sums.reduced_pressure();
    if (pressure > parameters_.pressure_limit)
      return stop(StopReason::pressure_limit, pressure);
  }
}

inline Packing<LubachevskyStillinger::Report>
LubachevskyStillinger::result(const detail::GrowingSpheres& spheres) const {
  Packing<Report> packing;
  packing.box = geometry::Box::cube(parameters_.side, periodic_);
  packing.particles.resize(spheres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    packing.particles.position[i] = packing.box.wrap(spheres.centre(i) * parameters_.side);
    packing.particles.radius[i] = spheres.radius(i) * parameters_.side;
  }
  return packing;
}

/// What the report says of the finished packing.
inline void LubachevskyStillinger::complete(Report& report, const particles::ParticleSet& spheres,
                                            const geometry::Box& box) {
  const auto count = static_cast<double>(spheres.size());
  report.density = spheres.solid_volume() / box.volume();
  report.contact_tolerance = std::min(100 / report.pressure, 0.01);
  const detail::ContactSurvey survey = detail::survey_contacts(spheres, box, report.contact_tolerance);
  report.largest_overlap = survey.largest_overlap;
  report.rattlers = survey.rattlers;
  report.contact_number = survey.contact_number;
  report.mean_radius = spheres.mean_radius();
  double variance = 0;
  for (const double radius : spheres.radius)
    variance += std::pow(radius / report.mean_radius - 1, 2) / count;
  report.cov = std::sqrt(variance);
  report.collisions_per_particle = static_cast<double>(report.collisions) / count;
}

static_assert(PackingGenerator<LubachevskyStillinger>);

} // namespace cdem::packing
