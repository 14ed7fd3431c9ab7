// Soft spheres: forces against the energy, lists against all pairs, equilibria that are known.

#include <cdem/packing/detail/random_start.hpp>
#include <cdem/packing/detail/soft_contacts.hpp>
#include <cdem/packing/detail/soft_system.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>
#include <vector>

namespace {

using namespace cdem;
using packing::detail::Quad;
using packing::detail::SoftContacts;
using packing::detail::SoftKernels;
using packing::detail::SoftSystem;

/// Spheres anywhere in the unit cube (overlapping as they like), sizes within `spread` of one half.
std::vector<Quad> random_spheres(std::size_t count, double spread, std::uint64_t seed) {
  core::Random random(seed);
  std::vector<Quad> spheres(count);
  for (Quad& sphere : spheres)
    sphere = {
        {random.uniform(), random.uniform(), random.uniform(), 0.5 * random.uniform(1 - spread, 1 + spread)}};
  return spheres;
}

double distance(const Quad& a, const Quad& b, bool periodic) {
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    double d = a[k] - b[k];
    if (periodic)
      d -= std::round(d);
    square += d * d;
  }
  return std::sqrt(square);
}

/// The energy by its definition, over all pairs and walls.
double energy(const std::vector<Quad>& spheres, double scale, bool periodic) {
  double sum = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double d = scale * (spheres[i][3] + spheres[j][3]),
                   r = distance(spheres[i], spheres[j], periodic);
      if (r < d)
        sum += d * d / 4 * std::pow(1 - r * r / (d * d), 2);
    }
    for (int k = 0; k < 3 && !periodic; ++k)
      for (const double height : {spheres[i][k], 1 - spheres[i][k]})
        sum += std::pow(std::max(0.0, scale * spheres[i][3] - height), 2);
  }
  return sum;
}

bool same_bytes(const std::vector<Quad>& a, const std::vector<Quad>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Quad)) == 0;
}

/// Four spheres a cell on a face-centred cubic lattice of edge^3 cells, shaken by `noise` of a cell.
std::vector<Quad> face_centred(int edge, double noise) {
  core::Random random(5);
  std::vector<Quad> spheres;
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      for (int z = 0; z < edge; ++z)
        for (const auto& [a, b, c] : {std::array{0.0, 0.0, 0.0}, std::array{0.5, 0.5, 0.0},
                                      std::array{0.5, 0.0, 0.5}, std::array{0.0, 0.5, 0.5}}) {
          const auto place = [&](int cell, double offset) {
            return (cell + offset + 0.25 + random.uniform(-noise, noise)) / edge;
          };
          const double px = place(x, a), py = place(y, b), pz = place(z, c);
          spheres.push_back({{px, py, pz, 0.5}});
        }
  return spheres;
}

} // namespace

TEST_CASE("forces and the work of swelling are the slopes of the energy, periodic and between walls") {
  core::ThreadPool pool;
  for (const bool periodic : {true, false}) {
    const double scale = 0.25, h = 1e-6;
    SoftSystem system(random_spheres(60, 0.5, 1), scale, periodic, pool);
    system.evaluate();
    std::vector<Quad> moved = system.spheres();
    CHECK(energy(moved, scale, periodic) > 0.01);
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < moved.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const double x = moved[i][k];
        moved[i][k] = x + h;
        const double above = energy(moved, scale, periodic);
        moved[i][k] = x - h;
        const double below = energy(moved, scale, periodic);
        moved[i][k] = x;
        const double force = system.forces()[i][k];
        worst = std::max(worst, std::abs(force + (above - below) / (2 * h)));
        largest = std::max(largest, std::abs(force));
      }
    CHECK(worst < 1e-7 * largest);
    const double slope =
        (energy(moved, scale * (1 + h), periodic) - energy(moved, scale * (1 - h), periodic)) / (2 * h);
    CHECK(system.sums().force[3] == doctest::Approx(slope).epsilon(1e-7));
    CHECK(survey_soft_contacts(system, pool).energy ==
          doctest::Approx(energy(moved, scale, periodic)).epsilon(1e-12));
  }
}

TEST_CASE("lists never lose a contact while spheres move and swell") {
  core::ThreadPool pool;
  for (const bool periodic : {true, false})
    for (const double spread : {0.0, 0.8}) {
      const std::size_t count = 300;
      auto spheres = random_spheres(count, spread, 7);
      SoftSystem system(spheres, 0.12, periodic, pool);
      system.fix_overlap(0.02);
      for (int step = 0; step < 60; ++step) {
        system.evaluate();
        if (step % 6 == 0) {
          const std::vector<Quad>& now = system.spheres();
          CAPTURE(step);
          CHECK(survey_soft_contacts(system, pool).energy ==
                doctest::Approx(energy(now, system.scale(), periodic)).epsilon(1e-12));
          bool same_size = true; // each is still the sphere it says it is
          for (std::size_t i = 0; i < count; ++i)
            same_size &= now[i][3] == spheres[system.identity()[i]][3];
          CHECK(same_size);
        }
        system.advance();
      }
    }
}

TEST_CASE("action is reaction: a periodic system's forces add up to nothing") {
  core::ThreadPool pool;
  SoftSystem system(random_spheres(2000, 0.3, 3), 0.08, true, pool);
  system.evaluate();
  for (int k = 0; k < 3; ++k)
    CHECK(std::abs(system.sums().force[k]) < 1e-12 * std::sqrt(system.sums().squares[k]));
}

