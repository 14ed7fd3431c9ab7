#include <cdem/core/random.hpp>
#include <cdem/packing/lattice.hpp>
#include <cdem/packing/quality.hpp>

#include <doctest/doctest.h>

#include <complex>
#include <limits>

using namespace cdem;
using packing::Lattice;
using packing::LatticeKind;
using packing::Quality;
using packing::quality;

namespace {

/// Independent points with radii from `smallest` to `largest`, m, in a box.
particles::ParticleSet gas(std::size_t count, const geometry::Box& box, double smallest, double largest) {
  core::Random random(11);
  particles::ParticleSet spheres;
  spheres.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k)
      spheres.position[i][k] = random.uniform(box.lower[k], box.upper[k]);
    spheres.radius[i] = random.uniform(smallest, largest);
  }
  return spheres;
}

/// Neighbours of a sphere in the class of g(r) that holds distance r (in diameters).
double neighbours(const Quality& q, double r) {
  const double width = q.distance[1], diameter = 2 * q.radius.mean;
  const auto c = static_cast<std::size_t>(std::lround(r * diameter / width));
  const auto cube = [&](double edge) { return std::pow(std::max(edge, 0.0) * width, 3); };
  const double volume =
      4 * std::numbers::pi / 3 * (cube(static_cast<double>(c) + 0.5) - cube(static_cast<double>(c) - 0.5));
  const auto count = static_cast<double>(q.particles);
  return q.pair_correlation[c] * volume * q.number_density * (count - 1) / count;
}

} // namespace

TEST_CASE("crystals have their exact contacts, shells and no long waves") {
  struct Crystal {
    LatticeKind kind;
    std::uint32_t contacts;
    std::vector<std::pair<double, double>> shells; ///< squared distance, neighbours
  };
  const std::vector<Crystal> crystals{
      {LatticeKind::simple_cubic, 6, {{1, 6}, {2, 12}, {3, 8}, {4, 6}, {5, 24}}},
      {LatticeKind::body_centred_cubic, 8, {{1, 8}, {4. / 3, 6}, {8. / 3, 12}, {11. / 3, 24}, {4, 8}}},
      {LatticeKind::face_centred_cubic, 12, {{1, 12}, {2, 6}, {3, 24}, {4, 12}, {5, 24}}},
      {LatticeKind::hexagonal_close_packed,
       12,
       {{1, 12}, {2, 6}, {8. / 3, 2}, {3, 18}, {11. / 3, 12}, {4, 6}}}};
  core::ThreadPool pool(2);
  for (const Crystal& crystal : crystals) {
    CAPTURE(static_cast<int>(crystal.kind));
    const auto made = Lattice({.kind = crystal.kind, .cells = {6, 7, 6}}).pack();
    const Quality q = quality(made.particles, made.box, {.pair_range = 2.5, .wave_number = 4}, pool);
    CHECK(q.density == doctest::Approx(made.report.density));
    CHECK(q.radius.cov() == 0);
    CHECK(q.rattlers == 0);
    CHECK(q.contact_number == crystal.contacts);
    CHECK(q.backbone_number == crystal.contacts);
    REQUIRE(q.contacts_histogram.size() == crystal.contacts + 1);
    CHECK(q.contacts_histogram.back() == q.particles);
    CHECK(q.largest_overlap < 1e-12);
    for (const auto& shell : crystal.shells) {
      CAPTURE(shell.first);
      CHECK(neighbours(q, std::sqrt(shell.first)) == doctest::Approx(shell.second).epsilon(1e-9));
    }
    CHECK(neighbours(q, 0.9) == 0);
    CHECK(neighbours(q, 1.1) == 0);
    for (const double s : q.structure_factor)
      CHECK(s < 1e-20);
    // Z jumps at contact, then at the second shell: sqrt(2) d is a gap of 0.41 d, beyond the curve
    CHECK(q.gap_coordination.front() == crystal.contacts);
  }
}

