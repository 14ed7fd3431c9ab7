#pragma once

/// @file
/// The figures a run ends with, beside what they are compared with.

#include <cdem/io/csv.hpp>

#include <cstdio>
#include <optional>

namespace cdem::io {

/// One figure of a run.
struct Result {
  std::string quantity;    ///< dotted lower-case name, conditions in brackets: "alumina.youngs_modulus"
  std::string symbol = {}; ///< the paper's symbol, such as "E_M"
  double value = 0;        ///< as computed, NaN where the run gave none
  std::string unit = "1";  ///< SI; "1" for a plain number
  std::optional<double> reference = {}; ///< in the same unit
  std::string source = {};              ///< where the reference is from: "[L17] section 2.3"

  /// (value - reference) / |reference|; none without a reference or where it is 0.
  std::optional<double> relative_difference() const {
    if (!reference || *reference == 0)
      return std::nullopt;
    return (value - *reference) / std::abs(*reference);
  }
};

namespace detail {

/// Whether `name` reads word.word.word[condition], words of lower-case letters, digits and underscores.
inline bool is_quantity(std::string_view name) {
  const std::size_t bracket = name.find('[');
  const std::string_view condition = bracket == name.npos ? "" : name.substr(bracket);
  if (!condition.empty() && (condition.size() < 3 || condition.find(']') != condition.size() - 1))
    return false;
  char before = '.';
  for (const char c : name.substr(0, bracket)) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    if (!letter && (c != '.' || before == '.'))
      return false;
    before = c;
  }
  return before != '.';
}

/// Columns of a text on a terminal: bytes of UTF-8 that begin a character.
inline std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// Five significant digits.
inline std::string five_digits(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.5g", value);
  return text.data();
}

/// Scale and name of the unit a value in `unit` is best read in: GPa, MPa or kPa for large stresses.
struct ReadableUnit {
  double factor;
  std::string name;

  ReadableUnit(double value, const std::string& unit) : factor(1), name(unit == "1" ? "" : unit) {
    if (unit != "Pa")
      return;
    for (const auto& [size, prefix] : {std::pair{1e9, "G"}, std::pair{1e6, "M"}, std::pair{1e3, "k"}})
      if (std::abs(value) >= size && std::isfinite(value)) {
        factor = size;
        name = prefix + unit;
        return;
      }
  }
};

/// Rows of cells with the columns lined up, two spaces between them.
inline std::string aligned(const std::vector<std::vector<std::string>>& rows,
                           const std::vector<bool>& to_the_right) {
  std::vector<std::size_t> width(to_the_right.size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c)
      width[c] = std::max(width[c], width_of(row[c]));
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string space(width[c] - width_of(row[c]), ' ');
      line += (c == 0 ? "" : "  ") + (to_the_right[c] ? space + row[c] : row[c] + space);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

} // namespace detail

/// The results table of a run: `results.csv` for programs, aligned text for people.
class Results {
public:
  /// @throws core::InvalidInput for a quantity that is no dotted lower-case name or is there already, an empty unit,
  ///         a reference that is not finite or comes without its source
  void add(Result result) {
    core::expect(
        detail::is_quantity(result.quantity), "quantity", "'" + result.quantity + "'",
        "a dotted lower-case name such as alumina.youngs_modulus or youngs_modulus.dem[contrast=0.01] is "
        "expected");
    for (const Result& other : list_)
      core::expect(other.quantity != result.quantity, "quantity", "'" + result.quantity + "'",
                   "it is in the results already");
    core::expect(!result.unit.empty(), "unit of " + result.quantity, "''",
                 "a unit, 1 for a plain number, is expected");
    if (result.reference) {
      core::expect_finite(*result.reference, "reference of " + result.quantity);
      core::expect(!result.source.empty(), "source of " + result.quantity, "''",
                   "a reference comes with where it is from");
    }
    list_.push_back(std::move(result));
  }

  const std::vector<Result>& list() const noexcept { return list_; }

  /// Writes the columns quantity, value, unit, reference, relative_difference, source; what is not known stays empty.
  /// @throws core::FileError if the file cannot be written
  void write_csv(const std::filesystem::path& path) const {
    CsvWriter csv(path, {"quantity", "value", "unit", "reference", "relative_difference", "source"});
    const auto text = [](const std::optional<double>& number) {
      return number ? number_to_text(*number) : std::string();
    };
    for (const Result& result : list_)
      csv.row(result.quantity, result.value, result.unit, text(result.reference),
              text(result.relative_difference()), result.source);
    csv.commit();
  }

  /// The table for a terminal: five digits, stresses in GPa, MPa or kPa, differences in percent.
  std::string text() const {
    std::vector<std::vector<std::string>> rows{
        {"quantity", "symbol", "value", "reference", "unit", "difference", "source"}};
    for (const Result& result : list_) {
      const detail::ReadableUnit unit(result.value, result.unit);
      const auto difference = result.relative_difference();
      std::array<char, 32> percent{};
      if (difference)
        std::snprintf(percent.data(), percent.size(), "%+.2f %%", 100 * *difference);
      rows.push_back({result.quantity, result.symbol, detail::five_digits(result.value / unit.factor),
                      result.reference ? detail::five_digits(*result.reference / unit.factor) : "", unit.name,
                      percent.data(), result.source});
    }
    return detail::aligned(rows, {false, false, true, true, false, true, false});
  }

private:
  std::vector<Result> list_;
};

} // namespace cdem::io
