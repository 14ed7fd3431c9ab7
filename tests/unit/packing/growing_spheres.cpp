// The dynamics of growing hard spheres, against closed solutions, conservation laws and the theory of fluids.

#include <cdem/core/random.hpp>
#include <cdem/packing/detail/growing_spheres.hpp>
#include <cdem/packing/detail/random_start.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <set>
#include <vector>

namespace {

using namespace cdem;
using packing::detail::Approach;
using packing::detail::GrowingSpheres;
using packing::detail::never;

Vec3 random_vector(core::Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

/// Spheres at rest as a whole, grown from a loose start to a density.
GrowingSpheres fluid(std::size_t count, double cov, double density, bool periodic, std::uint64_t seed) {
  core::Random random(seed);
  auto sizes = packing::detail::truncated_normal(count, cov, 0.1, 1.9, random);
  for (double& size : sizes)
    size /= 2;
  const double volume = packing::detail::volume_of_spheres(sizes);
  const double scale = std::cbrt(std::min(0.2, density) / volume);
  auto radii = sizes;
  for (double& radius : radii)
    radius *= scale;
  const auto centres = packing::detail::add_sequentially(radii, periodic, random);
  std::vector<Vec3> velocities(count);
  Vec3 drift = Vec3::Zero();
  for (Vec3& velocity : velocities) {
    for (int k = 0; k < 3; ++k)
      velocity[k] = random.normal();
    drift += velocity / static_cast<double>(count);
  }
  for (Vec3& velocity : velocities)
    velocity -= drift;
  GrowingSpheres spheres(centres, sizes, velocities, scale, periodic);
  const double end = std::cbrt(density / volume);
  for (bool reached = end <= scale; !reached;) {
    spheres.begin_cycle(0.3, 0.2 * scale, 0.01 * scale / static_cast<double>(count));
    reached = spheres.run(2 * count, end);
    spheres.synchronise();
  }
  return spheres;
}

Vec3 momentum(const GrowingSpheres& spheres) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < spheres.size(); ++i)
    sum += spheres.velocity(i);
  return sum;
}

} // namespace

TEST_CASE("head-on spheres touch when the gap over the closing speed has passed") {
  // Gap 3 - 2, closing at 0.5 + 0.3.
  CHECK(Approach({3, 0, 0}, {-0.5, 0, 0}, 2, 0.3).time_to_contact() ==
        doctest::Approx(1 / 0.8).epsilon(1e-14));
  // At rest, growth alone.
  CHECK(Approach({3, 0, 0}, {0, 0, 0}, 2, 0.5).time_to_contact() == doctest::Approx(2).epsilon(1e-14));
  // Parting, but growth is faster.
  CHECK(Approach({3, 0, 0}, {0.2, 0, 0}, 2, 0.7).time_to_contact() == doctest::Approx(2).epsilon(1e-14));
  CHECK(Approach({3, 0, 0}, {0.2, 0, 0}, 2, 0.1).time_to_contact() == never);
  CHECK(Approach({3, 2.1, 0}, {-1, 0, 0}, 2, 0).time_to_contact() == never); // passes by
  CHECK(Approach({3, 0, 0}, {0, 0, 0}, 2, 0).time_to_contact() == never);
}

TEST_CASE("spheres that overlap by rounding collide at once if they approach and part if they part") {
  const double overlap = 2 - 1e-15;
  CHECK(Approach({overlap, 0, 0}, {-1, 0, 0}, 2, 0.1).time_to_contact() == 0);
  CHECK(Approach({2, 0, 0}, {-1, 0, 0}, 2, 0.1).time_to_contact() == 0);
  CHECK(Approach({overlap, 0, 0}, {1, 0, 0}, 2, 0.1).time_to_contact() == never);
}

TEST_CASE("a nearly closed gap keeps its digits") {
  const double gap = 1e-10;
  const double time = Approach({2 + gap, 0, 0}, {-1, 0, 0}, 2, 0).time_to_contact();
  CHECK(time == doctest::Approx((2 + gap) - 2).epsilon(1e-14)); // the gap as rounded in the input
}

TEST_CASE("random spheres touch at the time found, and not before") {
  core::Random random(7);
  int contacts = 0, passes = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Vec3 d = 3 * random_vector(random), w = random_vector(random);
    const double S = 0.9 * d.norm() * random.uniform(), G = 0.6 * random.uniform();
    const auto gap = [&](double t) { return (d + w * t).norm() - S - G * t; };
    const double time = Approach(d, w, S, G).time_to_contact();
    const double horizon = time < never ? time : 100;
    CHECK(horizon > 0);
    bool apart = true;
    for (int k = 0; k < 100; ++k)
      apart &= gap(horizon * (k / 100.0)) > 0;
    CHECK(apart);
    if (time < never) {
      ++contacts;
      CHECK(std::abs(gap(time)) < 1e-9 * (1 + time));
    } else
      ++passes;
  }
  CHECK(contacts > 500);
  CHECK(passes > 500);
}