TEST_CASE("independent points: g = 1 in every class, periodic or between walls, and S = 1") {
  for (const auto& periodic :
       {std::array{true, true, true}, std::array{false, false, false}, std::array{true, false, true}}) {
    CAPTURE(periodic[0]);
    CAPTURE(periodic[1]);
    const geometry::Box box{Vec3(-1, 0, 2), Vec3(0, 1.5, 3.2), periodic};
    const auto points = gas(20000, box, 0.01, 0.03);
    core::ThreadPool pool(2);
    const Quality q = quality(points, box, {.pair_range = 8, .pair_class = 0.25}, pool);
    CHECK(q.distance.back() > 0.29); // far enough for walls to matter
    double inner = 0, sum = 0;
    for (std::size_t c = 0; c < q.distance.size(); ++c) {
      // pairs in a class are as good as Poisson distributed: the scatter of g is 1/sqrt(pairs)
      const double outer = std::pow(q.distance[c] + q.distance[1] / 2, 3);
      const double pairs = 20000.0 * q.number_density * 2 / 3 * std::numbers::pi * (outer - inner);
      inner = outer;
      CHECK(std::abs(q.pair_correlation[c] - 1) < 5 / std::sqrt(0.8 * pairs));
      sum += (q.pair_correlation[c] - 1) / static_cast<double>(q.distance.size());
    }
    CHECK(std::abs(sum) < 0.01);
    for (std::size_t k = 0; k < 3; ++k) // E_k / chance follows chi / sqrt(31): 0.13 scatter
      CHECK(q.anisotropy.deviation[k] / q.isotropic_deviation == doctest::Approx(1).epsilon(0.5));
    CHECK(q.coordination == doctest::Approx(6.2).epsilon(1e-4));
    if (!(periodic[0] && periodic[1])) {
      CHECK(q.structure_factor.empty());
      continue;
    }
    for (const auto& factor : {q.structure_factor, q.volume_structure_factor})
      for (std::size_t c = 0; c < factor.size(); ++c) // the mean of exponentially distributed numbers
        CHECK(std::abs(factor[c] - 1) < 4.5 / std::sqrt(q.wave_vectors[c]));
  }
}

/// Compares with all pairs one by one; y is between walls 1.1 apart.
void compare_with_brute_force(const geometry::Box& box) {
  const auto spheres = gas(700, box, 0.02, 0.06);
  const packing::QualityParameters looked{
      .contact_tolerance = 0.05, .eps = {-0.03, 0.001, 0.02}, .pair_range = 3};
  core::ThreadPool three(3);
  const Quality q = quality(spheres, box, looked, three);

  const double side = std::cbrt(box.volume()), width = 0.02 * 2 * q.radius.mean;
  std::vector<double> within(3, 0), distance(q.distance.size(), 0);
  std::vector<int> contacts(700, 0);
  double overlap = 0;
  for (std::size_t i = 0; i < 700; ++i) {
    for (std::size_t j = i + 1; j < 700; ++j) {
      const double r = box.minimum_image(spheres.position[j] - spheres.position[i]).norm();
      const double sum = spheres.radius[i] + spheres.radius[j];
      for (std::size_t e = 0; e < 3; ++e)
        within[e] += r - sum <= looked.eps[e] * side ? 2.0 / 700 : 0;
      if (const auto c = static_cast<std::size_t>(r / width + 0.5); c < distance.size())
        ++distance[c];
      if (r <= 1.05 * sum) {
        ++contacts[i];
        ++contacts[j];
      }
      overlap = std::max(overlap, 1 - r / sum);
    }
    contacts[i] += spheres.position[i].y() <= 1.05 * spheres.radius[i];
    contacts[i] += 1.1 - spheres.position[i].y() <= 1.05 * spheres.radius[i];
  }
  for (std::size_t e = 0; e < 3; ++e)
    CHECK(q.eps_coordination[e] == doctest::Approx(within[e]).epsilon(1e-12));
  double total = 0, inner = 0;
  for (std::size_t c = 0; c < distance.size(); ++c) {
    // one pair of walls, 1.1 apart: a shift by r leaves 1 - r/2.2 of the box inside, averaged over directions
    const double outer = (static_cast<double>(c) + 0.5) * width;
    const auto integral = [](double r) { return std::pow(r, 3) / 3 - std::pow(r, 4) / 8.8; };
    const double expected =
        700 * 699 / 2 * 4 * std::numbers::pi * (integral(outer) - integral(inner)) / box.volume();
    inner = outer;
    CHECK(q.pair_correlation[c] == doctest::Approx(distance[c] / expected).epsilon(1e-9));
    total += distance[c];
  }
  CHECK(total > 1000);
  CHECK(q.largest_overlap == doctest::Approx(overlap).epsilon(1e-12));
  std::vector<std::uint64_t> histogram(q.contacts_histogram.size(), 0);
  for (const int c : contacts) {
    REQUIRE(static_cast<std::size_t>(c) < histogram.size());
    ++histogram[static_cast<std::size_t>(c)];
  }
  CHECK(histogram == q.contacts_histogram);

  const Quality one = quality(spheres, box, looked);
  CHECK(one.pair_correlation == q.pair_correlation);
  CHECK(one.gap_coordination == q.gap_coordination);
  CHECK(one.rattlers == q.rattlers);
  CHECK(one.anisotropy.fraction == q.anisotropy.fraction);
}

