#include <cdem/core/parallel.hpp>
#include <cdem/network/bonds.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using core::InvalidInput;
using geometry::Box;
using network::BondNetwork;
using network::bonds_at_coordination;
using network::bonds_within;
using particles::ParticleSet;
using sample::random_spheres;
using sample::same_bytes;
using sample::simple_cubic;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The smallest surface gap of each pair over all the images, by double loop and independently of the
/// library's own nearest-image rule; sorted by (gap, first, second).
struct Gap {
  double gap;
  ParticleIndex first, second;
  Vec3 branch;
};
std::vector<Gap> all_gaps(const ParticleSet& particles, const Box& box) {
  std::vector<Gap> gaps;
  for (std::size_t i = 0; i < particles.size(); ++i)
    for (std::size_t j = i + 1; j < particles.size(); ++j) {
      Gap best{infinity, static_cast<ParticleIndex>(i), static_cast<ParticleIndex>(j), Vec3::Zero()};
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z) {
            const Vec3 shift = box.size().cwiseProduct(
                Vec3(box.periodic[0] ? x : 0, box.periodic[1] ? y : 0, box.periodic[2] ? z : 0));
            const Vec3 branch = particles.position[j] + shift - particles.position[i];
            const double gap = branch.norm() - particles.radius[i] - particles.radius[j];
            if (gap < best.gap) {
              best.gap = gap;
              best.branch = branch;
            }
          }
      gaps.push_back(best);
    }
  std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.gap < b.gap; });
  return gaps;
}

/// Compares a network with the gaps up to a limit that no gap is near.
void check_network(const BondNetwork& network, std::vector<Gap> expected) {
  std::sort(expected.begin(), expected.end(), [](const Gap& a, const Gap& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  REQUIRE(network.size() == expected.size());
  bool same = true;
  double worst = 0;
  for (std::size_t b = 0; b < expected.size(); ++b) {
    same = same && network.first[b] == expected[b].first && network.second[b] == expected[b].second;
    worst = std::max(worst, (network.branch[b] - expected[b].branch).norm());
  }
  CHECK(same);
  CHECK(worst < 1e-14);
  network.validate();
}

std::vector<Box> boxes() {
  Box slab{Vec3(-0.3, 0.2, 0.1), Vec3(0.5, 1.4, 1.1), {true, false, true}};
  return {Box::cube(1, true), Box::cube(1, false), slab, slab.without_periodicity()};
}

template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no InvalidInput thrown";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("bonds within eps*D are those of a double loop over all pairs and images") {
  for (const Box& box : boxes())
    for (const double largest_radius : {0.02, 0.06}) { // equal spheres, and sizes from one to three
      const ParticleSet particles = random_spheres(400, box, 0.02, largest_radius, 7);
      const auto gaps = all_gaps(particles, box);
      for (const std::size_t bonds : {std::size_t{10}, std::size_t{300}, std::size_t{2000}}) {
        const double between = (gaps[bonds - 1].gap + gaps[bonds].gap) / 2;
        const auto network = bonds_within(particles, box, between / std::cbrt(box.volume()));
        check_network(network, {gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(bonds)});
      }
    }
}

TEST_CASE("bonds at a coordination number are the closest pairs, exact to one bond") {
  for (const Box& box : boxes()) {
    const ParticleSet particles = random_spheres(301, box, 0.02, 0.05, 11);
    const auto gaps = all_gaps(particles, box);
    for (const double wanted : {0.01, 1.0, 3.1, 6.2, 9.0}) {
      const auto result = bonds_at_coordination(particles, box, wanted);
      const auto bonds = static_cast<std::size_t>(std::round(wanted * 301 / 2));
      check_network(result.network, {gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(bonds)});
      CHECK(std::abs(result.coordination - wanted) <= 1.0 / 301 + 1e-12); // half a bond
      CHECK(result.eps * std::cbrt(box.volume()) == doctest::Approx(gaps[bonds - 1].gap).epsilon(1e-10));
      CHECK(result.ties == 0);
    }
  }
}

TEST_CASE("the eps found gives the same network again") {
  for (const Box& box : boxes())
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
      const ParticleSet particles = random_spheres(500, box, 0.01, 0.04, seed);
      for (const double wanted : {0.1, 2.0, 6.2}) {
        const auto result = bonds_at_coordination(particles, box, wanted);
        REQUIRE(result.ties == 0);
        CHECK(same_bytes(bonds_within(particles, box, result.eps), result.network));
      }
    }
}