TEST_CASE("a sphere reaches its shell at the time found, and not before") {
  core::Random random(8);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 v = random_vector(random);
    const double room = random.uniform(0.1, 1.0), g = random.uniform();
    const Vec3 y = 0.5 * room * random_vector(random);
    const auto left = [&](double t) { return room - g * t - (y + v * t).norm(); };
    const double time = packing::detail::time_to_shell(y, v, room, g);
    CHECK(time < never);
    CHECK(std::abs(left(time)) < 1e-9);
    for (int k = 0; k < 20; ++k)
      CHECK(left(time * (k / 20.0)) > 0);
  }
  CHECK(packing::detail::time_to_shell(Vec3::Zero(), Vec3::Zero(), 1, 0) == never);
  CHECK(packing::detail::time_to_shell(Vec3::Zero(), Vec3::Zero(), 1, 0.5) == doctest::Approx(2));
}

TEST_CASE("contact times in vector registers are those of the plain loop, to the last bit") {
  using namespace packing::detail;
  core::Random random(17);
  for (const bool periodic : {true, false})
    for (std::size_t count = 1; count < 40; ++count) {
      SphereArray<Body> bodies(count + 1);
      std::vector<ParticleIndex> list(count);
      for (std::size_t k = 0; k <= count; ++k)
        bodies[k] = {random_vector(random), random.uniform() < 0.3 ? 3 * random.uniform() : never,
                     random_vector(random), random.uniform()};
      if (count > 5)
        bodies[count / 2] = bodies[3]; // two contacts at the same time: the smaller number comes first
      for (std::size_t k = 0; k < count; ++k)
        list[k] = static_cast<ParticleIndex>((7 * k + 3) % count);
      const Present at{0.25, 0.1, 0.05, periodic};
      const Vec3 centre = bodies[count].centre_at(at.now);
      std::vector<double> plain(count + 4), quick(count + 4);
      const Soonest a = plain_contact_times(bodies.data(), list, bodies[count], centre, at, plain.data());
      const Soonest b = contact_times(bodies.data(), list, bodies[count], centre, at, quick.data());
      REQUIRE(std::memcmp(plain.data(), quick.data(), count * sizeof(double)) == 0);
      REQUIRE(a.time == b.time);
      if (a.time < never)
        REQUIRE(list[a.place] == list[b.place]);
    }
}

TEST_CASE("the calendar gives every appointment on its day, also years later") {
  constexpr std::size_t count = 3000;
  core::Random random(3);
  for (const double day : {1e-3, 0.02, 5.0}) {
    packing::detail::EventCalendar calendar;
    calendar.restart(2, day, 300, 10, 0);
    std::multiset<double> expected;
    std::vector<double> times;
    for (std::size_t k = 0; k < count; ++k) {
      const double time =
          k % 10 == 0 ? day * static_cast<double>(k) : 3 * random.uniform(); // many at midnight
      calendar.add(k % 2, {time, static_cast<ParticleIndex>(k)});
      times.push_back(time);
      expected.insert(time);
    }
    calendar.add(0, {never, 0}); // is not kept
    while (!expected.empty()) {
      for (std::size_t lane = 0; lane < 2; ++lane) {
        for (const ParticleIndex k : calendar.today_of(lane)) {
          REQUIRE(times[k] < calendar.end_of_today());
          REQUIRE(times[k] >= calendar.start_of_today() * (1 - 1e-15));
          const auto found = expected.find(times[k]);
          REQUIRE(found != expected.end());
          expected.erase(found);
        }
      }
      REQUIRE((expected.empty() || *expected.begin() >= calendar.end_of_today()));
      calendar.next_day();
    }
  }
}

TEST_CASE("appointments are sorted as by comparing them, however they are spread") {
  using packing::detail::Appointment;
  core::Random random(4);
  std::vector<Appointment> scratch;
  std::vector<std::uint32_t> ends;
  for (const std::size_t count : {0UL, 5UL, 47UL, 48UL, 1000UL, 3000UL})
    for (const double spread : {1.0, 1e-9, 0.0, 5.0}) { // of the window, none at all, beyond it
      std::vector<Appointment> sorted;
      for (std::size_t k = 0; k < count; ++k) // each twice
        sorted.push_back(
            {3 + 0.5 * spread * random.uniform(), static_cast<ParticleIndex>(random.bits() % (count / 2))});
      auto expected = sorted;
      std::sort(expected.begin(), expected.end());
      packing::detail::sort_by_time(sorted, 3, 2, scratch, ends);
      for (std::size_t k = 0; k < count; ++k)
        REQUIRE((sorted[k].time == expected[k].time && sorted[k].sphere == expected[k].sphere));
    }
}

