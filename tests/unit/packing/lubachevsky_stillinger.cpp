// Packings: no overlap, the wanted sizes, the wanted density or a report that says why not.

#include <cdem/packing/lubachevsky_stillinger.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "brute_force.hpp"

namespace {

using namespace cdem;
using packing::Boundary;
using packing::LubachevskyStillinger;
using packing::StopReason;
using sample::same_bytes;
using Parameters = LubachevskyStillinger::Parameters;

double largest_overlap(const packing::Packing<LubachevskyStillinger::Report>& packing) {
  return sample::brute_force(packing.particles, packing.box).largest_overlap;
}

double sum_of_volumes(const particles::ParticleSet& spheres) {
  double sum = 0;
  for (const double r : spheres.radius)
    sum += std::pow(2 * r, 3) * std::acos(-1) / 6;
  return sum;
}

/// Largest distance between the empirical distribution of a sample and a normal law of mean 1 cut at [lower, upper].
double kolmogorov_smirnov(std::vector<double> sample, double cov, double lower, double upper) {
  std::sort(sample.begin(), sample.end());
  const auto normal = [&](double x) { return 0.5 * std::erfc((1 - x) / (cov * std::sqrt(2.0))); };
  double distance = 0;
  const auto n = static_cast<double>(sample.size());
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double law = (normal(sample[i]) - normal(lower)) / (normal(upper) - normal(lower));
    const auto rank = static_cast<double>(i);
    distance = std::max({distance, law - rank / n, (rank + 1) / n - law});
  }
  return distance;
}
/// Critical value at the 1 % level.
double critical_distance(std::size_t n) {
  return 1.628 / std::sqrt(static_cast<double>(n));
}

std::string rejection(const Parameters& parameters) {
  try {
    LubachevskyStillinger generator(parameters);
    return "";
  } catch (const core::InvalidInput& error) {
    return error.what();
  }
}

} // namespace

TEST_CASE("a periodic packing has its density, its number, and no overlap") {
  const Parameters parameters{.particles = 1000, .density = 0.62, .growth_rate = 0.05, .side = 0.02};
  const auto packing = LubachevskyStillinger(parameters).pack();
  const auto& [spheres, box, report] = packing;
  CHECK(report.reason == StopReason::density_reached);
  CHECK(report.reached());
  CHECK_NOTHROW(report.require_reached());
  CHECK_NOTHROW(spheres.validate());
  CHECK(spheres.size() == 1000);
  CHECK(box.volume() == doctest::Approx(8e-6).epsilon(1e-14));
  CHECK(box.periodic == std::array{true, true, true});
  CHECK(std::abs(sum_of_volumes(spheres) / 8e-6 - 0.62) <
        1e-12); // at the very moment, not at the collision after
  CHECK(std::abs(report.density - 0.62) < 1e-12);
  CHECK(largest_overlap(packing) < 1e-10);
  CHECK(report.largest_overlap < 1e-10);
  for (const Vec3& x : spheres.position)
    CHECK(((x.array() >= 0).all() && (x.array() < 0.02).all()));
  // Spheres hold on to little room: the pressure of a dense fluid, far above the ideal gas, far below a jammed one.
  CHECK(report.pressure > 20);
  CHECK(report.pressure < 1e4);
  CHECK(report.collisions_per_particle == doctest::Approx(static_cast<double>(report.collisions) / 1000));
  CHECK(report.events > report.collisions);
  CHECK(report.wall_seconds > 0);
  CHECK(report.events_per_second ==
        doctest::Approx(static_cast<double>(report.events) / report.wall_seconds));
}

TEST_CASE("a walled packing stays between its walls") {
  const auto packing =
      LubachevskyStillinger({.particles = 800, .density = 0.56, .boundary = Boundary::walls}).pack();
  CHECK(packing.report.reached());
  CHECK(packing.box.periodic == std::array{false, false, false});
  CHECK(std::abs(sum_of_volumes(packing.particles) / packing.box.volume() - 0.56) < 1e-12);
  CHECK(largest_overlap(packing) < 1e-10); // of walls as well
  CHECK(packing.report.largest_overlap < 1e-10);
}

