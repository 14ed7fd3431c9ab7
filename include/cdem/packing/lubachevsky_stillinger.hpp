#pragma once

/// @file
/// Random packings by the Lubachevsky–Stillinger algorithm: hard spheres that move, collide and grow.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
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
#include <functional>
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

/// A run in mid-course: all that the rest of it depends on. io::save_packing_state() keeps it in a file.
struct GrowthState {
  std::vector<double>
      spheres; ///< [spheres x 12] centre, time of the next event, velocity, size, shell (centre, radius)
  std::vector<ParticleIndex> partners; ///< [spheres] of the next event
  std::vector<double> numbers;         ///< of the run
  std::vector<std::uint64_t> counts;   ///< of the run
  std::string parameters;              ///< in words; a run goes on only with the same
};

/// When a run hands out its state.
struct GrowthCheckpoints {
  /// Called by the thread that runs, every `seconds` and when the monitor asks to stop.
  std::function<void(const GrowthState&)> save;
  double seconds = 600;
};

namespace detail {

/// Where the growth of a packing stands, between two cycles or within one.
struct Growth {
  double pressure = 1;          ///< of the last cycle
  CollisionSums last;           ///< of the last sound cycle
  StallWatch watch;             ///< over the cycles
  double interval = 0;          ///< between two events, expected
  double first_density = 0;     ///< at the start
  bool late = false;            ///< whether the pressure has passed late_pressure
  std::uint64_t cycle = 0;      ///< events of this cycle; 0 if the next is to begin
  std::uint64_t events = 0;     ///< of the cycles before
  std::uint64_t collisions = 0; ///< of the cycles before
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
};

} // namespace detail

/// Event-driven packing of hard spheres whose radii grow in proportion (Lubachevsky and Stillinger 1990; polydisperse:
/// Kansal, Torquato and Stillinger 2002), the packing of [L17] section 2.1.
///
/// Spheres of equal mass start at random in a loose arrangement with Maxwellian velocities, fly straight, and collide
/// elastically while every radius grows at a rate in proportion to itself, so that the distribution keeps its shape.
/// Collisions are found exactly and handled in the order of time. Growth adds energy; the velocities are scaled back
/// to the same temperature every few collisions. It ends at the very moment the density is reached, or jammed.
/// @complexity  O(1) per collision; about 350 bytes a sphere. Slow growth needs collisions as 1/growth_rate.
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
    /// The same once the reduced pressure has passed late_pressure, for good: fast through the fluid, then slow where
    /// the spheres jam, or the other way round. 0: growth_rate all along.
    double late_growth_rate = 0;
    double late_pressure = 30; ///< 5 (a fluid at density 0.35) to 1e12; equal spheres pass 30 at density 0.56
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

  using State = GrowthState;
  using Checkpoints = GrowthCheckpoints;

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

  /// The same on several threads, to the same bytes, with checkpoints. Below 100,000 spheres one thread works alone.
  /// @throws core::Interrupted  when the monitor asks to stop, after checkpoints.save
  Packing<Report> pack(core::ThreadPool& pool, const core::Monitor& monitor = core::Monitor(),
                       const Checkpoints& checkpoints = {}) const;

  /// Goes on from a state, to the bytes of the run that was never stopped.
  /// @throws core::InvalidInput  if the state is of other parameters, or incomplete
  Packing<Report> resume(const State& state, core::ThreadPool& pool,
                         const core::Monitor& monitor = core::Monitor(),
                         const Checkpoints& checkpoints = {}) const;

