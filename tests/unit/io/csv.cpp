#include <cdem/core/random.hpp>
#include <cdem/io/csv.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <limits>

#include "temporary_folder.hpp"

using namespace cdem;

TEST_CASE("Numbers read back to the same bits") {
  const TemporaryFolder folder;
  std::vector<double> values{0.0,
                             -0.0,
                             0.1,
                             1.0 / 3.0,
                             -1e-300,
                             std::numeric_limits<double>::denorm_min(),
                             std::numeric_limits<double>::max(),
                             std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()};
  core::Random random(1);
  while (values.size() < 2000) {
    const double value = std::bit_cast<double>(random.bits());
    if (value == value)
      values.push_back(value);
  }
  io::CsvWriter writer(folder / "a.csv", {"x", "n"});
  for (std::size_t i = 0; i < values.size(); ++i)
    writer.row(values[i], i);
  writer.commit();
  const auto table = io::read_csv(folder / "a.csv");
  const auto back = table.numbers("x");
  REQUIRE(back.size() == values.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    differing += std::bit_cast<std::uint64_t>(back[i]) != std::bit_cast<std::uint64_t>(values[i]);
  CHECK(differing == 0);
  CHECK(table.numbers("n").back() == static_cast<double>(values.size() - 1));
}

TEST_CASE("NaN is written and read as nan, whatever its sign") {
  const TemporaryFolder folder;
  io::CsvWriter writer(folder / "a.csv", {"x"});
  writer.row(std::numeric_limits<double>::quiet_NaN());
  writer.row(-std::numeric_limits<double>::quiet_NaN());
  writer.commit();
  CHECK(content_of(folder / "a.csv") == "x\nnan\nnan\n");
  for (const double value : io::read_csv(folder / "a.csv").numbers("x"))
    CHECK(std::isnan(value));
}

TEST_CASE("Text is quoted as RFC 4180 asks") {
  CHECK(io::csv_field("plain text") == "plain text");
  CHECK(io::csv_field("a,b") == "\"a,b\"");
  CHECK(io::csv_field("say \"hi\"") == "\"say \"\"hi\"\"\"");
  CHECK(io::csv_field("two\nlines") == "\"two\nlines\"");

  const TemporaryFolder folder;
  const std::vector<std::string> texts{"",         "a,b",      "\"", "\"\"", "two\r\nlines",
                                       " spaces ", "ν = 0.24", ",",  "\n"};
  io::CsvWriter writer(folder / "a.csv", {"name, with comma", "x"});
  for (const std::string& text : texts)
    writer.row(text, 1);
  writer.commit();
  const auto table = io::read_csv(folder / "a.csv");
  CHECK(table.columns == std::vector<std::string>{"name, with comma", "x"});
  REQUIRE(table.rows.size() == texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i)
    CHECK(table.rows[i][0] == texts[i]);
}

TEST_CASE("A single column keeps its empty fields") {
  const TemporaryFolder folder;
  io::CsvWriter writer(folder / "a.csv", {"x"});
  writer.row("");
  writer.row("a");
  writer.commit();
  const auto table = io::read_csv(folder / "a.csv");
  REQUIRE(table.rows.size() == 2);
  CHECK(table.rows[0][0].empty());
}

TEST_CASE("Tables of other programs are read: CR LF, no line end at the end, empty lines") {
  const TemporaryFolder folder;
  put(folder / "a.csv", "a,b\r\n1,\"x\"\r\n\r\n2,");
  const auto table = io::read_csv(folder / "a.csv");
  CHECK(table.columns == std::vector<std::string>{"a", "b"});
  CHECK(table.rows == std::vector<std::vector<std::string>>{{"1", "x"}, {"2", ""}});
}

TEST_CASE("Bad columns and rows are refused when writing") {
  const TemporaryFolder folder;
  const auto with = [&](const std::vector<std::string>& columns) {
    io::CsvWriter writer(folder / "a.csv", columns);
  };
  CHECK_THROWS_AS(with({}), core::InvalidInput);
  CHECK_THROWS_AS(with({"a", ""}), core::InvalidInput);
  CHECK(message_of<core::InvalidInput>([&] {
          with({"a", "b", "a"});
        }) ==
        "name of a column = 'a' is not accepted: names that are not empty and all different are expected");
  io::CsvWriter writer(folder / "a.csv", {"a", "b"});
  CHECK(contains(message_of<core::InvalidInput>([&] { writer.row(1); }),
                 "= 1 is not accepted: one a column (2)"));
  const std::array<double, 3> three{};
  CHECK_THROWS_AS(writer.row(std::span<const double>(three)), core::InvalidInput);
}

TEST_CASE("Damaged tables are refused with file and reason") {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    put(folder / "a.csv", text);
    const std::string message =
        message_of<core::FileError>([&] { io::read_csv(folder / "a.csv").numbers("x"); });
    CHECK(contains(message, "cannot read " + (folder / "a.csv").string() + ": "));
    return message;
  };
  CHECK(contains(refusal(""), "it is empty"));
  CHECK(contains(refusal("x,y\n1\n"), "row 1 has 1 fields, one a column (2) is expected"));
  CHECK(contains(refusal("x\n\"1\n"), "a quoted field does not end"));
  CHECK(contains(refusal("x\n\"1\"2\n"), "after a quoted field"));
  CHECK(contains(refusal("y,z\n1,2\n"), "no column 'x' but y, z"));
  CHECK(contains(refusal("x\n1\n1.5m\n"), "row 2 of column 'x' is '1.5m', a number is expected"));
  CHECK(contains(refusal("x,y\n,2\n"), "is '', a number is expected"));
  CHECK(contains(message_of<core::FileError>([&] { io::read_csv(folder / "b.csv"); }),
                 "No such file or directory"));
  CHECK(contains(message_of<core::FileError>([&] { io::read_csv(folder.path()); }), "it is a folder"));
}