TEST_CASE("eps is negative when fewer bonds are wanted than pairs overlap") {
  const Box box = Box::cube(1, true);
  const ParticleSet particles = random_spheres(400, box, 0.06, 0.07, 3);
  CHECK(bonds_within(particles, box, 0).coordination() > 3);
  const auto result = bonds_at_coordination(particles, box, 1);
  CHECK(result.eps < 0);
  CHECK(result.coordination == 1);
  CHECK(same_bytes(bonds_within(particles, box, result.eps), result.network));
  CHECK(bonds_within(particles, box, -0.5).size() == 0); // no pair overlaps that much
}

TEST_CASE(
    "a simple cubic lattice has six bonds a particle in a periodic box and loses its faces' in an open one") {
  const int edge = 6;
  const ParticleSet particles = simple_cubic(edge);
  const auto periodic = bonds_within(particles, Box::cube(edge, true), 1e-9);
  CHECK(periodic.coordination() == 6);
  for (const Vec3& branch : periodic.branch)
    CHECK(branch.norm() == doctest::Approx(1).epsilon(1e-14));
  const auto open = bonds_within(particles, Box::cube(edge, true).without_periodicity(), 1e-9);
  CHECK(open.size() == 3 * edge * edge * (edge - 1));
}

TEST_CASE("equal gaps are chosen by the particles' numbers, and those left out are counted") {
  const int edge = 5; // coordinates and distances are exact: all the gaps of neighbours are 0
  const ParticleSet particles = simple_cubic(edge);
  const auto all = bonds_within(particles, Box::cube(edge, true), 0);
  REQUIRE(all.size() == 375);
  const auto some = bonds_at_coordination(particles, Box::cube(edge, true), 4);
  CHECK(some.eps == 0);
  CHECK(some.network.size() == 250);
  CHECK(some.ties == 125);
  CHECK(std::equal(some.network.first.begin(), some.network.first.end(), all.first.begin()));
  CHECK(std::equal(some.network.second.begin(), some.network.second.end(), all.second.begin()));
}

TEST_CASE("a box hardly wider than two cutoffs is searched through every face") {
  const Box box = Box::cube(1, true);
  const ParticleSet particles = random_spheres(60, box, 0.05, 0.1, 21);
  const auto gaps = all_gaps(particles, box);
  const double gap = 0.2999; // cutoff up to 0.4999 in a box of 1
  const auto last = std::find_if(gaps.begin(), gaps.end(), [&](const Gap& g) { return g.gap > gap; });
  check_network(bonds_within(particles, box, gap), {gaps.begin(), last});
}

TEST_CASE("particles outside a periodic box count as wrapped into it") {
  const Box box = Box::cube(1, true);
  const ParticleSet inside = random_spheres(200, box, 0.03, 0.05, 5);
  ParticleSet outside = inside;
  for (std::size_t i = 0; i < outside.size(); ++i)
    outside.position[i] += Vec3(static_cast<double>(i % 5) - 2, static_cast<double>(i % 3) - 1, 0);
  const auto a = bonds_within(inside, box, 0.01);
  const auto b = bonds_within(outside, box, 0.01);
  CHECK(a.first == b.first);
  CHECK(a.second == b.second);
}

TEST_CASE("the search is a policy and does not change the bonds") {
  for (const Box& box : boxes()) {
    const ParticleSet particles = random_spheres(150, box, 0.02, 0.06, 13);
    CHECK(same_bytes(bonds_within<sample::BruteForceSearch>(particles, box, 0.02),
                     bonds_within(particles, box, 0.02)));
    CHECK(same_bytes(bonds_at_coordination<sample::BruteForceSearch>(particles, box, 5).network,
                     bonds_at_coordination(particles, box, 5).network));
  }
}