private:
  using Clock = std::chrono::steady_clock;

  static constexpr double start_density = 0.2;           // random addition is still quick
  static constexpr std::uint32_t worth_sharing = 100000; // fewer spheres are quicker on one thread
  static constexpr double fluid_density = 0.5; // just above the freezing point of equal spheres, 0.494
  static constexpr double densest_of_equal = std::numbers::pi / (3 * std::numbers::sqrt2);

  static void validate(const Parameters& parameters);
  void draw_sizes();
  double density_at(double scale) const { return size_volume_ * scale * scale * scale; }
  double scale_at(double density) const { return std::cbrt(density / size_volume_); }
  double growth_at(double density, bool late) const;
  double skin_at(double scale, double pressure) const;
  detail::GrowingSpheres start_loose() const;
  std::string words() const;
  State state_of(const detail::GrowingSpheres& spheres, const detail::Growth& growth) const;
  detail::GrowingSpheres spheres_of(const State& state, core::ThreadPool& pool) const;
  Packing<Report> finish(detail::GrowingSpheres& spheres, detail::Growth& growth, core::ThreadPool& pool,
                         const core::Monitor& monitor, const Checkpoints& checkpoints) const;
  StopReason grow(detail::GrowingSpheres& spheres, detail::Growth& growth, core::ThreadPool& pool,
                  const core::Monitor& monitor, const Checkpoints& checkpoints) const;
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
  detail::expect_size_law(p);
  if (p.cov == 0)
    core::expect(p.density > 0 && p.density < densest_of_equal, "density", p.density,
                 "above 0 and below pi/sqrt(18) = 0.7405, the densest packing of equal spheres, is expected");
  else
    core::expect(p.density > 0 && p.density < 1, "density", p.density, "above 0 and below 1 is expected");
  core::expect(p.growth_rate >= 1e-6 && p.growth_rate <= 1, "growth rate", p.growth_rate,
               "1e-6 to 1 thermal speed is expected");
  core::expect(p.fluid_growth_rate >= 1e-6 && p.fluid_growth_rate <= 1, "growth rate of the fluid",
               p.fluid_growth_rate, "1e-6 to 1 thermal speed is expected");
  core::expect(p.late_growth_rate == 0 || (p.late_growth_rate >= 1e-6 && p.late_growth_rate <= 1),
               "late growth rate", p.late_growth_rate, "0 or 1e-6 to 1 thermal speed is expected");
  core::expect(p.late_pressure >= 5 && p.late_pressure <= 1e12, "late pressure", p.late_pressure,
               "a reduced pressure of 5 to 1e12 is expected");
  core::expect(p.pressure_limit >= 100 && p.pressure_limit <= 1e12, "pressure limit", p.pressure_limit,
               "a reduced pressure of 100 to 1e12 is expected");
  core::expect_positive(p.side, "side of the cube", "m");
  core::expect(p.boundary == Boundary::periodic || p.boundary == Boundary::walls, "boundary",
               static_cast<int>(p.boundary), "periodic or walls is expected");
}

inline void LubachevskyStillinger::draw_sizes() {
  sizes_ = detail::draw_sizes(parameters_, random_);
  size_volume_ = detail::volume_of_spheres(sizes_);
  largest_size_ = *std::max_element(sizes_.begin(), sizes_.end());

  const double diameter = 2 * largest_size_ * scale_at(parameters_.density);
  detail::expect_room(parameters_, diameter, periodic_);
}

inline Packing<LubachevskyStillinger::Report>
LubachevskyStillinger::pack(const core::Monitor& monitor) const {
  core::ThreadPool alone;
  return pack(alone, monitor);
}

inline Packing<LubachevskyStillinger::Report>
LubachevskyStillinger::pack(core::ThreadPool& pool, const core::Monitor& monitor,
                            const Checkpoints& checkpoints) const {
  core::ThreadPool alone;
  detail::Growth growth;
  detail::GrowingSpheres spheres = start_loose();
  growth.interval = 0.02 * spheres.scale() / static_cast<double>(spheres.size());
  growth.first_density = density_at(spheres.scale());
  return finish(spheres, growth, parameters_.particles < worth_sharing ? alone : pool, monitor, checkpoints);
}

inline Packing<LubachevskyStillinger::Report>
LubachevskyStillinger::resume(const State& state, core::ThreadPool& pool, const core::Monitor& monitor,
                              const Checkpoints& checkpoints) const {
  core::ThreadPool alone;
  core::ThreadPool& team = parameters_.particles < worth_sharing ? alone : pool;
  detail::Growth growth;
  detail::GrowingSpheres spheres = spheres_of(state, team);
  const std::vector<double>& x = state.numbers;
  growth.pressure = x[10];
  growth.last = {state.counts[3], state.counts[4], x[11], x[12], x[13]};
  growth.watch = detail::StallWatch(x[14], static_cast<int>(state.counts[5]));
  growth.interval = x[15];
  growth.first_density = x[16];
  growth.late = state.counts[6] != 0;
  growth.cycle = state.counts[7];
  growth.events = state.counts[8];
  growth.collisions = state.counts[9];
  return finish(spheres, growth, team, monitor, checkpoints);
}

