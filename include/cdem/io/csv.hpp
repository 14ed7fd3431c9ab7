#pragma once

/// @file
/// Tables as comma-separated values, RFC 4180, with numbers that read back to the same bits.

#include <cdem/io/atomic_file.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

namespace cdem::io {

/// Shortest text that reads back to the same number; "nan", "inf" and "-inf" for the values that are not finite.
template <class Number>
requires std::integral<Number> || std::floating_point<Number> std::string number_to_text(Number value) {
  if constexpr (std::same_as<Number, bool>) {
    return value ? "1" : "0";
  } else {
    std::array<char, 64> text;
    if constexpr (std::floating_point<Number>)
      if (value != value)
        return "nan"; // to_chars would print the sign of the NaN as well
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return std::string(text.data(), end);
  }
}

/// A field as RFC 4180 writes it: in quotes, with quotes doubled, where it holds a comma, a quote or a line end.
inline std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos)
    return std::string(text);
  std::string quoted = "\"";
  for (const char c : text)
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// Writes a table row by row; the file appears with commit().
///
/// Lines end in a line feed alone (RFC 4180 asks for CR LF, few tools of this field do).
class CsvWriter {
public:
  /// @param columns  one name each, all different
  /// @throws core::InvalidInput for no column, an empty name or one that comes twice
  /// @throws core::FileError    if the file cannot be written
  CsvWriter(std::filesystem::path path, const std::vector<std::string>& columns)
      : file_(std::move(path)), columns_(columns.size()) {
    core::expect(!columns.empty(), "number of columns of " + file_.path().string(), 0,
                 "at least 1 is expected");
    for (auto name = columns.begin(); name != columns.end(); ++name)
      core::expect(!name->empty() && std::find(columns.begin(), name, *name) == name, "name of a column",
                   "'" + *name + "'", "names that are not empty and all different are expected");
    for (const std::string& name : columns)
      append(name);
    end_row();
  }

  /// Writes one row of numbers and texts, one a column.
  /// @throws core::InvalidInput for another number of fields than of columns
  template <class... Fields>
  void row(const Fields&... fields) {
    expect_fields(sizeof...(fields));
    (append(fields), ...);
    end_row();
  }

  /// Writes one row of numbers.
  void row(std::span<const double> numbers) {
    expect_fields(numbers.size());
    for (const double number : numbers)
      append(number);
    end_row();
  }

  /// Completes the file.
  void commit() { file_.commit(); }

private:
  void expect_fields(std::size_t count) const {
    core::expect(count == columns_, "number of fields in a row of " + file_.path().string(), count,
                 "one a column (" + std::to_string(columns_) + ") is expected");
  }
  template <class Field>
  void append(const Field& field) {
    if (!line_.empty() || fields_ > 0)
      line_ += ',';
    if constexpr (std::integral<Field> || std::floating_point<Field>)
      line_ += number_to_text(field);
    else
      line_ += csv_field(field);
    ++fields_;
  }
  void end_row() {
    if (line_.empty())
      line_ = "\"\""; // a single empty field: an empty line would be read as no row
    line_ += '\n';
    file_.write(line_);
    line_.clear();
    fields_ = 0;
  }

  AtomicFile file_;
  std::size_t columns_;
  std::size_t fields_ = 0;
  std::string line_;
};

/// A table read from a CSV file.
struct CsvTable {
  std::vector<std::string> columns;           ///< names, from the first line
  std::vector<std::vector<std::string>> rows; ///< [rows][columns] text
  std::string source;                         ///< the file, for messages

  /// Number of the column called `name`.
  /// @throws core::FileError if there is none; names those there are
  std::size_t column(std::string_view name) const {
    const auto found = std::find(columns.begin(), columns.end(), name);
    if (found == columns.end()) {
      std::string known;
      for (const std::string& column : columns)
        known += (known.empty() ? "" : ", ") + column;
      throw core::FileError("cannot read " + source + ": it has no column '" + std::string(name) + "' but " +
                            known);
    }
    return static_cast<std::size_t>(found - columns.begin());
  }

  /// The numbers of the column called `name`, [rows].
  /// @throws core::FileError if there is no such column or a field is not a number
  std::vector<double> numbers(std::string_view name) const {
    const std::size_t c = column(name);
    std::vector<double> values;
    values.reserve(rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::string& text = rows[r][c];
      double value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size())
        throw core::FileError("cannot read " + source + ": row " + std::to_string(r + 1) + " of column '" +
                              std::string(name) + "' is '" + text + "', a number is expected");
      values.push_back(value);
    }
    return values;
  }
};

namespace detail {

/// Splits CSV text into rows of fields. Line ends are LF or CR LF; empty lines are skipped.
class CsvParser {
public:
  CsvParser(std::string_view text, std::string source) : text_(text), source_(std::move(source)) {}

  std::vector<std::vector<std::string>> parse() {
    std::vector<std::vector<std::string>> rows;
    while (at_ < text_.size()) {
      if (at_line_end()) {
        skip_line_end();
        continue;
      }
      std::vector<std::string> row{field()};
      while (at_ < text_.size() && text_[at_] == ',') {
        ++at_;
        row.push_back(field());
      }
      if (at_ < text_.size()) {
        if (!at_line_end())
          fail("a comma or the end of the line is expected after a quoted field");
        skip_line_end();
      }
      if (!rows.empty() && row.size() != rows.front().size())
        fail("row " + std::to_string(rows.size()) + " has " + std::to_string(row.size()) +
             " fields, one a column (" + std::to_string(rows.front().size()) + ") is expected");
      rows.push_back(std::move(row));
    }
    return rows;
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError("cannot read " + source_ + ": " + why);
  }

private:
  bool at_line_end() const { return text_[at_] == '\n' || text_.substr(at_, 2) == "\r\n"; }
  void skip_line_end() { at_ += text_[at_] == '\r' ? 2u : 1u; }

  std::string field() { return at_ < text_.size() && text_[at_] == '"' ? quoted() : plain(); }

  std::string plain() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != ',' && !at_line_end())
      ++at_;
    return std::string(text_.substr(begin, at_ - begin));
  }

  std::string quoted() {
    std::string value;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] != '"')
        value += text_[at_];
      else if (text_.substr(at_, 2) == "\"\"")
        value += text_[at_++];
      else {
        ++at_;
        return value;
      }
    }
    fail("a quoted field does not end");
  }

  std::string_view text_;
  std::string source_;
  std::size_t at_ = 0;
};

} // namespace detail

/// Reads a CSV file with a line of column names.
///
/// @throws core::FileError if the file cannot be read, is empty, has a row of another length than the first, or a
///         quoted field without an end
inline CsvTable read_csv(const std::filesystem::path& path) {
  std::error_code ignored;
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw core::FileError("cannot read " + path.string() + ": " + std::generic_category().message(errno));
  if (std::filesystem::is_directory(path, ignored))
    throw core::FileError("cannot read " + path.string() + ": it is a folder");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  detail::CsvParser parser(text, path.string());
  CsvTable table{{}, parser.parse(), path.string()};
  if (table.rows.empty())
    parser.fail("it is empty, a line of column names is expected");
  table.columns = std::move(table.rows.front());
  table.rows.erase(table.rows.begin());
  return table;
}

} // namespace cdem::io
