// The scenario of [L17] section 2.3 at reduced size: 700 particles, looser, fewer steps. Physics, not digits.

#include <doctest/doctest.h>

#include <atomic>
#include <filesystem>

#include "rve_tension/report.hpp"

using namespace cdem;
namespace rve = examples::rve_tension;

namespace {

/// A folder of this test alone, empty at first and gone at the end.
struct Folder {
  std::filesystem::path path;
  explicit Folder(const char* name)
      : path(std::filesystem::temp_directory_path() / (std::string("cdem_rve_") + name)) {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

rve::Params small() {
  rve::Params params;
  params.packing.particles = 700;
  params.packing.density = 0.58; // packs in no time
  params.convergence.interval = 300;
  params.most_steps = 900;
  params.threads = 1;
  return params;
}

bool same_bytes(const rve::Result& a, const rve::Result& b) {
  for (std::size_t m = 0; m < a.materials.size(); ++m) {
    const auto &u = a.materials[m].motion.displacement, &v = b.materials[m].motion.displacement;
    if (u.size() != v.size() || std::memcmp(u.data(), v.data(), u.size() * sizeof(u[0])) != 0 ||
        a.materials[m].moduli.youngs_modulus != b.materials[m].moduli.youngs_modulus ||
        a.materials[m].stress.stress != b.materials[m].stress.stress)
      return false;
  }
  return true;
}

} // namespace

TEST_CASE("the cube in tension is in balance and its specimens add up") {
  rve::Params params = small();
  params.most_steps = 2400;
  for (const auto boundary : {packing::Boundary::periodic, packing::Boundary::walls}) {
    params.packing.boundary = boundary;
    const rve::Result result = rve::run(params);
    REQUIRE(result.materials.size() == 2);
    CHECK(result.packing.reached());
    CHECK(result.specimen.density() == doctest::Approx(0.58).epsilon(1e-9));
    for (const auto& m : result.materials) {
      INFO(m.material.name);
      CHECK(m.force_loaded ==
            doctest::Approx(m.force_fixed).epsilon(1e-2)); // 1e-3 once converged, at full length
      const double moment = stress::moment_of_stress(m.stress)(0, 0);
      CHECK(moment == doctest::Approx(m.moment_of_reactions).epsilon(5e-3));
      CHECK(std::abs(m.energy.imbalance()) < 1e-4 * m.energy.external_work);
      // stiffer than nothing, softer than columns of solid material under the whole section
      CHECK(m.moduli.youngs_modulus > 0);
      CHECK(m.moduli.youngs_modulus < m.material.micro.youngs_modulus);
      CHECK(m.moduli.nominal_youngs_modulus > m.moduli.youngs_modulus); // centres lie inside the faces
      CHECK(m.moduli.poissons_ratio > 0);
      CHECK(m.moduli.poissons_ratio < 0.5);
    }
    // thicker beams: relatively stiffer, less contraction, [L17] figure 7
    const auto &alumina = result.materials[0], &silica = result.materials[1];
    CHECK(silica.moduli.youngs_modulus / silica.material.micro.youngs_modulus >
          alumina.moduli.youngs_modulus / alumina.material.micro.youngs_modulus);
    CHECK(silica.moduli.poissons_ratio < alumina.moduli.poissons_ratio);
  }
}

TEST_CASE("results do not depend on the number of threads, nor on having been interrupted") {
  const rve::Params params = small();
  const rve::Result reference = rve::run(params);
  rve::Params threads = params;
  threads.threads = 3;
  CHECK(same_bytes(rve::run(threads), reference));

  const Folder folder("resume");
  rve::Params kept = params;
  kept.checkpoints = folder.path;
  std::atomic<bool> stop = false;
  int reports = 0;
  const core::Monitor impatient(
      [&](const core::Progress& progress) {
        if (progress.stage == "silica" && ++reports == 1)
          stop = true;
      },
      &stop);
  bool interrupted = false;
  try {
    rve::run(kept, impatient);
  } catch (const core::Interrupted& message) {
    interrupted = true;
    CHECK(std::string(message.what()).find("--resume") != std::string::npos);
  }
  if (!interrupted) // a fast machine may be done before the first report: then a shorter run stands in
    MESSAGE("the run ended before it could be interrupted");
  kept.resume = true;
  const rve::Result resumed = rve::run(kept);
  CHECK(resumed.packing_loaded);
  CHECK(same_bytes(resumed, reference));
}

TEST_CASE("a run over a ramp, in two parts, gives the bytes of a run in one") {
  const Folder folder("parts");
  rve::Params params = small();
  params.ramp = 11; // beyond the first part
  params.observe_every = 5;
  const rve::Params at_once = params;
  params.checkpoints = folder.path;
  params.most_steps = 600;
  rve::run(params);
  params.resume = true;
  params.most_steps = 900;
  const rve::Result whole = rve::run(at_once);
  CHECK(same_bytes(rve::run(params), whole));
  for (const auto& m : whole.materials) {
    const double time = 600 * m.material.time_step;
    CHECK(m.loading.ramp > time);
    CHECK(m.loading.ramp < 1.5 * time);
  }
}

TEST_CASE("a checkpoint of other parameters, or a damaged one, is refused by name") {
  const Folder folder("refused");
  rve::Params params = small();
  params.checkpoints = folder.path;
  rve::run(params);
  params.resume = true;
  params.velocity = 2e-5;
  CHECK_THROWS_WITH_AS(rve::run(params), doctest::Contains("other parameters"), core::FileError);
  params.velocity = 1e-5;
  std::filesystem::resize_file(folder.path / "alumina.checkpoint", 1000);
  CHECK_THROWS_WITH_AS(rve::run(params), doctest::Contains("alumina.checkpoint"), core::FileError);
}

TEST_CASE("bad parameters are refused before anything is computed or written") {
  const Folder folder("bad");
  const auto refuse = [&](auto change, const char* what) {
    rve::Params params = small();
    params.checkpoints = folder.path;
    change(params);
    CHECK_THROWS_WITH_AS(rve::run(params), doctest::Contains(what), core::InvalidInput);
    CHECK(std::filesystem::is_empty(folder.path));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuse([&](rve::Params& p) { p.packing.cov = nan; }, "CoV of the radii");
  refuse([&](rve::Params& p) { p.packing.density = 1.5; }, "density");
  refuse([&](rve::Params& p) { p.coordination = nan; }, "coordination");
  refuse([&](rve::Params& p) { p.coordination = 0; }, "coordination");
  refuse([&](rve::Params& p) { p.velocity = 0; }, "velocity");
  refuse([&](rve::Params& p) { p.damping_ratio = -1; }, "damping");
  refuse([&](rve::Params& p) { p.safety = 1; }, "safety");
  refuse([&](rve::Params& p) { p.most_steps = 10; }, "steps");
  refuse([&](rve::Params& p) { p.particles_per_specimen = 1e6; }, "particles per specimen");
  refuse([&](rve::Params& p) { p.ramp = -1; }, "ramp");
  refuse([&](rve::Params& p) { p.steady_after = nan; }, "beginning of the steady averages");
  refuse([&](rve::Params& p) { p.sample_every = 0; }, "sample_every");
  refuse([&](rve::Params& p) { p.observe_every = 7; }, "observe_every");
}

TEST_CASE(
    "a density far above what can be packed is an error that names what was reached, and writes nothing") {
  const Folder folder("dense");
  rve::Params params = small();
  params.checkpoints = folder.path;
  params.packing.density = 0.9;
  params.packing.pressure_limit = 1e4;
  CHECK_THROWS_WITH_AS(rve::run(params), doctest::Contains("density 0.9 was not reached"), core::NotReached);
  CHECK(std::filesystem::is_empty(folder.path));
}

TEST_CASE("the results table names what it must, with the paper's values") {
  const rve::Params params = small();
  const rve::Result result = rve::run(params);
  const io::Results table = rve::tabulate(params, result);
  struct Printed {
    const char* quantity;
    double value;
  };
  for (const Printed& printed :
       {Printed{"alumina.youngs_modulus", 350e9}, Printed{"alumina.poissons_ratio", 0.24},
        Printed{"silica.youngs_modulus", 65e9}, Printed{"silica.poissons_ratio", 0.2}}) {
    bool found = false;
    for (const auto& row : table.list())
      if (row.quantity == printed.quantity) {
        found = true;
        CHECK(row.reference.value() == doctest::Approx(printed.value));
      }
    CHECK_MESSAGE(found, printed.quantity);
  }
}
