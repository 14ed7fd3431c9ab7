// A packing stopped in mid-course goes on from its file to the bytes of the run that was never stopped.

#include <cdem/io/packing_state.hpp>

#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

using namespace cdem;

TEST_CASE("a packing goes on from a file to the same bytes") {
  const auto folder = std::filesystem::temp_directory_path() / "cdem_packing_state";
  std::filesystem::create_directories(folder);
  const auto file = folder / "run.cdem";
  const packing::LubachevskyStillinger generator({.particles = 400, .density = 0.6, .growth_rate = 0.1});
  core::ThreadPool pool;
  const auto whole =
      generator.pack(pool, core::Monitor(),
                     {[&](const packing::GrowthState& state) { io::save_packing_state(file, state); }, 0});
  const auto resumed = generator.resume(io::load_packing_state(file), pool);
  REQUIRE(resumed.particles.size() == 400);
  CHECK(std::memcmp(whole.particles.position.data(), resumed.particles.position.data(), 400 * sizeof(Vec3)) ==
        0);
  CHECK(std::memcmp(whole.particles.radius.data(), resumed.particles.radius.data(), 400 * sizeof(double)) ==
        0);
  CHECK(whole.report.collisions == resumed.report.collisions);

  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 8);
  CHECK_THROWS_AS(io::load_packing_state(file), core::FileError);
  std::filesystem::remove_all(folder);
}
