// Packings of soft spheres: the jamming point and the way above it, against brute force and the literature.

#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/packing/soft_spheres.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "brute_force.hpp"

namespace {

using namespace cdem;
using packing::Boundary;
using packing::SoftSpheres;
using sample::brute_force;
using sample::BruteForce;
using sample::same_bytes;
using Parameters = SoftSpheres::Parameters;
using Target = SoftSpheres::Target;
using Packed = packing::Packing<SoftSpheres::Report>;

void check_report(const Packed& packed) {
  const auto& [spheres, box, report] = packed;
  const BruteForce found = brute_force(spheres, box);
  CHECK(report.density == doctest::Approx(spheres.solid_volume() / box.volume()).epsilon(1e-12));
  CHECK(report.largest_overlap == doctest::Approx(found.largest_overlap).epsilon(1e-6));
  CHECK(report.mean_overlap == doctest::Approx(found.mean_overlap).epsilon(1e-6));
  CHECK(report.contact_number == doctest::Approx(found.contact_number).epsilon(1e-9));
  CHECK(report.rattlers == found.rattlers);
  CHECK(report.residual == doctest::Approx(found.residual).epsilon(1e-4));
  const double diameter = 2 * spheres.mean_radius();
  CHECK(report.pressure == doctest::Approx(found.virial / 3 / box.volume() * diameter / 2).epsilon(1e-4));
}

std::string rejection(const Parameters& parameters) {
  try {
    SoftSpheres generator(parameters);
    return "";
  } catch (const core::InvalidInput& error) {
    return error.what();
  }
}

} // namespace

TEST_CASE("equal spheres jam near 0.64 with six contacts, in balance") {
  const auto packed =
      SoftSpheres({.particles = 1200, .target = Target::jamming, .cov = 0, .tolerance = 1e-3, .side = 2})
          .pack();
  const auto& report = packed.report;
  CHECK(report.reached());
  CHECK_NOTHROW(report.require_reached());
  CHECK_NOTHROW(packed.particles.validate());
  CHECK(packed.box.periodic == std::array{true, true, true});
  CHECK(report.density > 0.63); // the finite size widens the band: O'Hern et al. (2003), figure 6
  CHECK(report.density < 0.65);
  CHECK(report.density - report.jamming_density > 0);
  CHECK(report.density - report.jamming_density < 3e-4);
  CHECK(report.contact_number == doctest::Approx(6).epsilon(0.01)); // isostatic
  CHECK(report.rattlers < 60);
  CHECK(report.residual < 1e-3);
  CHECK(report.largest_residual >= report.residual);
  CHECK(report.mean_overlap == doctest::Approx(4e-5).epsilon(0.1)); // counted by its real contacts
  CHECK(report.largest_overlap < 1e-3);
  CHECK(report.evaluations > 100);
  CHECK(report.wall_seconds > 0);
  CHECK(report.cov == doctest::Approx(0).epsilon(1e-12));
  check_report(packed);
}

TEST_CASE("above jamming contacts grow as the root of the excess density, pressure in proportion") {
  // O'Hern et al. (2003): Z - 6 = z0 (phi - phi_J)^0.5 with z0 = 7.7 +- 0.5, p in proportion to phi - phi_J.
  struct Mean { // of several packings: z0 of one scatters by a tenth
    double excess = 0, contacts = 0, pressure = 0;
  };
  const auto mean_of = [](Parameters parameters) {
    Mean mean;
    constexpr std::uint64_t seeds = 4;
    for (parameters.seed = 1; parameters.seed <= seeds; ++parameters.seed) {
      parameters.particles = 1000;
      parameters.cov = 0;
      parameters.tolerance = 3e-3;
      const auto report = SoftSpheres(parameters).pack().report;
      CHECK(report.reached());
      const double jammed =
          parameters.target == Target::jamming
              ? report.jamming_density
              : SoftSpheres({.particles = 1000, .target = Target::jamming, .cov = 0, .seed = parameters.seed})
                    .pack()
                    .report.jamming_density;
      mean.excess += (report.density - jammed) / seeds;
      mean.contacts += (report.contact_number - 6) / seeds;
      mean.pressure += report.pressure / seeds;
    }
    return mean;
  };
  const std::array means{mean_of({.target = Target::jamming, .jamming_overlap = 1e-3}),
                         mean_of({.target = Target::jamming, .jamming_overlap = 3e-4}),
                         mean_of({.density = 0.68})};
  for (const Mean& mean : means) {
    CAPTURE(mean.excess);
    CHECK(mean.contacts / std::sqrt(mean.excess) > 6.2);
    CHECK(mean.contacts / std::sqrt(mean.excess) < 9.2);
    CHECK(mean.pressure / mean.excess > 0.3);
    CHECK(mean.pressure / mean.excess < 0.6);
  }
  const double exponent =
      std::log(means[2].contacts / means[1].contacts) / std::log(means[2].excess / means[1].excess);
  CHECK(exponent == doctest::Approx(0.5).epsilon(0.1));
}