TEST_CASE("walls make a packing looser") {
  const Parameters parameters{
      .particles = 400, .density = 0.7, .cov = 0, .growth_rate = 0.05, .pressure_limit = 1e4};
  Parameters walled = parameters;
  walled.boundary = Boundary::walls;
  const double density = LubachevskyStillinger(parameters).pack().report.density;
  const double walled_density = LubachevskyStillinger(walled).pack().report.density;
  CHECK(walled_density < density - 0.02);
  CHECK(walled_density > 0.5);
}

TEST_CASE("radii follow the normal law cut at three standard deviations") {
  const auto packing =
      LubachevskyStillinger({.particles = 2000, .density = 0.3, .cov = 0.3, .fluid_growth_rate = 1}).pack();
  std::vector<double> sample = packing.particles.radius;
  for (double& radius : sample)
    radius /= packing.report.mean_radius;
  CHECK(kolmogorov_smirnov(sample, 0.3, 0.1, 1.9) < critical_distance(sample.size()));
  CHECK(kolmogorov_smirnov(sample, 0.25, 0.25, 1.75) > critical_distance(sample.size())); // the test can tell
  CHECK(packing.report.cov == doctest::Approx(0.296).epsilon(0.05)); // three standard errors: 0.3/sqrt(2 n)

  // The draws themselves, before their mean is taken out.
  core::Random random(99);
  const auto draws = packing::detail::truncated_normal(20000, 0.4, 0.1, 2.2, random);
  CHECK(kolmogorov_smirnov(draws, 0.4, 0.1, 2.2) < critical_distance(draws.size()));
}

TEST_CASE("radii do not depend on their place in the list") {
  const auto packing = LubachevskyStillinger({.particles = 2000, .density = 0.5}).pack();
  const auto& radius = packing.particles.radius;
  const double mean = packing.report.mean_radius, deviation = mean * packing.report.cov;
  double rank_correlation = 0, next_correlation = 0;
  const auto n = static_cast<double>(radius.size());
  for (std::size_t i = 0; i < radius.size(); ++i) {
    const double z = (radius[i] - mean) / deviation;
    rank_correlation += z * (static_cast<double>(i) - n / 2) / (n / std::sqrt(12.0)) / n;
    if (i > 0)
      next_correlation += z * (radius[i - 1] - mean) / deviation / n;
  }
  CHECK(std::abs(rank_correlation) < 3 / std::sqrt(n));
  CHECK(std::abs(next_correlation) < 4 / std::sqrt(n)); // neighbours in space may be a little alike
}

TEST_CASE("equal spheres jam between 0.62 and 0.65, denser when they grow slowly") {
  Parameters parameters{
      .particles = 500, .density = 0.7, .cov = 0, .growth_rate = 0.06, .pressure_limit = 1e5};
  const auto fast = LubachevskyStillinger(parameters).pack();
  parameters.growth_rate = 0.015;
  const auto slow = LubachevskyStillinger(parameters).pack();
  for (const auto* packing : {&fast, &slow}) {
    CHECK(packing->report.reason == StopReason::pressure_limit);
    CHECK(packing->report.density > 0.62);
    CHECK(packing->report.density < 0.65);
    CHECK(packing->report.cov == doctest::Approx(0).epsilon(1e-12));
    CHECK(largest_overlap(*packing) < 1e-10);
  }
  CHECK(slow.report.density > fast.report.density);
  // A slow jammed packing is held by about six contacts a sphere (isostatic), and few rattle.
  CHECK(slow.report.contact_number > 5.5);
  CHECK(slow.report.contact_number < 6.3);
  CHECK(slow.report.rattlers < 40);
}