TEST_CASE("near-neighbour lists hold the pairs of overlapping shells, whatever was renewed") {
  constexpr ParticleIndex count = 250;
  for (const bool periodic : {true, false}) {
    core::Random random(5);
    const auto random_shell = [&] {
      const Vec3 centre(random.uniform(), random.uniform(), random.uniform());
      return packing::detail::Shell{centre, random.uniform(0.01, 0.12)};
    };
    packing::detail::SphereArray<packing::detail::Shell> shells(count);
    for (auto& shell : shells)
      shell = random_shell();
    packing::detail::NearNeighbours neighbours(count, periodic);
    neighbours.rebuild(shells);
    const auto compare = [&] {
      for (ParticleIndex i = 0; i < count; ++i) {
        std::set<ParticleIndex> expected;
        for (ParticleIndex j = 0; j < count; ++j) {
          Vec3 d = shells[i].centre - shells[j].centre;
          for (int k = 0; k < 3 && periodic; ++k)
            d[k] -= std::round(d[k]);
          if (j != i && d.norm() < shells[i].radius + shells[j].radius)
            expected.insert(j);
        }
        const auto list = neighbours.of(i);
        REQUIRE(list.size() == expected.size());
        REQUIRE(std::set<ParticleIndex>(list.begin(), list.end()) == expected);
      }
    };
    compare();
    for (int round = 0; round < 5; ++round) {
      for (int change = 0; change < 600;
           ++change) { // enough to make lists outgrow their room and be packed again
        const auto i = static_cast<ParticleIndex>(random.bits() % count);
        shells[i] = random_shell();
        neighbours.renew(i, shells[i]);
      }
      compare();
    }
  }
}

TEST_CASE("collisions without growth conserve energy and momentum") {
  GrowingSpheres spheres = fluid(500, 0.3, 0.45, true, 11);
  spheres.begin_cycle(0, 0.01, 1e-6);
  const double energy = spheres.kinetic_energy();
  spheres.run(50000, 1);
  spheres.synchronise();
  CHECK(spheres.sums().collisions > 20000);
  CHECK(energy == doctest::Approx(1.5 * 500).epsilon(1e-13));
  CHECK(spheres.kinetic_energy() == doctest::Approx(energy).epsilon(1e-11));
  CHECK(momentum(spheres).norm() < 1e-9);
}

TEST_CASE("walls conserve energy without growth") {
  GrowingSpheres spheres = fluid(300, 0.3, 0.4, false, 12);
  spheres.begin_cycle(0, 0.01, 1e-6);
  const double energy = spheres.kinetic_energy();
  spheres.run(30000, 1);
  spheres.synchronise();
  CHECK(spheres.kinetic_energy() == doctest::Approx(energy).epsilon(1e-11));
}

TEST_CASE("growth does the work of the virial") {
  // dE = P d(volume of exclusion): each contact's virial times the relative growth, in a period too short for the
  // scale to change.
  for (const bool periodic : {true, false}) {
    GrowingSpheres spheres = fluid(500, 0.3, 0.45, periodic, 13);
    const double growth = 1e-3;
    spheres.begin_cycle(growth, 0.01, 1e-6);
    const double energy = spheres.kinetic_energy(), scale = spheres.scale();
    spheres.run(20000, 1);
    spheres.synchronise();
    const double middle = (scale + spheres.scale()) / 2;
    CHECK(spheres.kinetic_energy() - energy > 0.01 * energy);
    CHECK(spheres.kinetic_energy() - energy ==
          doctest::Approx(spheres.sums().virial * growth / middle).epsilon(2e-3));
  }
}

TEST_CASE("a sphere between two walls bounces as often as its path is long") {
  // Radius 0.1, no growth: the centre goes over 0.8 at a speed of sqrt(3), the thermal speed being 1.
  GrowingSpheres sphere({Vec3(0.5, 0.5, 0.5)}, {0.5}, {Vec3(1, 0, 0)}, 0.2, false);
  sphere.begin_cycle(0, 0.3, 0.01);
  while (sphere.sums().collisions < 1000)
    sphere.run(1, 1);
  // The run ends between two collisions.
  const auto& sums = sphere.sums();
  CHECK(static_cast<double>(sums.collisions) == std::floor((sums.duration * std::sqrt(3.0) - 0.4) / 0.8) + 1);
  CHECK(sums.virial ==
        doctest::Approx(static_cast<double>(sums.collisions) * 2 * std::sqrt(3.0) * 0.1).epsilon(1e-11));
  CHECK(sums.action == doctest::Approx(1.5 * sums.duration).epsilon(1e-12));
}

