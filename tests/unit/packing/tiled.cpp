#include <cdem/packing/lattice.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/packing/quality.hpp>
#include <cdem/packing/tiled.hpp>

#include <doctest/doctest.h>

using namespace cdem;
using packing::Lattice;
using packing::LubachevskyStillinger;
using packing::Tiled;

static_assert(packing::PackingGenerator<Tiled<Lattice>>);
static_assert(packing::PackingGenerator<Tiled<LubachevskyStillinger>>);
static_assert(packing::PackingGenerator<Tiled<Tiled<Lattice>>>);

TEST_CASE("a crystal repeated is the larger crystal") {
  const auto tiled = Tiled<Lattice>({.base = {.cells = {2, 3, 1}}, .copies = 3}).pack();
  const auto whole = Lattice({.cells = {6, 9, 3}}).pack();
  CHECK((tiled.box.upper - whole.box.upper).norm() < 1e-15);
  CHECK(tiled.box.periodic == whole.box.periodic);
  CHECK(tiled.report.density == doctest::Approx(whole.report.density));
  REQUIRE(tiled.particles.size() == whole.particles.size());
  auto a = tiled.particles.position, b = whole.particles.position;
  const auto before = [](const Vec3& p, const Vec3& q) {
    for (int k = 0; k < 3; ++k)
      if (std::abs(p[k] - q[k]) > 1e-12)
        return p[k] < q[k];
    return false;
  };
  std::sort(a.begin(), a.end(), before);
  std::sort(b.begin(), b.end(), before);
  for (std::size_t i = 0; i < a.size(); ++i)
    REQUIRE((a[i] - b[i]).norm() < 1e-15);
}

TEST_CASE("a random packing repeated keeps what pairs say of it, and adds no long waves") {
  LubachevskyStillinger::Parameters base{.particles = 400, .density = 0.58, .cov = 0.2};
  const auto one = LubachevskyStillinger(base).pack();
  const auto eight = Tiled<LubachevskyStillinger>({.base = base, .copies = 2}).pack();
  REQUIRE(eight.particles.size() == 3200);
  CHECK(eight.report.density == one.report.density);
  CHECK(eight.report.base.collisions == one.report.collisions);
  for (std::size_t i = 0; i < 3200; ++i)
    REQUIRE(eight.particles.radius[i] == one.particles.radius[i % 400]);

  const packing::QualityParameters looked{.pair_range = 2.5, .wave_number = 2};
  const auto small = packing::quality(one.particles, one.box, looked);
  const auto large = packing::quality(eight.particles, eight.box, looked);
  CHECK(large.density == doctest::Approx(small.density).epsilon(1e-12));
  CHECK(large.rattlers == 8 * small.rattlers);
  CHECK(large.eps == doctest::Approx(small.eps / 2).epsilon(1e-9)); // the same gap over twice the side
  for (std::size_t k = 0; k < 3; ++k) // eight times the bonds, and no smaller anisotropy
    CHECK(large.anisotropy.deviation[k] == doctest::Approx(small.anisotropy.deviation[k]).epsilon(1e-6));
  CHECK(large.structure_factor[0] < 1e-20); // odd multiples of 2 pi over the new side alone ...
  CHECK(small.structure_factor[0] > 1e-3);  // ... where the copy has waves of its own
  CHECK(large.pair_correlation.size() == small.pair_correlation.size());
}

TEST_CASE("what cannot be repeated is refused by name") {
  CHECK_THROWS_WITH_AS(Tiled<Lattice>({.base = {.periodic = false}}).pack(),
                       doctest::Contains("box along x = walled"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(Tiled<Lattice>({.copies = 0}), doctest::Contains("copies = 0"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(Tiled<Lattice>({.base = {.cells = {0, 1, 1}}}), doctest::Contains("cells along x"),
                       core::InvalidInput);
  const auto crystal = Lattice({.cells = {8, 8, 8}}).pack(); // 2048 spheres
  CHECK_THROWS_WITH_AS(packing::tile(crystal.particles, crystal.box, 0), doctest::Contains("copies = 0"),
                       core::InvalidInput);
  CHECK_THROWS_WITH_AS(packing::tile(crystal.particles, crystal.box, 1500),
                       doctest::Contains("copies = 1500"), core::InvalidInput);
}