TEST_CASE("the same seed gives the same bytes, another seed gives others") {
  Parameters parameters{.particles = 500, .density = 0.6};
  const auto first = LubachevskyStillinger(parameters).pack();
  const LubachevskyStillinger generator(parameters);
  CHECK(same_bytes(first.particles, generator.pack().particles));
  CHECK(same_bytes(first.particles, generator.pack().particles)); // packing leaves no trace in the generator
  CHECK(first.report.collisions == generator.pack().report.collisions);
  parameters.seed = 2;
  CHECK_FALSE(same_bytes(first.particles, LubachevskyStillinger(parameters).pack().particles));
}

TEST_CASE("the unit of length changes nothing but the unit") {
  Parameters parameters{.particles = 300, .density = 0.55, .side = 1};
  const auto metre = LubachevskyStillinger(parameters).pack();
  parameters.side = 0.0078125; // a power of two: exact
  const auto small = LubachevskyStillinger(parameters).pack();
  bool same = true;
  for (std::size_t i = 0; i < metre.particles.size(); ++i)
    same &= metre.particles.position[i] * 0.0078125 == small.particles.position[i] &&
            metre.particles.radius[i] * 0.0078125 == small.particles.radius[i];
  CHECK(same);
}

TEST_CASE("a density that cannot be reached ends with a flagged report") {
  const Parameters parameters{.particles = 300, .density = 0.73, .cov = 0, .growth_rate = 0.1};
  const auto packing = LubachevskyStillinger(parameters).pack();
  const auto& report = packing.report;
  CHECK(report.reason == StopReason::pressure_limit);
  CHECK_FALSE(report.reached());
  CHECK(report.pressure > 1e8);
  CHECK(report.density < 0.66);
  CHECK(report.density > 0.58);
  CHECK(report.wanted_density == 0.73);
  CHECK(largest_overlap(packing) < 1e-10);
  try {
    report.require_reached();
    FAIL("must throw");
  } catch (const core::NotReached& error) {
    const std::string message = error.what();
    CHECK(message.find("density 0.73 was not reached") != std::string::npos);
    CHECK(message.find("pressure limit") != std::string::npos);
    CHECK(message.find(core::to_text(report.density)) != std::string::npos);
    CHECK(message.find(core::to_text(report.pressure)) != std::string::npos);
  }
}

TEST_CASE("low densities, one sphere and few spheres") {
  const auto single =
      LubachevskyStillinger({.particles = 1, .density = 0.5, .cov = 0, .boundary = Boundary::walls}).pack();
  CHECK(single.report.reached());
  CHECK(largest_overlap(single) < 1e-10);
  const auto few = LubachevskyStillinger({.particles = 40, .density = 0.5, .cov = 0}).pack();
  CHECK(few.report.reached());
  CHECK(largest_overlap(few) < 1e-10);
  const auto loose = LubachevskyStillinger({.particles = 200, .density = 0.01}).pack();
  CHECK(std::abs(sum_of_volumes(loose.particles) / loose.box.volume() - 0.01) < 1e-14);
  CHECK(loose.report.pressure > 0.9);
}

TEST_CASE("no packing stalls or overlaps, whatever the seed, spread and growth") {
  for (const auto boundary : {Boundary::periodic, Boundary::walls})
    for (const double cov : {0.0, 0.03, 0.45})
      for (const double growth : {1.0, 0.1})
        for (const double limit : {1e8, 1e12}) {
          const Parameters parameters{.particles = 150,
                                      .density = 0.74,
                                      .cov = cov,
                                      .growth_rate = growth,
                                      .pressure_limit = limit,
                                      .boundary = boundary,
                                      .seed = static_cast<std::uint64_t>(1000 * (cov + growth))};
          const auto packing = LubachevskyStillinger(parameters).pack();
          CAPTURE(cov);
          CAPTURE(growth);
          CAPTURE(limit);
          CHECK(packing.report.reason == StopReason::pressure_limit);
          CHECK(largest_overlap(packing) < 1e-10);
        }
}