TEST_CASE("any number of threads gives the same bytes") {
  const Box box = Box::cube(1, true);
  const ParticleSet particles = random_spheres(20000, box, 0.005, 0.02, 17);
  core::ThreadPool one(1), two(2), three(3);
  const auto serial = bonds_at_coordination(particles, box, 6.2, one);
  CHECK(same_bytes(bonds_at_coordination(particles, box, 6.2).network, serial.network));
  CHECK(same_bytes(bonds_at_coordination(particles, box, 6.2, two).network, serial.network));
  CHECK(same_bytes(bonds_at_coordination(particles, box, 6.2, three).network, serial.network));
  CHECK(same_bytes(bonds_within(particles, box, 0.001, two), bonds_within(particles, box, 0.001, three)));
}

TEST_CASE("bad input gets one message that names the value and what is accepted") {
  const Box box = Box::cube(1, true);
  const ParticleSet particles = random_spheres(20, box, 0.02, 0.03, 1);
  const auto within = [&](const ParticleSet& p, const Box& b, double eps) {
    return message_of([&] { bonds_within(p, b, eps); });
  };
  const auto at = [&](const ParticleSet& p, const Box& b, double coordination) {
    return message_of([&] { bonds_at_coordination(p, b, coordination); });
  };

  SUBCASE("eps") {
    CHECK(contains(within(particles, box, not_a_number),
                   "eps = nan is not accepted: a finite number is expected"));
    CHECK(contains(within(particles, box, infinity), "eps = inf is not accepted"));
    CHECK(contains(within(particles, box, 0.45),
                   "edge of the periodic box along x = 1 is not accepted: more than"));
    CHECK(within(particles, box.without_periodicity(), 0.45) == "no InvalidInput thrown");
  }
  SUBCASE("coordination number") {
    CHECK(contains(at(particles, box, not_a_number), "coordination number Z = nan is not accepted"));
    CHECK(contains(at(particles, box, infinity), "coordination number Z = inf is not accepted"));
    CHECK(contains(at(particles, box, 0), "coordination number Z = 0 is not accepted"));
    CHECK(contains(at(particles, box, -6.2), "coordination number Z = -6.2 is not accepted"));
    CHECK(contains(at(particles, box, 19.5),
                   "coordination number Z = 19.5 is not accepted: at most 19 is possible"));
    CHECK(contains(at(particles, box, 0.04), "coordination number Z = 0.04 is not accepted: at least 0.05"));
    CHECK(contains(at(particles, box, 19),
                   "is possible with no particle bonded to another through two images"));
    CHECK(bonds_at_coordination(particles, box.without_periodicity(), 19).network.size() == 190);
  }
  SUBCASE("particles") {
    CHECK(contains(within({}, box, 0), "number of particles = 0 is not accepted"));
    CHECK(contains(at({}, box, 6), "number of particles = 0 is not accepted"));
    CHECK(contains(at(random_spheres(1, box, 0.02, 0.03, 1), box, 1),
                   "number of particles = 1 is not accepted: at least 2 are expected"));
    CHECK(bonds_within(random_spheres(1, box, 0.02, 0.03, 1), box, 0).size() == 0);
    ParticleSet bad = particles;
    bad.position[4][1] = not_a_number;
    CHECK(contains(within(bad, box, 0), "position y of particle 4 = nan"));
    bad = particles;
    bad.radius[9] = 0;
    CHECK(contains(at(bad, box, 6), "radius of particle 9 = 0"));
    bad = particles;
    bad.position[17] = bad.position[2];
    CHECK(contains(
        within(bad, box, 0),
        "distance between the centres of particles 2 and 17 = 0 is not accepted: a length above 0 m"));
  }
  SUBCASE("box") {
    CHECK(contains(within(particles, {Vec3::Zero(), Vec3(1, 0, 1), {}}, 0), "edge of the box along y = 0"));
    CHECK(contains(at(particles, {Vec3::Zero(), Vec3(1, 1, -1), {}}, 6), "edge of the box along z = -1"));
    Box narrow{Vec3::Zero(), Vec3(1, 1, 0.1), {true, true, true}}; // diameters up to 0.06
    CHECK(contains(within(particles, narrow, 0), "edge of the periodic box along"));
    CHECK(contains(at(particles, narrow, 1), "edge of the periodic box along"));
  }
}
