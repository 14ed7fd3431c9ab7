#include <cdem/io/calibration_chart.hpp>

#include <doctest/doctest.h>

#include "temporary_folder.hpp"

using namespace cdem;

namespace {

homogenize::CalibrationChart chart() {
  homogenize::CalibrationChart c;
  c.name = "Lubachevsky-Stillinger, CoV 0.3";
  c.ecd = "generator = mine\ncov = 0.3\n";
  c.coordination = 6.2;
  c.micro_poissons_ratio = 0.3;
  c.particles = 100000;
  c.packings = 1;
  c.smallest_ratio = 0.1;
  c.largest_ratio = 0.9;
  c.modulus = {{0.1, 0.9 + 1e-16, -0.3, 0.1}};
  c.poissons_ratio = {{0.42, -1.0 / 3}};
  c.modulus_scatter = c.poissons_scatter = std::nan("");
  return c;
}

} // namespace

TEST_CASE("a chart is read back bit by bit") {
  const TemporaryFolder folder;
  const auto file = folder / "a.chart";
  io::save_chart(file, chart());
  const auto read = io::load_chart(file);
  CHECK(read.name == chart().name);
  CHECK(read.ecd == chart().ecd);
  CHECK(read.modulus.coefficients == chart().modulus.coefficients);
  CHECK(read.poissons_ratio.coefficients == chart().poissons_ratio.coefficients);
  CHECK(read.particles == 100000);
  CHECK(std::isnan(read.modulus_scatter));
  io::save_chart(folder / "b.chart", read);
  CHECK(content_of(folder / "b.chart") == content_of(file));
}

TEST_CASE("a file that is no chart is refused, wherever it is cut") {
  const TemporaryFolder folder;
  const auto file = folder / "a.chart";
  io::save_chart(file, chart());
  const std::string whole = content_of(file);
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    put(file, whole.substr(0, length));
    CHECK_THROWS_AS(io::load_chart(file), core::FileError);
  }
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    put(file, text);
    try {
      io::load_chart(file);
    } catch (const core::FileError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK(contains(with("chart 1", "chart 2"), "'cdem calibration chart 1' is expected"));
  CHECK(contains(with("packings = 1", "packings = -1"), "packings is '-1', a number is expected"));
  CHECK(contains(with("packings = 1", "packings = 0"), "number of packings of the chart = 0"));
  CHECK(contains(with("packings", "packungs"), "'packings = ...' is expected where it has 'packungs = 1'"));
  CHECK(contains(with("modulus = 0.1", "modulus = nan"), "a coefficient of the chart = nan"));
  CHECK(contains(with("end\n", "end\nmore\n"), "it goes on after its end"));
  CHECK(contains(with("0.42 -", "0.42 "), "slope of nu of the chart")); // rises
  CHECK_THROWS_AS(io::load_chart(folder / "none.chart"), core::FileError);
}

TEST_CASE(
    "a kept chart is measured once; a damaged one anew, that of another kind of packing is left alone") {
  const TemporaryFolder folder;
  const auto file = folder / "a.chart";
  int measured = 0;
  const auto keep = [&](const std::string& ecd) {
    return io::kept_chart(file, ecd, [&] {
      ++measured;
      return chart();
    });
  };
  CHECK(keep("cov = 0.3\n").ecd == "cov = 0.3\n");
  CHECK(keep("cov = 0.3\n").modulus.coefficients == chart().modulus.coefficients);
  CHECK(measured == 1);
  CHECK_THROWS_AS(keep("cov = 0.1\n"), core::FileError);
  CHECK(measured == 1);
  put(file, "no chart");
  keep("cov = 0.3\n");
  CHECK(measured == 2);
  CHECK(keep("cov = 0.3\n").ecd == "cov = 0.3\n");
}