TEST_CASE("counts agree with brute force over all pairs, for any number of threads") {
  compare_with_brute_force({Vec3::Zero(), Vec3(1, 1.1, 0.7), {true, false, true}});
  compare_with_brute_force(
      {Vec3::Zero(), Vec3(1.6, 1.1, 0.33), {true, false, true}}); // hardly two cells thick
  compare_with_brute_force({Vec3::Zero(), Vec3(0.33, 1.1, 2), {true, false, true}});
}

TEST_CASE("structure factors are those of the definition, to the same bits for any number of threads") {
  const geometry::Box box{Vec3(0.5, 0, 0), Vec3(1.5, 1, 0.5), {true, true, true}};
  const auto spheres = gas(300, box, 0.01, 0.05);
  const Quality one = quality(spheres, box, {.pair_range = 3, .wave_number = 2});
  core::ThreadPool three(3);
  const Quality q = quality(spheres, box, {.pair_range = 3, .wave_number = 2}, three);
  CHECK(one.structure_factor == q.structure_factor);
  CHECK(one.volume_structure_factor == q.volume_structure_factor);

  std::vector<double> sum(3, 0), volume_sum(3, 0), vectors(3, 0);
  for (int a = -2; a <= 2; ++a)
    for (int b = -2; b <= 2; ++b)
      for (int c = -2; c <= 2; ++c) {
        const Vec3 k = 2 * std::numbers::pi * Vec3(a, b, 2 * c);
        const auto nearest = static_cast<std::size_t>(std::lround(k.norm() / (2 * std::numbers::pi)));
        if (nearest < 1 || nearest > 2)
          continue;
        std::complex<double> amplitude = 0, by_volume = 0;
        double squares = 0;
        for (std::size_t i = 0; i < 300; ++i) {
          const auto wave = std::polar(1.0, -k.dot(spheres.position[i]));
          const double volume = std::pow(spheres.radius[i], 3);
          amplitude += wave;
          by_volume += volume * wave;
          squares += volume * volume;
        }
        sum[nearest] += std::norm(amplitude) / 300;
        volume_sum[nearest] += std::norm(by_volume) / squares;
        ++vectors[nearest];
      }
  for (std::size_t c = 1; c <= 2; ++c) {
    CHECK(q.wave_vectors[c - 1] == vectors[c] / 2);
    CHECK(q.structure_factor[c - 1] == doctest::Approx(sum[c] / vectors[c]).epsilon(1e-10));
    CHECK(q.volume_structure_factor[c - 1] == doctest::Approx(volume_sum[c] / vectors[c]).epsilon(1e-10));
  }
}