// Below 100,000 spheres one of the threads works alone; the dynamics on several is compared in growing_spheres.
TEST_CASE("threads change nothing in a packing") {
  const LubachevskyStillinger generator({.particles = 6000, .density = 0.61, .cov = 0.1, .growth_rate = 0.3});
  core::ThreadPool two(2);
  const auto shared = generator.pack(two);
  const auto alone = generator.pack();
  CHECK(same_bytes(alone.particles, shared.particles));
  CHECK(alone.report.pressure == shared.report.pressure);
  CHECK(alone.report.collisions == shared.report.collisions);
}

TEST_CASE("a run goes on from any of its states to the same bytes") {
  for (const auto boundary : {Boundary::periodic, Boundary::walls}) {
    const LubachevskyStillinger generator({.particles = 600,
                                           .density = 0.6,
                                           .growth_rate = 0.1,
                                           .late_growth_rate = 0.05,
                                           .boundary = boundary});
    core::ThreadPool pool;
    std::vector<packing::GrowthState> states;
    const packing::GrowthCheckpoints checkpoints{
        [&](const packing::GrowthState& state) { states.push_back(state); }, 0};
    const auto whole = generator.pack(pool, core::Monitor(), checkpoints);
    REQUIRE(states.size() > 3);
    for (const std::size_t k : {std::size_t{0}, states.size() / 2, states.size() - 1}) {
      const auto resumed = generator.resume(states[k], pool);
      CHECK(same_bytes(whole.particles, resumed.particles));
      CHECK(whole.report.collisions == resumed.report.collisions);
      CHECK(whole.report.pressure == resumed.report.pressure);
    }
    packing::GrowthState cut = states[0];
    cut.partners.pop_back();
    CHECK_THROWS_WITH_AS(generator.resume(cut, pool),
                         "numbers in a state = 7200 is not accepted: a complete state is expected",
                         core::InvalidInput);
    const LubachevskyStillinger other({.particles = 600, .density = 0.6, .seed = 2});
    CHECK_THROWS_AS(other.resume(states[0], pool), core::InvalidInput);
  }
}

TEST_CASE("a run that is asked to stop hands out its state first") {
  const LubachevskyStillinger generator({.particles = 500, .density = 0.6});
  std::atomic<bool> stop{true};
  core::ThreadPool pool;
  packing::GrowthState state;
  CHECK_THROWS_AS(generator.pack(pool, core::Monitor(nullptr, &stop),
                                 {[&](const packing::GrowthState& s) { state = s; }, 600}),
                  core::Interrupted);
  CHECK(same_bytes(generator.resume(state, pool).particles, generator.pack().particles));
}

TEST_CASE("growth that slows down jams denser, and the contacts are isostatic") {
  Parameters parameters{
      .particles = 250, .density = 0.74, .cov = 0, .growth_rate = 0.1, .pressure_limit = 1e8};
  const double fast = LubachevskyStillinger(parameters).pack().report.density;
  parameters.late_growth_rate = 0.001;
  parameters.late_pressure = 100;
  const auto packing = LubachevskyStillinger(parameters).pack();
  CHECK(packing.report.density > fast);
  const auto survey =
      packing::detail::survey_contacts(packing.particles, packing.box, 1000 / packing.report.pressure);
  CHECK(survey.contact_number == doctest::Approx(6).epsilon(0.01));
  CHECK(survey.rattlers < 15);
  // Gaps beyond the contacts: the number within a relative gap h grows as h^0.6 (g(h) ~ h^-0.4, Donev, Torquato and
  // Stillinger 2005): over two decades 16-fold, where a plain edge of a fluid would give 100-fold.
  double small = 0, large = 0;
  const auto& spheres = packing.particles;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double gap = packing.box.minimum_image(spheres.position[i] - spheres.position[j]).norm() /
                             (2 * spheres.radius[0]) -
                         1;
      small += gap > 1e-5 && gap < 1e-3;
      large += gap > 1e-5 && gap < 1e-1;
    }
  CHECK(std::log10(large / small) / 2 == doctest::Approx(0.6).epsilon(0.15));
}

