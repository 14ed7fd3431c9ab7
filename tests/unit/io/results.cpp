#include <cdem/io/results.hpp>

#include <doctest/doctest.h>

#include <limits>

#include "temporary_folder.hpp"

using namespace cdem;

namespace {

io::Results two_results() {
  io::Results results;
  results.add({.quantity = "alumina.youngs_modulus",
               .symbol = "E_M",
               .value = 357e9,
               .unit = "Pa",
               .reference = 350e9,
               .source = "[L17] section 2.3"});
  results.add({.quantity = "alumina.poissons_ratio",
               .symbol = "ν_M",
               .value = 0.228,
               .reference = 0.24,
               .source = "a, b"});
  results.add({.quantity = "network.bonds", .value = 31000});
  return results;
}

std::string refusal(const io::Result& result) {
  io::Results results = two_results();
  return message_of<core::InvalidInput>([&] { results.add(result); });
}

} // namespace

TEST_CASE("results.csv has the columns of every example; what is not known stays empty") {
  const TemporaryFolder folder;
  two_results().write_csv(folder / "results.csv");
  const auto table = io::read_csv(folder / "results.csv");
  CHECK(table.columns ==
        std::vector<std::string>{"quantity", "value", "unit", "reference", "relative_difference", "source"});
  REQUIRE(table.rows.size() == 3);
  CHECK(table.rows[0] == std::vector<std::string>{"alumina.youngs_modulus", "3.57e+11", "Pa", "3.5e+11",
                                                  "0.02", "[L17] section 2.3"});
  CHECK(table.rows[1][5] == "a, b");
  CHECK(table.numbers("value")[1] == 0.228);
  CHECK(table.rows[2] == std::vector<std::string>{"network.bonds", "31000", "1", "", "", ""});
}

TEST_CASE("The text lines up, in readable units, with non-ASCII symbols counted as one column") {
  CHECK(two_results().text() ==
        "quantity                symbol  value  reference  unit  difference  source\n"
        "alumina.youngs_modulus  E_M       357        350  GPa      +2.00 %  [L17] section 2.3\n"
        "alumina.poissons_ratio  ν_M     0.228       0.24           -5.00 %  a, b\n"
        "network.bonds                   31000\n");
}

TEST_CASE("Values are shown in the unit that suits them, reference and value in the same") {
  io::Results results;
  results.add({.quantity = "a", .value = 2.433e8, .unit = "Pa", .reference = 1e9, .source = "s"});
  results.add({.quantity = "b", .value = -2500, .unit = "Pa"});
  results.add({.quantity = "c", .value = 0.5, .unit = "Pa"});
  results.add({.quantity = "d", .value = 1e9, .unit = "m"});
  const std::string text = results.text();
  CHECK(contains(text, "243.3       1000  MPa"));
  CHECK(contains(text, "-2.5             kPa"));
  CHECK(contains(text, " 0.5             Pa"));
  CHECK(contains(text, "1e+09             m"));
}

TEST_CASE("The relative difference is signed, and none where there is nothing to divide by") {
  CHECK(io::Result{.quantity = "a", .value = -3, .reference = -2.0}.relative_difference() == -0.5);
  CHECK_FALSE(io::Result{.quantity = "a", .value = 1, .reference = 0.0}.relative_difference());
  CHECK_FALSE(io::Result{.quantity = "a", .value = 1}.relative_difference());
}

TEST_CASE("A value that is not a number is reported as such") {
  io::Results results;
  results.add({.quantity = "a",
               .value = std::numeric_limits<double>::quiet_NaN(),
               .unit = "Pa",
               .reference = 1.0,
               .source = "s"});
  results.add({.quantity = "b", .value = std::numeric_limits<double>::infinity(), .unit = "Pa"});
  CHECK(contains(results.text(), "nan"));
  CHECK(contains(results.text(), "inf"));
  const TemporaryFolder folder;
  results.write_csv(folder / "results.csv");
  CHECK(contains(content_of(folder / "results.csv"), "a,nan,Pa,1,nan,s\nb,inf,Pa,,,\n"));
}

TEST_CASE("Quantities are dotted lower-case names with conditions in brackets") {
  for (const char* name : {"a", "silica.youngs_modulus", "solver.outer_iterations",
                           "youngs_modulus.dem[contrast=0.01]", "e[a=1, b=X]"})
    CHECK_MESSAGE(refusal({.quantity = name}) == "", std::string(name));
  for (const char* name : {"", ".", "a.", ".a", "a..b", "E", "a b", "a[", "a[]", "a[b", "a]b", "a[b]c", "[a]",
                           "a.[b]", "a[b]]", "young's"})
    CHECK_MESSAGE(contains(refusal({.quantity = name}), "a dotted lower-case name"), std::string(name));
}

TEST_CASE("A result that is there already, has no unit, or whose reference is no number or without source is "
          "refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(refusal({.quantity = "network.bonds"}), "it is in the results already"));
  CHECK(contains(refusal({.quantity = "a", .unit = ""}), "unit of a"));
  CHECK(contains(refusal({.quantity = "a", .reference = nan, .source = "s"}), "reference of a = nan"));
  CHECK(contains(refusal({.quantity = "a", .reference = 1.0}), "source of a"));
}
