#include <doctest/doctest.h>

#include "calibration/report.hpp"
#include "calibration/scenario.hpp"
#include "unit/io/temporary_folder.hpp"

using namespace cdem;
namespace cal = examples::calibration;

namespace {

cal::Params small() {
  cal::Params params;
  params.kinds = {{0.3, 0.1}};
  params.particles = 500;
  params.packings = 3;
  params.density = 0.6;
  params.study.radius_ratios = {0.1, 0.25, 0.4, 0.65, 0.9};
  params.micro_ratios = {0, 0.49};
  params.micro_at = {0.4};
  params.threads = 1;
  return params;
}

const cal::Result& result() {
  static const cal::Result made = cal::run(small());
  return made;
}

} // namespace

TEST_CASE("E_a rises with r_mu and stays below the affine bound, nu falls, E_mu is a unit") {
  const cal::KindResult& kind = result().kinds.at(0);
  REQUIRE(kind.points.size() == 15);
  for (std::size_t i = 0; i < kind.points.size(); ++i) {
    const cal::Measurement& m = kind.points[i];
    CAPTURE(m.key);
    CHECK(m.relative_modulus < m.affine_modulus);
    CHECK(m.smallest < m.relative_modulus);
    CHECK(m.largest > m.relative_modulus);
    CHECK(m.asymmetry < 1e-6);
    if (i % 5 > 0) {
      CHECK(m.relative_modulus > kind.points[i - 1].relative_modulus);
      CHECK(m.poissons_ratio < kind.points[i - 1].poissons_ratio);
    }
  }
  // Stretch alone, by far, at the lower bound of sections: bonds in all directions alike give nu = 1/4 where affine.
  CHECK(kind.points[0].affine_poissons == doctest::Approx(0.25).epsilon(0.05));
  for (const cal::Measurement& m : kind.other_unit)
    CHECK(m.relative_modulus == doctest::Approx(kind.points[2].relative_modulus).epsilon(1e-9));
  REQUIRE(kind.micro.size() == 2); // a lower G_mu is softer, and it hardly matters
  CHECK(kind.micro[1].relative_modulus < kind.micro[0].relative_modulus);
  CHECK(kind.micro[1].relative_modulus > 0.98 * kind.micro[0].relative_modulus);
}

TEST_CASE("the three materials are found again on a packing that the chart has not seen") {
  const cal::KindResult& kind = result().kinds.at(0);
  for (std::size_t k = 0; k < 3; ++k) {
    CAPTURE(cal::materials()[k].name);
    REQUIRE(kind.calibrated[k]);
    REQUIRE(kind.verified[k]);
    CHECK(kind.verified[k]->seed == 4);
    const auto& micro = *kind.calibrated[k];
    const double modulus = kind.verified[k]->relative_modulus * micro.youngs_modulus;
    // 500 particles scatter: what the calibration says of it, four times over
    CHECK(std::abs(modulus / cal::materials()[k].macro.youngs_modulus - 1) <
          4 * micro.macro_modulus_deviation + 0.01);
    CHECK(std::abs(kind.verified[k]->poissons_ratio - cal::materials()[k].macro.poissons_ratio) <
          4 * micro.macro_poissons_deviation + 0.005);
    CHECK(micro.macro_modulus_deviation < 0.1);
  }
}

TEST_CASE("what the table holds is not measured again, whatever the threads; charts are written") {
  const TemporaryFolder folder;
  cal::Params params = small();
  params.packings = 1;
  params.source.cache = folder / "packings";
  params.table = folder / "calibration_measurements.csv";
  const cal::Result first = cal::run(params);
  params.packings = 2;
  params.threads = 2;
  const cal::Result second = cal::run(params);
  for (std::size_t i = 0; i < 5; ++i)
    CHECK(second.kinds[0].points[i].seconds == first.kinds[0].points[i].seconds);
  for (std::size_t i = 0; i < 10; ++i) {
    CHECK(second.kinds[0].points[i].relative_modulus == result().kinds[0].points[i].relative_modulus);
    CHECK(second.kinds[0].points[i].poissons_ratio == result().kinds[0].points[i].poissons_ratio);
  }
  const io::OutputDirectory out(folder / "out");
  cal::write(second, out);
  const auto chart = io::load_chart(out.file("cov0.3.chart"));
  CHECK(chart.modulus.coefficients == second.kinds[0].fit.chart.modulus.coefficients);
  CHECK(chart.packings == 2);
  CHECK(io::read_csv(out.file("calibration_points.csv")).rows.size() == 10);
}

TEST_CASE("the paper's tension test on a cut cube is near, and gives a chart too") {
  cal::Params params = small();
  params.packings = 1;
  params.study.radius_ratios = {0.2, 0.4, 0.65, 0.9};
  params.test = cal::Test::symmetric;
  params.micro_at = {0.4};
  params.micro_ratios = {};
  const cal::KindResult kind = cal::run(params).kinds.at(0);
  CHECK(kind.points[1].relative_modulus == doctest::Approx(result().kinds[0].points[2].relative_modulus)
                                               .epsilon(0.25)); // faces: 8 particles to a side
  CHECK(std::abs(kind.points[1].poissons_ratio - result().kinds[0].points[2].poissons_ratio) < 0.06);
}

TEST_CASE("a generator's chart in one call is that of the example") {
  const cal::Params params = small();
  std::vector<cal::Generator::Parameters> packings;
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    packings.push_back(params.packing(params.kinds[0], seed));
  core::ThreadPool pool;
  const examples::StaticSolver solver{.relative_residual = 1e-6}; // the example's
  const auto chart =
      homogenize::measure_chart<cal::Generator>(packings, params.study, {.name = "mine"}, solver, pool).chart;
  const auto& expected = result().kinds[0].fit.chart;
  CHECK(chart.name == "mine");
  CHECK(chart.particles == 500);
  CHECK(chart.packings == 3);
  CHECK(chart.modulus.coefficients == expected.modulus.coefficients);
  CHECK(chart.poissons_ratio.coefficients == expected.poissons_ratio.coefficients);
  CHECK(chart.modulus_scatter == expected.modulus_scatter);
  CHECK_THROWS_AS(homogenize::measure_chart<cal::Generator>({}, params.study, {}, solver, pool),
                  core::InvalidInput);
}

TEST_CASE("bad parameters are refused before anything is packed") {
  const auto refuse = [](auto change, const char* what) {
    cal::Params params = small();
    change(params);
    CHECK_THROWS_WITH_AS(cal::run(params), doctest::Contains(what), core::InvalidInput);
  };
  refuse([](cal::Params& p) { p.kinds.clear(); }, "number of CoVs = 0");
  refuse([](cal::Params& p) { p.packings = 0; }, "packings = 0");
  refuse([](cal::Params& p) { p.study.radius_ratios = {0.1, 0.2, 0.3, 1.2}; }, "r_mu = 1.2");
  refuse([](cal::Params& p) { p.study.radius_ratios = {0.1, 0.2}; }, "number of r_mu = 2");
  refuse([](cal::Params& p) { p.density = 1.5; }, "density = 1.5");
}
