#include <cdem/packing/lattice.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>

using namespace cdem;
using packing::Lattice;
using packing::LatticeKind;

namespace {

/// Neighbours of each sphere by distance over the diameter, in steps of 1e-6: the same map for all, or a failure.
std::map<long, int> shells(const packing::Packing<Lattice::Report>& crystal, double reach) {
  std::map<long, int> common;
  for (std::size_t i = 0; i < crystal.particles.size(); ++i) {
    std::map<long, int> own;
    for (std::size_t j = 0; j < crystal.particles.size(); ++j) {
      const double r =
          crystal.box.minimum_image(crystal.particles.position[j] - crystal.particles.position[i]).norm() /
          (2 * crystal.particles.radius[i]);
      if (i != j && r < reach)
        ++own[std::lround(1e6 * r)];
    }
    if (i == 0)
      common = own;
    REQUIRE(own == common);
  }
  return common;
}

long at(double squared) {
  return std::lround(1e6 * std::sqrt(squared));
}

} // namespace

TEST_CASE("each crystal has the neighbour shells and the density of the textbooks") {
  const auto crystal = [](LatticeKind kind) { return Lattice({.kind = kind, .cells = {5, 4, 4}}).pack(); };
  const double pi = std::numbers::pi;
  const auto sc = crystal(LatticeKind::simple_cubic), bcc = crystal(LatticeKind::body_centred_cubic),
             fcc = crystal(LatticeKind::face_centred_cubic),
             hcp = crystal(LatticeKind::hexagonal_close_packed);
  CHECK(shells(sc, 1.8) == std::map<long, int>{{at(1), 6}, {at(2), 12}, {at(3), 8}});
  CHECK(shells(bcc, 1.95) ==
        std::map<long, int>{{at(1), 8}, {at(4. / 3), 6}, {at(8. / 3), 12}, {at(11. / 3), 24}});
  CHECK(shells(fcc, 1.8) == std::map<long, int>{{at(1), 12}, {at(2), 6}, {at(3), 24}});
  CHECK(shells(hcp, 1.8) == std::map<long, int>{{at(1), 12}, {at(2), 6}, {at(8. / 3), 2}, {at(3), 18}});
  CHECK(sc.report.density == doctest::Approx(pi / 6).epsilon(1e-14));
  CHECK(bcc.report.density == doctest::Approx(pi * std::sqrt(3.0) / 8).epsilon(1e-14));
  CHECK(fcc.report.density == doctest::Approx(pi / std::sqrt(18.0)).epsilon(1e-14));
  CHECK(hcp.report.density == doctest::Approx(pi / std::sqrt(18.0)).epsilon(1e-14));
}

TEST_CASE("cells, radius, spacing and periodicity are those asked for") {
  const auto crystal = Lattice({.kind = LatticeKind::simple_cubic,
                                .cells = {2, 3, 5},
                                .radius = 2e-3,
                                .spacing = 1.5,
                                .periodic = false})
                           .pack();
  CHECK(crystal.particles.size() == 30);
  CHECK((crystal.box.upper - 6e-3 * Vec3(2, 3, 5)).norm() < 1e-15);
  CHECK(crystal.box.periodic == std::array<bool, 3>{false, false, false});
  for (std::size_t i = 0; i < 30; ++i) {
    CHECK(crystal.particles.radius[i] == 2e-3);
    CHECK(crystal.particles.position[i].minCoeff() > 0);
    CHECK((crystal.box.upper - crystal.particles.position[i]).minCoeff() > 0);
  }
}

TEST_CASE("bad parameters of a lattice are refused by name") {
  const auto refuse = [](Lattice::Parameters parameters, const char* what) {
    CHECK_THROWS_WITH_AS(Lattice{parameters}, doctest::Contains(what), core::InvalidInput);
  };
  refuse({.kind = static_cast<LatticeKind>(9)}, "kind of lattice = 9");
  refuse({.cells = {1, 0, 1}}, "cells along y = 0");
  refuse({.cells = {2000, 2000, 2000}}, "number of particles");
  refuse({.radius = 0}, "radius of the spheres = 0");
  refuse({.spacing = std::numeric_limits<double>::quiet_NaN()}, "spacing = nan");
}