inline Packing<LubachevskyStillinger::Report>
LubachevskyStillinger::finish(detail::GrowingSpheres& spheres, detail::Growth& growth, core::ThreadPool& pool,
                              const core::Monitor& monitor, const Checkpoints& checkpoints) const {
  core::expect(checkpoints.seconds >= 0, "time between checkpoints", checkpoints.seconds,
               "0 s or more is expected");
  Report report;
  report.wanted_density = parameters_.density;
  report.reason = grow(spheres, growth, pool, monitor, checkpoints);
  report.pressure = growth.pressure;
  report.events = growth.events;
  report.collisions = growth.collisions;
  Packing<Report> packing = result(spheres);
  complete(report, packing.particles, packing.box);
  report.wall_seconds = std::chrono::duration<double>(Clock::now() - growth.started).count();
  report.events_per_second = static_cast<double>(report.events) / report.wall_seconds;
  packing.report = report;
  return packing;
}

/// All that the bytes of the packing depend on.
inline std::string LubachevskyStillinger::words() const {
  const Parameters& p = parameters_;
  std::string text = "particles " + core::to_text(p.particles) + ", seed " + core::to_text(p.seed) +
                     (periodic_ ? ", periodic" : ", walls");
  for (const auto& [name, value] : {std::pair{"density", p.density},
                                    {"cov", p.cov},
                                    {"truncation", p.truncation},
                                    {"smallest_radius", p.smallest_radius},
                                    {"growth_rate", p.growth_rate},
                                    {"fluid_growth_rate", p.fluid_growth_rate},
                                    {"late_growth_rate", p.late_growth_rate},
                                    {"late_pressure", p.late_pressure},
                                    {"pressure_limit", p.pressure_limit}})
    text += std::string(", ") + name + ' ' + core::to_text(value);
  return text;
}

inline LubachevskyStillinger::State LubachevskyStillinger::state_of(const detail::GrowingSpheres& spheres,
                                                                    const detail::Growth& growth) const {
  const detail::GrowingSpheres::State whole = spheres.state();
  State state;
  state.parameters = words();
  state.spheres.reserve(12 * spheres.size());
  state.partners.reserve(spheres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const detail::Body& body = whole.bodies[i];
    const detail::Shell& shell = whole.shells[i];
    for (const double value :
         {body.origin[0], body.origin[1], body.origin[2], body.next, body.velocity[0], body.velocity[1],
          body.velocity[2], body.size, shell.centre[0], shell.centre[1], shell.centre[2], shell.radius})
      state.spheres.push_back(value);
    state.partners.push_back(whole.partners[i]);
  }
  state.numbers = {whole.scale,
                   whole.growth,
                   whole.energy,
                   whole.skin,
                   whole.listed_skin,
                   whole.window,
                   whole.sums.duration,
                   whole.sums.virial,
                   whole.sums.action,
                   0,
                   growth.pressure,
                   growth.last.duration,
                   growth.last.virial,
                   growth.last.action,
                   growth.watch.sound_duration(),
                   growth.interval,
                   growth.first_density};
  state.counts = {
      whole.today,           whole.sums.events,      whole.sums.collisions,
      growth.last.events,    growth.last.collisions, static_cast<std::uint64_t>(growth.watch.hesitations()),
      growth.late ? 1U : 0U, growth.cycle,           growth.events,
      growth.collisions};
  return state;
}

