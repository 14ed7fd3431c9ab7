// What examples/stress_homogeneous makes of a field of stresses: laws that are put in come out.

#include <cdem/core/random.hpp>

#include <doctest/doctest.h>

#include <cmath>

#include "stress_homogeneous/scatter.hpp"

using namespace cdem;
namespace homogeneous = examples::stress_homogeneous;
using homogeneous::Cells;
using stress::tessellation::Hexahedra;

namespace {

const geometry::Box box = geometry::Box::cube(0.01, false);

/// Independent normal stresses xx of mean 1, lowered in the outer layers across each axis.
stress::StressField noise(const Hexahedra& grid, Cells cells, double deviation, double lowered) {
  core::Random random(1);
  const homogeneous::Places places(grid, Axis::x);
  const std::size_t parts = homogeneous::parts_of(cells);
  stress::StressField field;
  for (std::size_t s = 0; s < parts * grid.cell_count(); ++s) {
    Mat3 stress = Mat3::Constant(7);
    stress(0, 0) = 1 + deviation * random.normal();
    for (int axis = 0; axis < 3; ++axis)
      if (places.outermost(s / parts, axis))
        stress(0, 0) -= lowered;
    field.stress.push_back(stress);
    field.volume.push_back(grid.volume(0) / static_cast<double>(parts));
    field.particles.push_back(50 + static_cast<std::uint32_t>(s % 2));
  }
  return field;
}

} // namespace

TEST_CASE("noise and layers at the faces are told apart") {
  const Hexahedra grid(box, {20, 20, 20});
  for (const Cells cells : {Cells::hexahedra, Cells::wedges}) {
    const auto judged = homogeneous::judge(noise(grid, cells, 0.05, 0.1), cells, grid, Axis::x);
    const std::size_t parts = homogeneous::parts_of(cells);
    CHECK(judged.specimens == parts * 8000);
    CHECK(judged.particles == doctest::Approx(50.5));
    REQUIRE(judged.interior);
    CHECK(judged.interior->moments.count == parts * 18 * 18 * 18);
    CHECK(judged.interior->cov() == doctest::Approx(0.05).epsilon(0.03));
    CHECK(judged.interior->normal.p_value > 0.01);
    REQUIRE(judged.thinned);
    CHECK(judged.thinned->moments.count == 9 * 9 * 9);
    // three independent layers, each a tenth of the specimens and lower by 0.1; the mean is 1 - 3 * 0.1 * 0.1
    CHECK(judged.surface == doctest::Approx(std::sqrt(3 * 0.1 * 0.9) * 0.1 / 0.97).epsilon(0.03));
    CHECK(judged.all.cov() ==
          doctest::Approx(std::hypot(judged.surface, judged.interior->cov() / 0.97)).epsilon(0.01));
    CHECK(judged.moment == doctest::Approx(judged.all.moments.mean * box.volume()));
    CHECK(judged.minimum.face != "none"); // a corner or an edge, 2 to 6 deviations below
    CHECK(judged.minimum.stress == judged.all.minimum);
  }
}

TEST_CASE("neighbours: independent ones have no correlation, averages over two have half") {
  const Hexahedra grid(box, {20, 20, 20});
  stress::StressField field = noise(grid, Cells::hexahedra, 0.05, 0);
  const double three_sigma = 3 / std::sqrt(5500.0); // of some 5500 pairs
  const auto independent = homogeneous::judge(field, Cells::hexahedra, grid, Axis::x);
  CHECK(std::abs(independent.along) < three_sigma);
  CHECK(std::abs(independent.across) < three_sigma);
  for (std::size_t h = 0; h + 1 < field.size(); ++h)
    field.stress[h](0, 0) = 0.5 * (field.stress[h](0, 0) + field.stress[h + 1](0, 0));
  const auto smooth = homogeneous::judge(field, Cells::hexahedra, grid, Axis::x);
  CHECK(smooth.along == doctest::Approx(0.5).epsilon(0.1));
  CHECK(std::abs(smooth.across) < three_sigma);
}

TEST_CASE("places: layers, faces, interior") {
  const Hexahedra grid(box, {4, 5, 6});
  const homogeneous::Places places(grid, Axis::y);
  const std::size_t h = grid.index(1, 4, 3);
  CHECK(places.layer(h, 0) == 1);
  CHECK(places.layer(h, 1) == 4);
  CHECK(places.layer(h, 2) == 3);
  CHECK(std::string(places.face(h)) == "loaded");
  CHECK(std::string(places.face(grid.index(0, 0, 0))) == "fixed");
  CHECK(std::string(places.face(grid.index(0, 2, 2))) == "side");
  CHECK(std::string(places.face(grid.index(2, 2, 2))) == "none");
  CHECK(places.interior(grid.index(2, 2, 2)));
  CHECK_FALSE(places.interior(grid.index(2, 2, 5)));
}

TEST_CASE("curves: a power law, where it crosses a level, its two parts") {
  homogeneous::Curve curve;
  for (const double n : {30.0, 100.0, 300.0, 1000.0})
    curve.emplace_back(n, 0.6 / std::sqrt(n));
  const auto law = homogeneous::power_law(curve);
  CHECK(law.exponent == doctest::Approx(-0.5));
  CHECK(law.error < 1e-7);
  CHECK(law.particles_at(0.05) == doctest::Approx(144));
  const auto inside = homogeneous::crossing(curve, 0.05), outside = homogeneous::crossing(curve, 0.2);
  CHECK(inside.interpolated);
  CHECK(inside.particles == doctest::Approx(144)); // straight in the logarithms: exact
  CHECK_FALSE(outside.interpolated);
  CHECK(outside.particles == doctest::Approx(9));
  CHECK(std::isnan(homogeneous::power_law({{10, 0.2}, {20, 0.1}}).error));
  CHECK_THROWS_AS((void)homogeneous::power_law({{10, 0.2}}), core::InvalidInput);
  CHECK_THROWS_AS((void)homogeneous::two_parts({{10, 0.2}}, 1e5), core::InvalidInput);

  // a cube of 10^5 particles, 0.4 mean distances without stress under each face: as in the first test, from counting
  for (auto& [particles, cov] : curve) {
    const double edge = std::cbrt(particles), part = 2 * edge / std::cbrt(1e5), lowered = 0.4 / edge;
    cov = std::sqrt(0.36 / particles + 3 * part * (1 - part) * lowered * lowered);
  }
  const auto parts = homogeneous::two_parts(curve, 1e5);
  CHECK(parts.bulk == doctest::Approx(0.6));
  CHECK(parts.layer == doctest::Approx(0.4));
}

TEST_CASE("a sample too small is none, one with a stress below 0 has no logarithms") {
  CHECK_FALSE(homogeneous::scatter_of({1, 2, 3, 4, 5, 6, 7}));
  const auto mixed = homogeneous::scatter_of({-1, 2, 3, 4, 5, 6, 7, 8});
  REQUIRE(mixed);
  CHECK_FALSE(mixed->lognormal);
  CHECK_FALSE(mixed->likelihood);
  CHECK(mixed->minimum == -1);
}