TEST_CASE("a density below jamming is reached exactly and without overlap, whatever the sizes and walls") {
  for (const auto boundary : {Boundary::periodic, Boundary::walls})
    for (const double cov : {0.0, 0.3}) {
      const auto packed =
          SoftSpheres({.particles = 500, .density = 0.57, .cov = cov, .side = 0.02, .boundary = boundary})
              .pack();
      CAPTURE(cov);
      CHECK(packed.report.reached());
      CHECK(packed.report.density == doctest::Approx(0.57).epsilon(1e-12));
      CHECK(packed.particles.solid_volume() / packed.box.volume() == doctest::Approx(0.57).epsilon(1e-12));
      CHECK(packed.report.jamming_density > 0.57);
      CHECK(packed.report.largest_overlap == 0);
      CHECK(brute_force(packed.particles, packed.box).contacts == 0);
      CHECK(packed.report.mean_radius == doctest::Approx(packed.particles.mean_radius()));
      CHECK(packed.report.cov == doctest::Approx(0.98 * cov).epsilon(0.1)); // three standard errors
    }
}

TEST_CASE("walls hold: forces balance with theirs, and the report counts them") {
  const auto packed = SoftSpheres({.particles = 600,
                                   .target = Target::jamming,
                                   .cov = 0.1,
                                   .jamming_overlap = 1e-3,
                                   .tolerance = 1e-3,
                                   .boundary = Boundary::walls})
                          .pack();
  CHECK(packed.report.reached());
  CHECK(packed.box.periodic == std::array{false, false, false});
  CHECK(packed.report.density < 0.63); // looser than without walls
  check_report(packed);
}

TEST_CASE("a contact number is reached") {
  const auto packed = SoftSpheres({.particles = 1000,
                                   .target = Target::contact_number,
                                   .contact_number = 6.6,
                                   .cov = 0.1,
                                   .tolerance = 3e-3})
                          .pack();
  CHECK(packed.report.reached());
  CHECK(std::abs(brute_force(packed.particles, packed.box).contact_number - 6.6) <= 0.01 + 1e-12);
  CHECK(packed.report.density > packed.report.jamming_density);
  check_report(packed);
}

TEST_CASE("sizes that differ tenfold pack") {
  const auto packed =
      SoftSpheres(
          {.particles = 1500, .target = Target::jamming, .cov = 0.5, .smallest_radius = 0.2, .side = 1})
          .pack();
  const auto& radius = packed.particles.radius;
  CHECK(*std::max_element(radius.begin(), radius.end()) / *std::min_element(radius.begin(), radius.end()) >
        9);
  CHECK(packed.report.reached());
  CHECK(packed.report.density > 0.65); // denser than equal spheres
  CHECK(packed.report.density < 0.74);
  CHECK(packed.report.contact_number == doctest::Approx(6).epsilon(0.02));
}