TEST_CASE("rattlers fall in chains; those held by walls stay") {
  // A tetrahedron of touching spheres, a fifth that touches one of them alone, a sixth that touches the fifth.
  particles::ParticleSet spheres;
  spheres.resize(6);
  const double a = 1 / std::sqrt(8.0);
  spheres.position = {Vec3(a, a, a),   Vec3(a, -a, -a),   Vec3(-a, a, -a),
                      Vec3(-a, -a, a), Vec3(a, a, a + 1), Vec3(a, a, a + 2)};
  spheres.radius.assign(6, 0.5);
  const Quality open = quality(spheres, {Vec3::Constant(-5), Vec3::Constant(5), {}},
                               {.coordination = 2, .contact_tolerance = 1e-9});
  CHECK(open.rattlers == 6); // three contacts do not hold
  CHECK(open.contacts_histogram == std::vector<std::uint64_t>{0, 1, 1, 3, 1});
  CHECK(open.contact_number == doctest::Approx(16.0 / 6));
  const double wall = a + 0.5; // a box round the tetrahedron: each of its spheres touches three walls
  const Quality held = quality(spheres, {Vec3::Constant(-wall), Vec3(wall, wall, 9), {}},
                               {.coordination = 2, .contact_tolerance = 1e-9});
  CHECK(held.rattlers == 2);
  CHECK(held.backbone_number == doctest::Approx((5 + 6 + 6 + 5) / 4.0)); // the upper wall is out of reach
}

TEST_CASE("radii: mean, scatter, skewness; the tolerance follows the pressure") {
  const geometry::Box box = geometry::Box::cube(1, true);
  auto spheres = gas(400, box, 0.02, 0.02);
  for (std::size_t i = 0; i < 100; ++i)
    spheres.radius[i] = 0.04; // a quarter
  const Quality q = quality(spheres, box, {.reduced_pressure = 1e6});
  CHECK(q.radius.mean == doctest::Approx(0.025));
  CHECK(q.radius.standard_deviation == doctest::Approx(0.02 * std::sqrt(3.0 / 16)));
  CHECK(q.radius.skewness == doctest::Approx(0.5 / std::sqrt(3.0 / 16))); // (1 - 2 p) / sqrt(p (1 - p))
  CHECK(q.radius.smallest == 0.02);
  CHECK(q.radius.largest == 0.04);
  CHECK(q.contact_tolerance == doctest::Approx(1e-4));
  CHECK(quality(spheres, box, {.reduced_pressure = 10}).contact_tolerance == 0.01);
}

TEST_CASE("bad input to quality is refused by name") {
  const auto crystal = Lattice({.cells = {4, 4, 4}}).pack();
  const auto refuse = [&](const packing::QualityParameters& parameters, const char* what) {
    CHECK_THROWS_WITH_AS(quality(crystal.particles, crystal.box, parameters), doctest::Contains(what),
                         core::InvalidInput);
  };
  refuse({.coordination = 0}, "coordination number Z = 0");
  refuse({.contact_tolerance = -1}, "contact tolerance = -1");
  refuse({.reduced_pressure = 0}, "reduced pressure = 0");
  refuse({.eps = {std::numeric_limits<double>::infinity()}}, "eps = inf");
  refuse({.smallest_gap = 0}, "smallest gap = 0");
  refuse({.largest_gap = 1e-12}, "largest gap = 1e-12");
  refuse({.gaps_per_decade = 0}, "gaps per decade = 0");
  refuse({.pair_range = 21}, "range of g(r) = 21");
  refuse({.pair_class = 0}, "class of g(r) = 0");
  refuse({.wave_number = 65}, "largest wave number = 65");
  refuse({.eps = {1.0}}, "edge of the periodic box");
  particles::ParticleSet one;
  one.resize(1);
  one.radius = {0.1};
  CHECK_THROWS_WITH_AS(quality(one, geometry::Box::cube(1, true)),
                       doctest::Contains("number of particles = 1"), core::InvalidInput);
}
