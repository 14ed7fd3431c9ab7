// Figures 1 and 2 of [L17] at reduced size: 500 and 4000 particles, looser. Physics, not digits.

#include <doctest/doctest.h>

#include "ecd_isotropy/report.hpp"
#include "unit/io/temporary_folder.hpp"

using namespace cdem;
namespace ecd = examples::ecd_isotropy;

namespace {

ecd::Params small() {
  ecd::Params params;
  params.sizes = {500, 4000};
  params.covs = {0, 0.3};
  params.density = 0.58; // packs in no time
  params.threads = 1;
  return params;
}

bool same_bytes(const ecd::Result& a, const ecd::Result& b) {
  if (a.cases.size() != b.cases.size())
    return false;
  for (std::size_t c = 0; c < a.cases.size(); ++c) {
    const packing::Quality &p = a.cases[c].quality, &q = b.cases[c].quality;
    if (p.anisotropy.fraction != q.anisotropy.fraction || p.eps != q.eps ||
        p.pair_correlation != q.pair_correlation || p.structure_factor != q.structure_factor ||
        p.reduced_pressure != q.reduced_pressure || a.cases[c].eps_cut != b.cases[c].eps_cut)
      return false;
  }
  return true;
}

} // namespace

TEST_CASE("E_k falls as chance lets it, eps as the diameter over the side") {
  const ecd::Result result = ecd::run(small());
  REQUIRE(result.cases.size() == 4);
  for (const ecd::Case& one : result.cases) {
    CAPTURE(one.condition());
    CHECK(one.quality.particles == one.particles);
    CHECK(one.quality.density == doctest::Approx(0.58).epsilon(1e-9));
    CHECK(one.quality.coordination == doctest::Approx(6.2).epsilon(1e-3));
    // three planes of 31 degrees of freedom: the root mean square over chance scatters by 1/sqrt(2 93) = 7 %
    CHECK(one.anisotropy() / one.quality.isotropic_deviation == doctest::Approx(1).epsilon(0.35));
    CHECK(one.eps_cut > one.quality.eps); // the particles at the faces of the cut cube have lost neighbours
    CHECK(one.quality.volume_structure_factor.front() <
          0.1); // far below 1: dense packings hardly fluctuate at long waves
  }
  for (std::size_t k : {0u, 2u}) { // the same gap in diameters, so eps goes as N^(-1/3)
    const double ratio = result.cases[k + 1].quality.eps / result.cases[k].quality.eps;
    CHECK(ratio == doctest::Approx(std::cbrt(500.0 / 4000)).epsilon(0.1));
  }
  CHECK(result.cases[2].quality.eps >
        result.cases[0].quality.eps); // unequal spheres need wider gaps for Z = 6.2
  CHECK(&result.largest(0.3) == &result.cases[3]);
}

TEST_CASE("results depend neither on the threads nor on whether the packings were made or kept; a damaged "
          "one is remade") {
  ecd::Params params = small();
  params.sizes = {500};
  const ecd::Result plain = ecd::run(params);
  const TemporaryFolder folder;
  params.source.cache = folder / "packings";
  params.threads = 3;
  const ecd::Result made = ecd::run(params);
  const ecd::Result kept = ecd::run(params);
  CHECK(same_bytes(made, plain));
  CHECK(same_bytes(kept, plain));
  CHECK_FALSE(made.cases[1].loaded);
  CHECK(kept.cases[1].loaded);
  CHECK(kept.cases[1].pack_seconds == made.cases[1].pack_seconds);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "packings"))
    files.push_back(entry.path());
  REQUIRE(files.size() == 2);
  CHECK(contains(files[0].filename().string(), "lubachevsky_stillinger-500-density0.58-cov0"));

  std::filesystem::resize_file(files[0], 500);
  put(files[1], "no packing");
  const ecd::Result remade = ecd::run(params);
  CHECK(same_bytes(remade, plain));
  CHECK_FALSE(remade.cases[0].loaded);
  CHECK_FALSE(remade.cases[1].loaded);
  CHECK(ecd::run(params).cases[0].loaded);

  ecd::Params given = params; // one of these files, as a user gives it
  given.source = {files[0], {}};
  const ecd::Result read = ecd::run(given);
  REQUIRE(read.cases.size() == 1);
  CHECK(read.cases[0].particles == 500);
  CHECK_FALSE(read.cases[0].quality.reduced_pressure);
  const bool equal = read.cases[0].quality.radius.cov() == 0;
  CHECK(read.cases[0].quality.eps == plain.cases[equal ? 0 : 1].quality.eps);

  params.seed = 2; // another packing, beside the old ones
  CHECK_FALSE(same_bytes(ecd::run(params), plain));
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "packings"), {}) == 4);
}