TEST_CASE("neighbours stand as in a packing of hard spheres") {
  // Mean number of neighbours within multiples of the diameter at 0.62, the radial distribution function summed up.
  const auto soft = SoftSpheres({.particles = 1500, .density = 0.62, .cov = 0, .seed = 2}).pack();
  const auto hard = packing::LubachevskyStillinger(
                        {.particles = 1500, .density = 0.62, .cov = 0, .growth_rate = 0.03, .seed = 2})
                        .pack();
  const auto neighbours = [](const particles::ParticleSet& spheres, const geometry::Box& box, double reach) {
    double count = 0;
    for (std::size_t i = 0; i < spheres.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        count += box.minimum_image(spheres.position[i] - spheres.position[j]).norm() <
                 reach * 2 * spheres.radius[0];
    return 2 * count / static_cast<double>(spheres.size());
  };
  for (const double reach : {1.2, 1.4, 1.8, 2.2}) {
    CAPTURE(reach);
    CHECK(neighbours(soft.particles, soft.box, reach) ==
          doctest::Approx(neighbours(hard.particles, hard.box, reach)).epsilon(0.05));
  }
}

TEST_CASE("the same seed gives the same bytes for any number of threads, another seed gives others") {
  Parameters parameters{.particles = 3000, .density = 0.68, .cov = 0.1, .tolerance = 0.05};
  const SoftSpheres generator(parameters);
  const auto first = generator.pack();
  CHECK(same_bytes(first.particles, generator.pack().particles)); // packing leaves no trace in the generator
  parameters.threads = 3;
  CHECK(same_bytes(first.particles, SoftSpheres(parameters).pack().particles));
  parameters.seed = 2;
  CHECK_FALSE(same_bytes(first.particles, SoftSpheres(parameters).pack().particles));
}

TEST_CASE("one sphere and few spheres") {
  const auto single =
      SoftSpheres({.particles = 1, .target = Target::jamming, .cov = 0, .boundary = Boundary::walls}).pack();
  CHECK(single.report.density == doctest::Approx(std::acos(-1) / 6).epsilon(0.01)); // held by six walls
  const auto few = SoftSpheres({.particles = 40, .density = 0.5, .cov = 0}).pack();
  CHECK(few.report.reached());
  CHECK(brute_force(few.particles, few.box).contacts == 0);
}

TEST_CASE("a run that may not go on long enough says so") {
  const auto packed = SoftSpheres({.particles = 500, .most_evaluations = 50}).pack();
  CHECK_FALSE(packed.report.reached());
  CHECK(packed.report.evaluations <= 51);
  try {
    packed.report.require_reached();
    FAIL("must throw");
  } catch (const core::NotReached& error) {
    const std::string message = error.what();
    CHECK(message.find("density 0.64 was not reached: density ") == 0);
    CHECK(message.find("contact number ") != std::string::npos);
    CHECK(message.find("more evaluations") != std::string::npos);
  }
}

TEST_CASE("a run that is asked to stop is interrupted, and progress ends at one") {
  std::atomic<bool> stop{true};
  const core::Monitor stopping([](const core::Progress&) {}, &stop);
  CHECK_THROWS_AS(SoftSpheres({.particles = 500}).pack(stopping), core::Interrupted);

  std::vector<double> fractions;
  std::string detail;
  const core::Monitor listening([&](const core::Progress& progress) {
    fractions.push_back(progress.fraction);
    detail = progress.detail;
    CHECK(progress.stage == "packing");
  });
  SoftSpheres({.particles = 1000, .density = 0.6, .tolerance = 0.05}).pack(listening);
  REQUIRE_FALSE(fractions.empty());
  CHECK(std::is_sorted(fractions.begin(), fractions.end()));
  CHECK(fractions.front() >= 0);
  CHECK(fractions.back() == 1);
  CHECK(detail.find("overlap ") != std::string::npos);
}

TEST_CASE("every bad parameter is named") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  CHECK(rejection({}) == "");
  CHECK(rejection({.particles = 0}) == "number of particles = 0 is not accepted: 1 to 100000000 is expected");
  CHECK(rejection({.target = static_cast<Target>(9)}) ==
        "target = 9 is not accepted: jamming, density or contact_number is expected");
  for (const double bad : {nan, -0.1, 0.0, 1.0, infinity})
    CHECK(rejection({.density = bad}) ==
          "density = " + core::to_text(bad) + " is not accepted: above 0 and below 1 is expected");
  for (const double bad : {nan, 5.9, 6.0, 10.1})
    CHECK(rejection({.contact_number = bad}).find("contact number = ") == 0);
  for (const double bad : {nan, -0.1, 0.51, infinity})
    CHECK(rejection({.cov = bad}).find("CoV of the radii = ") == 0);
  for (const double bad : {nan, 0.9, 6.1})
    CHECK(rejection({.truncation = bad}).find("truncation = ") == 0);
  for (const double bad : {nan, 0.0, 0.95})
    CHECK(rejection({.smallest_radius = bad}).find("smallest radius over the mean = ") == 0);
  for (const double bad : {nan, 0.0, 0.2})
    CHECK(rejection({.compression = bad}).find("compression = ") == 0);
  for (const double bad : {nan, 0.0, 0.01})
    CHECK(rejection({.jamming_overlap = bad}).find("overlap at the jamming point = ") == 0);
  for (const double bad : {nan, 0.0, 0.2})
    CHECK(rejection({.tolerance = bad}).find("tolerance = ") == 0);
  CHECK(rejection({.most_evaluations = 0}).find("most evaluations = 0") == 0);
  for (const double bad : {nan, 0.0, -1.0, infinity})
    CHECK(rejection({.side = bad}).find("side of the cube = ") == 0);
  CHECK(rejection({.boundary = static_cast<Boundary>(7)}) ==
        "boundary = 7 is not accepted: periodic or walls is expected");
  CHECK(rejection({.threads = -1}) == "threads = -1 is not accepted: 0 (all processors) to 4096 is expected");
  CHECK(rejection({.particles = 10, .cov = 0})
            .find("number of particles = 10 is not accepted: more are expected") == 0);
}