TEST_CASE("any number of threads gives the same bytes") {
  for (const bool periodic : {true, false}) {
    const GrowingSpheres start = fluid(14000, 0.2, periodic ? 0.5 : 0.3, periodic, 31); // three zones
    const auto grown = [&](int threads) {
      core::ThreadPool pool(threads);
      GrowingSpheres spheres = start;
      for (int cycle = 0; cycle < 2; ++cycle) {
        spheres.begin_cycle(0.1, 0.05 * spheres.scale(), 1e-7, pool);
        spheres.run(5000, 1, pool);
        spheres.synchronise();
      }
      return spheres.state();
    };
    const auto one = grown(1);
    for (const int threads : {2, 3}) {
      const auto several = grown(threads);
      CHECK(one.sums.collisions == several.sums.collisions);
      CHECK(one.sums.virial == several.sums.virial);
      CHECK(one.energy == several.energy);
      REQUIRE(std::memcmp(one.bodies.data(), several.bodies.data(),
                          one.bodies.size() * sizeof(packing::detail::Body)) == 0);
    }
  }
}

TEST_CASE("the hard-sphere fluid has the pressure of Carnahan and Starling") {
  for (const double density : {0.1, 0.2, 0.3, 0.4, 0.45}) {
    CAPTURE(density);
    GrowingSpheres spheres = fluid(1000, 0, density, true, 21);
    packing::detail::CollisionSums sums;
    std::array<double, 2> near{}; // pairs in two thin shells about contact
    constexpr double thick = 0.02;
    const double d = spheres.scale(), n = 1000;
    double interval = 1e-6;
    for (int cycle = 0; cycle < 12; ++cycle) {
      spheres.begin_cycle(0, 0.2 * d, interval);
      spheres.run(40000, 1);
      spheres.synchronise();
      interval = spheres.sums().duration / static_cast<double>(spheres.sums().events);
      if (cycle < 2) // the first two forget the growth
        continue;
      sums = sums + spheres.sums();
      for (std::size_t i = 0; i < 1000; ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const double r = packing::detail::nearest_image(spheres.centre(i) - spheres.centre(j)).norm() / d;
          if (r < 1 + 2 * thick)
            ++near[r < 1 + thick ? 0 : 1];
        }
    }
    const double x = density, contact = (1 - x / 2) / std::pow(1 - x, 3);
    CHECK(sums.reduced_pressure() ==
          doctest::Approx((1 + x + x * x - x * x * x) / std::pow(1 - x, 3)).epsilon(0.01));
    // Enskog: collisions of a sphere in time, 4 sqrt(pi) n d^2 g(d) sqrt(kT/m), with g from the same equation.
    const double rate = 4 * std::sqrt(std::numbers::pi) * n * d * d * contact;
    CHECK(2 * static_cast<double>(sums.collisions) / n / sums.duration ==
          doctest::Approx(rate).epsilon(0.01));
    // g(r) at the middle of both shells, drawn on in a straight line to contact; some 2,000 to 10,000 pairs.
    const auto g = [&](std::size_t shell) {
      const double inner = 1 + thick * static_cast<double>(shell), outer = inner + thick;
      const double ideal =
          n * n / 2 * 4.0 / 3 * std::numbers::pi * (std::pow(outer, 3) - std::pow(inner, 3)) * d * d * d;
      return near[shell] / 10 / ideal;
    };
    const double pairs = near[0] + near[1];
    CHECK(std::abs(1.5 * g(0) - 0.5 * g(1) - contact) < contact * (0.01 + 4 * 2.3 / std::sqrt(pairs)));
  }
}

TEST_CASE("a watch tells a standstill from slow progress") {
  using packing::detail::StallWatch;
  StallWatch watch;
  double duration = 1;
  for (int cycle = 0; cycle < 100; ++cycle, duration *= 0.7) // gaps that close as they should
    CHECK(watch.judge(duration) == StallWatch::Verdict::advances);
  CHECK(watch.judge(0) == StallWatch::Verdict::hesitates);
  CHECK(watch.judge(duration) == StallWatch::Verdict::advances);
  for (int cycle = 1; cycle < 20; ++cycle)
    CHECK(watch.judge(0) == StallWatch::Verdict::hesitates);
  CHECK(watch.judge(0) == StallWatch::Verdict::stalled);
}