TEST_CASE("the results stand beside what the paper prints, and the curves are written") {
  ecd::Params params = small();
  params.sizes = {500, 1000};
  params.covs = {0.3};
  ecd::Result result = ecd::run(params);
  const TemporaryFolder folder;
  const io::OutputDirectory out(folder / "out");
  ecd::write(result, out);
  const auto curves = io::read_csv(out.file("isotropy.csv"));
  CHECK(curves.numbers("particles") == std::vector<double>{500, 1000});
  CHECK(curves.numbers("eps")[1] == result.cases[1].quality.eps);
  CHECK(curves.numbers("gap_over_diameter")[0] ==
        doctest::Approx(result.cases[0].quality.eps * 0.01 / (2 * result.cases[0].quality.radius.mean)));
  for (const char* name : {"cov0.3_1000_coordination.csv", "cov0.3_1000_pair_correlation.csv",
                           "cov0.3_1000_structure_factor.csv", "cov0.3_1000_contacts.csv",
                           "cov0.3_1000_angles.csv", "cov0.3_500_angles.csv", "results.csv"})
    CHECK_MESSAGE(std::filesystem::exists(out.file(name)), name);
  CHECK(io::read_csv(out.file("cov0.3_500_angles.csv")).rows.size() == 96);
  const auto pairs = io::read_csv(out.file("cov0.3_1000_pair_correlation.csv"));
  CHECK(pairs.numbers("distance_over_diameter")[50] == doctest::Approx(1));
  CHECK(pairs.numbers("pair_correlation") == result.cases[1].quality.pair_correlation);

  result.cases[0].particles = 10000; // as if: the paper prints something of these sizes
  result.cases[1].particles = 700000;
  const auto reference = [&](const std::string& quantity) -> std::optional<double> {
    const io::Results table = ecd::tabulate(result);
    for (const io::Result& row : table.list())
      if (row.quantity == quantity)
        return row.reference;
    FAIL(quantity);
    return std::nullopt;
  };
  CHECK(reference("ecd.anisotropy[cov=0.3,particles=10000]") == 1.3e-3);
  CHECK(reference("ecd.eps[cov=0.3,particles=10000]") == 1.7e-4);
  CHECK(reference("ecd.eps[body=cut,cov=0.3,particles=700000]") == 5.0e-5);
  CHECK(reference("network.anisotropy[plane=yz,cov=0.3,particles=700000]") ==
        result.cases[1].quality.isotropic_deviation);
}

TEST_CASE("a packing's figures have plain names where there is no condition") {
  ecd::Params params = small();
  params.sizes = {500};
  params.covs = {0};
  io::Results table;
  io::add_quality(table, ecd::run(params).cases[0].quality);
  std::vector<std::string> names;
  for (const io::Result& row : table.list())
    names.push_back(row.quantity);
  for (const char* name :
       {"packing.density", "packing.rattlers", "packing.reduced_pressure",
        "packing.structure_factor[of=volume]", "network.eps", "network.anisotropy[plane=zx]"})
    CHECK_MESSAGE(std::find(names.begin(), names.end(), name) != names.end(), name);
}

TEST_CASE("bad parameters are refused before anything is packed") {
  const auto refuse = [](auto change, const char* what) {
    ecd::Params params = small();
    change(params);
    CHECK_THROWS_WITH_AS(ecd::run(params), doctest::Contains(what), core::InvalidInput);
  };
  refuse([](ecd::Params& p) { p.sizes.clear(); }, "number of sizes = 0");
  refuse([](ecd::Params& p) { p.covs.clear(); }, "number of CoVs = 0");
  refuse([](ecd::Params& p) { p.covs = {0, 0.9}; }, "CoV of the radii = 0.9");
  refuse([](ecd::Params& p) { p.density = 1.5; }, "density = 1.5");
  refuse([](ecd::Params& p) { p.coordination = -1; }, "coordination = -1");
  refuse([](ecd::Params& p) { p.growth_rate = 0; }, "growth rate = 0");
}

TEST_CASE("a density that cannot be reached is an error, and nothing is kept") {
  ecd::Params params = small();
  params.sizes = {500};
  params.covs = {0.3};
  params.density = 0.9;
  params.pressure_limit = 1e4;
  const TemporaryFolder folder;
  params.source.cache = folder.path();
  CHECK_THROWS_WITH_AS(ecd::run(params), doctest::Contains("density 0.9 was not reached"), core::NotReached);
  CHECK(folder.entries() == 0);
}