inline detail::GrowingSpheres LubachevskyStillinger::spheres_of(const State& state,
                                                                core::ThreadPool& pool) const {
  core::expect(state.parameters == words(), "state of a run with " + state.parameters, "",
               "one with " + words() + " is expected");
  const std::size_t count = sizes_.size();
  core::expect(state.spheres.size() == 12 * count && state.partners.size() == count &&
                   state.numbers.size() == 17 && state.counts.size() == 10,
               "numbers in a state", state.spheres.size(), "a complete state is expected");
  detail::GrowingSpheres::State whole;
  for (std::size_t i = 0; i < count; ++i) {
    const double* const x = state.spheres.data() + 12 * i;
    whole.bodies.push_back({Vec3(x[0], x[1], x[2]), x[3], Vec3(x[4], x[5], x[6]), x[7]});
    whole.shells.push_back({Vec3(x[8], x[9], x[10]), x[11]});
    whole.partners.push_back(state.partners[i]);
  }
  const std::vector<double>& x = state.numbers;
  whole.scale = x[0];
  whole.growth = x[1];
  whole.energy = x[2];
  whole.skin = x[3];
  whole.listed_skin = x[4];
  whole.window = x[5];
  whole.sums = {state.counts[1], state.counts[2], x[6], x[7], x[8]};
  whole.today = state.counts[0];
  return {std::move(whole), periodic_, pool};
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
inline double LubachevskyStillinger::growth_at(double density, bool late) const {
  if (late && parameters_.late_growth_rate > 0)
    return parameters_.late_growth_rate;
  return density < fluid_density ? std::max(parameters_.fluid_growth_rate, parameters_.growth_rate)
                                 : parameters_.growth_rate;
}

/// Room that a sphere gets to move in before its list of neighbours is renewed: about its free path, which falls as
/// the inverse of the pressure. Any value gives the same motion; this one is quick.
inline double LubachevskyStillinger::skin_at(double scale, double pressure) const {
  const double skin = scale * std::clamp(4 / pressure, 0.02, 0.22);
  // Shells may not meet a periodic image of what they meet already.
  return periodic_ ? std::min(skin, 0.25 - largest_size_ * scale_at(parameters_.density)) : skin;
}

inline StopReason LubachevskyStillinger::grow(detail::GrowingSpheres& spheres, detail::Growth& growth,
                                              core::ThreadPool& pool, const core::Monitor& monitor,
                                              const Checkpoints& checkpoints) const {
  constexpr std::uint64_t slice = 16384; // events between two looks at the clock
  const auto count = static_cast<double>(spheres.size());
  const double final_scale = scale_at(parameters_.density);
  auto reported = Clock::now(), saved = reported;
  const auto seconds_since = [](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  };
  const auto report_progress = [&] {
    const double density = density_at(spheres.scale()), first = growth.first_density;
    monitor.report(
        {"packing", std::clamp((density - first) / (parameters_.density - first), 0.0, 1.0),
         "density " + core::to_text(density) + ", reduced pressure " + core::to_text(growth.pressure)});
    reported = Clock::now();
  };

  for (;;) {
    if (growth.cycle == 0) {
      // A cycle is short enough for the growth not to heat the spheres by much before they are cooled again.
      const double rate = growth_at(density_at(spheres.scale()), growth.late);
      growth.cycle = static_cast<std::uint64_t>(std::max(std::clamp(0.3 / rate, 1.0, 20.0) * count, 1000.0));
      spheres.begin_cycle(rate, skin_at(spheres.scale(), growth.pressure), growth.interval, pool);
    }
    bool reached = false;
    while (!reached && !spheres.stuck() && spheres.sums().events < growth.cycle) {
      reached = spheres.run(std::min(slice, growth.cycle - spheres.sums().events), final_scale, pool);
      if (reached || spheres.stuck())
        break;
      const bool stop = monitor.stop_requested();
      if (checkpoints.save && (stop || seconds_since(saved) > checkpoints.seconds)) {
        checkpoints.save(state_of(spheres, growth));
        saved = Clock::now();
      }
      if (stop || seconds_since(reported) > 0.25)
        report_progress();
    }
    spheres.synchronise();
    const detail::CollisionSums sums = spheres.sums();
    growth.cycle = 0;
    growth.events += sums.events;
    growth.collisions += sums.collisions;
    if (reached) {
      growth.pressure = (sums.collisions < spheres.size() ? growth.last + sums : sums).reduced_pressure();
      report_progress();
      return StopReason::density_reached;
    }
    switch (growth.watch.judge(sums.duration)) {
    case detail::StallWatch::Verdict::stalled:
      report_progress();
      return StopReason::stalled;
    case detail::StallWatch::Verdict::hesitates:
      spheres.shrink(1e-13);
      continue;
    case detail::StallWatch::Verdict::advances:
      break;
    }
    growth.last = sums;
    growth.interval = sums.duration / static_cast<double>(sums.events);
    growth.pressure = sums.reduced_pressure();
    growth.late = growth.late || growth.pressure > parameters_.late_pressure;
    if (growth.pressure > parameters_.pressure_limit) {
      report_progress();
      return StopReason::pressure_limit;
    }
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