TEST_CASE("a run that is asked to stop is interrupted, and says where") {
  std::atomic<bool> stop{true};
  int reports = 0;
  const core::Monitor monitor([&](const core::Progress&) { ++reports; }, &stop);
  try {
    LubachevskyStillinger({.particles = 1000}).pack(monitor);
    FAIL("must throw");
  } catch (const core::Interrupted& error) {
    CHECK(std::string(error.what()).find("packing interrupted at") != std::string::npos);
  }
  CHECK(reports == 1);
}

TEST_CASE("progress ends at one and tells density and pressure") {
  std::vector<double> fractions;
  std::string detail, stage;
  const core::Monitor monitor([&](const core::Progress& progress) {
    fractions.push_back(progress.fraction);
    detail = progress.detail;
    stage = progress.stage;
  });
  LubachevskyStillinger({.particles = 500, .density = 0.55}).pack(monitor);
  REQUIRE_FALSE(fractions.empty());
  CHECK(std::is_sorted(fractions.begin(), fractions.end()));
  CHECK(fractions.front() >= 0);
  CHECK(fractions.back() == doctest::Approx(1).epsilon(1e-9));
  CHECK(stage == "packing");
  CHECK(detail.find("density 0.55") != std::string::npos);
  CHECK(detail.find("pressure") != std::string::npos);
}

TEST_CASE("every bad parameter is named") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  CHECK(rejection({}) == "");
  CHECK(rejection({.particles = 0}) == "number of particles = 0 is not accepted: 1 to 100000000 is expected");
  for (const double bad : {nan, -0.1, 0.0, 1.0, 1.5, infinity})
    CHECK(rejection({.density = bad}) ==
          "density = " + core::to_text(bad) + " is not accepted: above 0 and below 1 is expected");
  CHECK(rejection({.density = 0.7405, .cov = 0}).find("densest packing of equal spheres") !=
        std::string::npos);
  CHECK(rejection({.density = 0.74, .cov = 0}) == "");
  for (const double bad : {nan, -0.1, 0.51, infinity})
    CHECK(rejection({.cov = bad}) ==
          "CoV of the radii = " + core::to_text(bad) + " is not accepted: 0 to 0.5 is expected");
  for (const double bad : {nan, 0.0, 0.9, 6.1})
    CHECK(rejection({.truncation = bad}) ==
          "truncation = " + core::to_text(bad) + " is not accepted: 1 to 6 standard deviations is expected");
  for (const double bad : {nan, 0.0, -1.0, 0.95})
    CHECK(rejection({.smallest_radius = bad}).find("smallest radius over the mean = ") == 0);
  for (const double bad : {nan, 0.0, -0.1, 1.1}) {
    CHECK(rejection({.growth_rate = bad}).find("growth rate = ") == 0);
    CHECK(rejection({.fluid_growth_rate = bad}).find("growth rate of the fluid = ") == 0);
  }
  for (const double bad : {nan, -0.1, 1e-7, 1.1})
    CHECK(rejection({.late_growth_rate = bad}).find("late growth rate = ") == 0);
  for (const double bad : {nan, 0.0, 4.0, 1e13})
    CHECK(rejection({.late_pressure = bad}).find("late pressure = ") == 0);
  for (const double bad : {nan, 0.0, 10.0, 1e13, infinity})
    CHECK(rejection({.pressure_limit = bad}).find("pressure limit = ") == 0);
  for (const double bad : {nan, 0.0, -1.0, infinity})
    CHECK(rejection({.side = bad}).find("side of the cube = ") == 0);
  CHECK(rejection({.boundary = static_cast<Boundary>(7)}) ==
        "boundary = 7 is not accepted: periodic or walls is expected");
  // Too few for periodic images not to see each other; walls have none.
  CHECK(rejection({.particles = 10, .cov = 0})
            .find("number of particles = 10 is not accepted: more are expected") == 0);
  CHECK(rejection({.particles = 10, .cov = 0, .boundary = Boundary::walls}) == "");
  CHECK(rejection({.particles = 1, .density = 0.6, .cov = 0, .boundary = Boundary::walls})
            .find("more are expected") != std::string::npos);
}