TEST_CASE("it does not matter where a periodic system is cut") {
  // Blocks inside the cube are searched and pushed without regard to the faces; moved by half a cube, others are.
  core::ThreadPool pool(2);
  const double scale = 0.023;
  auto spheres = random_spheres(60000, 0.3, 13);
  SoftSystem system(spheres, scale, true, pool);
  for (Quad& sphere : spheres)
    for (int k = 0; k < 3; ++k)
      sphere[k] += sphere[k] < 0.5 ? 0.5 : -0.5;
  SoftSystem shifted(spheres, scale, true, pool);
  std::size_t wrapping = 0;
  for (int step = 0; step < 5; ++step) {
    for (SoftSystem* each : {&system, &shifted}) {
      each->evaluate();
      if (step < 4)
        each->advance();
    }
    for (int k = 0; k < 4; ++k)
      CHECK(shifted.sums().squares[k] == doctest::Approx(system.sums().squares[k]).epsilon(1e-9));
    CHECK(shifted.sums().force[3] == doctest::Approx(system.sums().force[3]).epsilon(1e-9));
  }
  for (std::size_t block = 0; block < system.lists().blocks(); ++block)
    wrapping += system.lists().block(block, system.spheres(), scale, false).wraps ? 1U : 0U;
  CHECK(wrapping > 0);
  CHECK(wrapping < system.lists().blocks());
}

TEST_CASE("any processor and any number of threads give the same bytes") {
  const auto spheres = random_spheres(5000, 0.4, 11); // five blocks
  for (const bool periodic : {true, false}) {
    std::vector<std::vector<Quad>> ends;
    for (const auto& [threads, kernels] :
         {std::pair{1, SoftKernels::fastest()}, std::pair{3, SoftKernels::fastest()},
          std::pair{2, SoftKernels::anywhere()}}) {
      core::ThreadPool pool(threads);
      SoftSystem system(spheres, 0.06, periodic, pool, kernels);
      system.fix_overlap(0.02);
      for (int step = 0; step < 40; ++step) {
        system.evaluate();
        system.advance();
      }
      ends.push_back(system.spheres());
    }
    CHECK(same_bytes(ends[0], ends[1]));
#ifndef __FMA__ // the compiler may then fuse what is not compiled for AVX2 alone
    CHECK(same_bytes(ends[0], ends[2]));
#endif
  }
}

TEST_CASE("two overlapping spheres come to rest where they no longer do") {
  core::ThreadPool pool;
  SoftSystem system({{{0.98, 0.5, 0.5, 0.5}}, {{0.05, 0.5, 0.5, 0.5}}}, 0.2, true, pool); // through the face
  system.fix_scale(0.2);
  for (int step = 0; step < 500; ++step) {
    system.evaluate();
    system.advance();
  }
  system.evaluate();
  CHECK(distance(system.spheres()[0], system.spheres()[1], true) >= 0.2 * (1 - 1e-6));
}

TEST_CASE("a compressed crystal finds its twelve contacts, its pressure and its energy") {
  core::ThreadPool pool(2);
  const int edge = 4;
  const double spacing = std::sqrt(0.5) / edge, overlap = 0.02, diameter = spacing / (1 - overlap);
  SoftSystem system(face_centred(edge, 0.03), diameter, true, pool);
  system.fix_scale(diameter);
  for (int step = 0; step < 2000; ++step) {
    system.evaluate();
    system.advance();
  }
  system.evaluate();
  const SoftContacts contacts = survey_soft_contacts(system, pool);
  const double count = 4.0 * edge * edge * edge;
  CHECK(contacts.contacts == 6 * static_cast<std::uint64_t>(count));
  CHECK(contacts.contact_number == 12);
  CHECK(contacts.rattlers == 0);
  CHECK(contacts.mean_overlap == doctest::Approx(overlap).epsilon(1e-8));
  CHECK(contacts.largest_overlap == doctest::Approx(overlap).epsilon(1e-6));
  CHECK(contacts.residual < 1e-8);
  const double squash = 1 - std::pow(1 - overlap, 2); // 1 - r^2/D^2
  CHECK(contacts.energy ==
        doctest::Approx(6 * count * diameter * diameter / 4 * squash * squash).epsilon(1e-8));
  // P = -dE/dV at a fixed diameter: E as a function of the spacing, whose cube goes with the volume.
  const auto energy_at = [&](double r) {
    return 6 * count * diameter * diameter / 4 * std::pow(1 - r * r / (diameter * diameter), 2);
  };
  const double h = 1e-5;
  const double slope = (energy_at(spacing * (1 + h)) - energy_at(spacing * (1 - h))) / (2 * h); // dE/d(ln r)
  CHECK(contacts.virial / 3 == doctest::Approx(-slope / 3).epsilon(1e-6));                      // V = 1
}

TEST_CASE("a free scale tends to the wanted overlap") {
  core::ThreadPool pool;
  const int edge = 3;
  SoftSystem system(face_centred(edge, 0.03), 0.9 * std::sqrt(0.5) / edge, true, pool);
  system.fix_overlap(0.01);
  for (int step = 0; step < 3000; ++step) {
    system.evaluate();
    system.advance();
  }
  system.evaluate();
  CHECK(system.overlap() == doctest::Approx(0.01).epsilon(1e-8));
  // dE/d(ln D) = 6 N D^2 (1 - u^2)/2 with u = r^2/D^2, and that is 6 N D^2 times the overlap asked for.
  const double u = std::sqrt(1 - 2 * 0.01);
  CHECK(system.scale() == doctest::Approx(std::sqrt(0.5 / u) / edge).epsilon(1e-8));
}
