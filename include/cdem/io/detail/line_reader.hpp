#pragma once

/// @file
/// Text files line by line, with complaints that name the line; and the spheres that are read from them.

#include <cdem/core/error.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/particles/particle_set.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace cdem::io::detail {

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back()))
    text.remove_suffix(1);
  return text;
}

/// The fields of a line: between separators (trimmed, quotes taken off), or between blanks where separator is ' '.
inline void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') {
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t begin = line.find_first_not_of(" \t", at);
      if (begin == line.npos)
        return;
      at = std::min(line.find_first_of(" \t", begin), line.size());
      fields.push_back(line.substr(begin, at - begin));
    }
    return;
  }
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    std::string_view field = trimmed(line.substr(at, end - at));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
      field = field.substr(1, field.size() - 2);
    fields.push_back(field);
    at = end + 1;
  }
}

/// The whole text as a number, none if it is something else.
template <class Number>
std::optional<Number> number_in(std::string_view text) {
  if (!text.empty() && text.front() == '+')
    text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size())
    return std::nullopt;
  return value;
}

/// Opens a file for reading.
/// @throws core::FileError if it cannot be read or is a folder
inline std::ifstream open_input(const std::filesystem::path& path) {
  std::error_code ignored;
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path, ignored))
    throw core::FileError("cannot read " + path.string() + ": " +
                          (in ? "it is a folder" : std::generic_category().message(errno)));
  return in;
}

/// The bytes of a file.
inline std::string whole_file(const std::filesystem::path& path) {
  std::ifstream in = open_input(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Reads a text file line by line. Every failure throws core::FileError, "cannot read <file>: line <n>: <what>".
class LineReader {
public:
  explicit LineReader(std::filesystem::path path) : path_(std::move(path)), file_(open_input(path_)) {}

  /// Goes to the next line; false at the end of the file. A last line without an end is refused: it may have lost digits.
  bool next() {
    if (!std::getline(file_, line_))
      return false;
    ++number_;
    if (file_.eof())
      fail("it has no line end: is the file truncated?");
    if (!line_.empty() && line_.back() == '\r')
      line_.pop_back();
    return true;
  }
  /// Goes to the next line, or fails with what is missing.
  void need(std::string_view what) {
    if (!next())
      fail("the file ends here, " + std::string(what) + " is expected");
  }

  std::string_view line() const noexcept { return line_; }
  std::size_t number() const noexcept { return number_; }
  const std::filesystem::path& path() const noexcept { return path_; }

  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError("cannot read " + path_.string() + ": line " + std::to_string(number_) + ": " + why);
  }

  /// A finite number in this line.
  double finite(std::string_view text, std::string_view name) const {
    const auto value = number_in<double>(text);
    if (!value || !std::isfinite(*value))
      fail(std::string(name) + " is '" + std::string(text) + "', a finite number is expected");
    return *value;
  }
  /// A whole number from 0 to `most` in this line.
  std::uint64_t whole(std::string_view text, std::string_view name, std::uint64_t most = 0xffffffffU) const {
    const auto value = number_in<std::uint64_t>(text);
    if (!value || *value > most)
      fail(std::string(name) + " is '" + std::string(text) + "', a whole number from 0 to " +
           std::to_string(most) + " is expected");
    return *value;
  }
  /// Fails unless there are so many fields.
  void expect_fields(std::size_t there, std::size_t expected) const {
    if (there != expected)
      fail("it has " + std::to_string(there) + " columns, " + std::to_string(expected) + " are expected");
  }

private:
  std::filesystem::path path_;
  std::ifstream file_;
  std::string line_;
  std::size_t number_ = 0;
};

/// What a file says of spheres, in its own unit of length.
struct SphereFile {
  particles::ParticleSet particles; ///< radii are 0 where the file has none
  std::optional<geometry::Box> box; ///< where the file has one
  bool has_radii = false;

  /// Adds a sphere read from a line; a radius that the file gives must be a finite number above 0.
  void add(const LineReader& reader, const Vec3& centre, std::optional<double> radius, PhaseIndex phase) {
    if (radius && !(*radius > 0))
      reader.fail("radius is " + core::to_text(*radius) + ", a finite number above 0 is expected");
    particles.position.push_back(centre);
    particles.radius.push_back(radius.value_or(0));
    particles.phase.push_back(phase);
    has_radii = radius.has_value();
  }
};

/// Name of an array or a column in lower case and without its unit: "radius" for "Radius [m]" and "radius_m".
inline std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : trimmed(name.substr(0, name.find_first_of("[("))))
    plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (plain.size() > 2 && plain.ends_with("_m"))
    plain.resize(plain.size() - 2);
  return plain;
}
inline bool names_radius(const std::string& plain) {
  return plain == "radius" || plain == "r" || plain == "radii" || plain == "rad";
}
inline bool names_diameter(const std::string& plain) {
  return plain == "diameter" || plain == "d";
}
inline bool names_phase(const std::string& plain) {
  return plain == "phase" || plain == "matid" || plain == "materialid";
}

} // namespace cdem::io::detail
