#pragma once

/// @file
/// Spheres from VTK's legacy files (.vtk), ASCII and binary: points, and point data that name radius and phase.

#include <cdem/io/detail/line_reader.hpp>

#include <array>
#include <bit>
#include <cstring>

namespace cdem::io::detail {

/// A number type of VTK's files.
struct VtkType {
  char kind = 0; ///< 'f', 'i', 'u'; 0 for one that is not known
  std::size_t bytes = 0;

  /// From "double", "vtktypeint64", "unsigned_char" of legacy files, "Float64", "UInt8" of XML files.
  static VtkType named(std::string_view name) {
    struct Known {
      std::string_view name;
      VtkType type;
    };
    static constexpr std::array<Known, 22> known{
        {{"float", {'f', 4}},         {"double", {'f', 8}},       {"char", {'i', 1}},
         {"unsigned_char", {'u', 1}}, {"short", {'i', 2}},        {"unsigned_short", {'u', 2}},
         {"int", {'i', 4}},           {"unsigned_int", {'u', 4}}, {"long", {'i', 8}},
         {"unsigned_long", {'u', 8}}, {"vtkIdType", {'i', 4}},    {"vtktypeint64", {'i', 8}},
         {"Float32", {'f', 4}},       {"Float64", {'f', 8}},      {"Int8", {'i', 1}},
         {"UInt8", {'u', 1}},         {"Int16", {'i', 2}},        {"UInt16", {'u', 2}},
         {"Int32", {'i', 4}},         {"UInt32", {'u', 4}},       {"Int64", {'i', 8}},
         {"UInt64", {'u', 8}}}};
    for (const Known& one : known)
      if (one.name == name)
        return one.type;
    return {};
  }

  /// The number at `data`, its bytes reversed where asked for.
  double at(const char* data, bool reversed) const {
    std::array<char, 8> raw{};
    for (std::size_t k = 0; k < bytes; ++k)
      raw[k] = data[reversed ? bytes - 1 - k : k];
    const auto as = [&](auto value) {
      std::memcpy(&value, raw.data(), sizeof value);
      return static_cast<double>(value);
    };
    if (kind == 'f')
      return bytes == 4 ? as(float{}) : as(double{});
    switch (bytes) {
    case 1:
      return kind == 'i' ? as(std::int8_t{}) : as(std::uint8_t{});
    case 2:
      return kind == 'i' ? as(std::int16_t{}) : as(std::uint16_t{});
    case 4:
      return kind == 'i' ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return kind == 'i' ? as(std::int64_t{}) : as(std::uint64_t{});
    }
  }
};

/// The arrays that both kinds of VTK file are searched for.
struct PointArrays {
  std::vector<double> points, radius, phase; ///< [3 points], [points], [points]
  bool by_diameter = false;

  /// Where an array of this name belongs; none for one of no interest.
  std::vector<double>* wanted(std::string_view name, std::size_t components) {
    const std::string plain = plain_name(name);
    if (components != 1)
      return nullptr;
    if (names_radius(plain) || names_diameter(plain)) {
      by_diameter = names_diameter(plain);
      return &radius;
    }
    return names_phase(plain) ? &phase : nullptr;
  }

  /// The spheres; `fail` is called with what is wrong.
  template <class Fail>
  SphereFile spheres(Fail&& fail) const {
    const std::size_t count = points.size() / 3;
    if (count == 0)
      fail("it holds no points");
    for (const auto* values : {&radius, &phase})
      if (!values->empty() && values->size() != count)
        fail("it has " + std::to_string(count) + " points, but " + std::to_string(values->size()) +
             (values == &radius ? " radii" : " phases"));
    SphereFile file;
    file.has_radii = !radius.empty();
    file.particles.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string point = "point " + std::to_string(i) + ": ";
      for (std::size_t k = 0; k < 3; ++k) {
        const double value = points[3 * i + k];
        if (!std::isfinite(value))
          fail(point + "xyz"[k] + " is " + core::to_text(value) + ", a finite number is expected");
        file.particles.position[i][static_cast<Eigen::Index>(k)] = value;
      }
      if (file.has_radii && !(std::isfinite(radius[i]) && radius[i] > 0))
        fail(point + (by_diameter ? "diameter" : "radius") + " is " + core::to_text(radius[i]) +
             ", a finite number above 0 is expected");
      file.particles.radius[i] = file.has_radii ? radius[i] / (by_diameter ? 2 : 1) : 0;
      if (!phase.empty() && !(phase[i] >= 0 && phase[i] <= 255 && phase[i] == std::floor(phase[i])))
        fail(point + "phase is " + core::to_text(phase[i]) + ", a whole number from 0 to 255 is expected");
      file.particles.phase[i] = phase.empty() ? PhaseIndex{0} : static_cast<PhaseIndex>(phase[i]);
    }
    return file;
  }
};

/// Parser of a legacy file: keyword lines, each followed by numbers, as text or big-endian.
class LegacyVtk {
public:
  explicit LegacyVtk(std::filesystem::path path) : path_(std::move(path)), text_(whole_file(path_)) {}

  SphereFile read() {
    if (!line().starts_with("# vtk DataFile Version"))
      fail("'# vtk DataFile Version' is expected");
    line(); // the title
    const std::string format(trimmed(line()));
    if (format != "ASCII" && format != "BINARY")
      fail("ASCII or BINARY is expected");
    binary_ = format == "BINARY";
    while (at_ < text_.size())
      keyword();
    return arrays_.spheres([&](const std::string& why) { fail(why); });
  }

private:
  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError("cannot read " + path_.string() + ": line " + std::to_string(number_) + ": " + why);
  }

  std::string_view line() {
    if (at_ >= text_.size())
      fail("the file ends here");
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view found = std::string_view(text_).substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    ++number_;
    return found;
  }

  std::size_t count(std::string_view text) const {
    const auto value = number_in<std::size_t>(text);
    if (!value || *value > text_.size()) // every value takes a byte at least
      fail("a number of values that fits the file is expected, not '" + std::string(text) + "'");
    return *value;
  }

  /// Reads `count` numbers, keeping them where `keep` is given.
  void values(std::string_view type_name, std::size_t count, std::vector<double>* keep) {
    if (keep)
      keep->clear();
    if (binary_) {
      const VtkType type = VtkType::named(type_name);
      if (type.kind == 0)
        fail("numbers of type '" + std::string(type_name) + "' are not known");
      if (text_.size() - std::min(at_, text_.size()) < count * type.bytes)
        fail("the file ends before the " + std::to_string(count) + " numbers that follow");
      for (std::size_t k = 0; k < count && keep; ++k)
        keep->push_back(
            type.at(text_.data() + at_ + k * type.bytes, std::endian::native == std::endian::little));
      at_ += count * type.bytes;
      if (at_ < text_.size() && text_[at_] == '\n') {
        ++at_;
        ++number_;
      }
      return;
    }
    if (count == 0)
      return;
    for (std::size_t k = 0; k < count; ++k) {
      for (; at_ < text_.size() && is_blank(text_[at_]); ++at_)
        number_ += text_[at_] == '\n';
      const std::size_t begin = at_;
      while (at_ < text_.size() && !is_blank(text_[at_]))
        ++at_;
      const std::string_view word = std::string_view(text_).substr(begin, at_ - begin);
      const auto value = number_in<double>(word);
      ++number_; // the line that follows the last line end
      if (at_ >= text_.size())
        fail("the file ends within number " + std::to_string(k + 1) + " of " + std::to_string(count));
      if (!value)
        fail("'" + std::string(word) + "' stands for number " + std::to_string(k + 1) + " of " +
             std::to_string(count));
      --number_;
      if (keep)
        keep->push_back(*value);
    }
    line(); // what is left of the last line
  }

  void keyword() {
    std::vector<std::string_view> words;
    split(trimmed(line()), ' ', words);
    if (words.empty())
      return;
    const std::string_view first = words[0];
    const auto expect_words = [&](std::size_t least) {
      if (words.size() < least)
        fail(std::string(first) + " is followed by too little");
    };
    if (first == "DATASET") {
      expect_words(2);
      if (words[1] != "POLYDATA" && words[1] != "UNSTRUCTURED_GRID")
        fail("DATASET POLYDATA or UNSTRUCTURED_GRID is expected");
    } else if (first == "POINTS") {
      expect_words(3);
      values(words[2], 3 * count(words[1]), &arrays_.points);
    } else if (first == "VERTICES" || first == "LINES" || first == "POLYGONS" || first == "TRIANGLE_STRIPS" ||
               first == "CELLS") {
      expect_words(3);
      cells(count(words[1]), count(words[2]));
    } else if (first == "CELL_TYPES") {
      expect_words(2);
      values("int", count(words[1]), nullptr);
    } else if (first == "POINT_DATA" || first == "CELL_DATA") {
      expect_words(2);
      of_points_ = first == "POINT_DATA";
      tuples_ = count(words[1]);
    } else if (first == "SCALARS") {
      expect_words(3);
      const std::size_t components = words.size() > 3 ? count(words[3]) : 1;
      const std::string name(words[1]), type(words[2]);
      if (const std::size_t here = at_, lines = number_; !line().starts_with("LOOKUP_TABLE")) {
        at_ = here;
        number_ = lines;
      }
      values(type, tuples_ * components, of_points_ ? arrays_.wanted(unescaped(name), components) : nullptr);
    } else if (first == "VECTORS" || first == "NORMALS" || first == "TENSORS") {
      expect_words(3);
      values(words[2], tuples_ * (first == "TENSORS" ? 9 : 3), nullptr);
    } else if (first == "FIELD") {
      expect_words(3);
      field(count(words[2]));
    } else if (first == "LOOKUP_TABLE") {
      expect_words(3);
      values("unsigned_char", 4 * count(words[2]), nullptr);
    } else if (first == "METADATA") { // up to an empty line
      while (at_ < text_.size() && !trimmed(line()).empty()) {
      }
    } else {
      fail("'" + std::string(first) + "' is not known here");
    }
  }

  /// Cells are passed over: spheres are points. Since version 5 they are two arrays.
  void cells(std::size_t number, std::size_t size) {
    const std::size_t here = at_, lines = number_;
    std::vector<std::string_view> words;
    split(trimmed(line()), ' ', words);
    if (words.size() == 2 && words[0] == "OFFSETS") {
      values(words[1], number, nullptr);
      split(trimmed(line()), ' ', words);
      if (words.size() != 2 || words[0] != "CONNECTIVITY")
        fail("CONNECTIVITY is expected");
      values(words[1], size, nullptr);
      return;
    }
    at_ = here;
    number_ = lines;
    values("int", size, nullptr);
  }

  void field(std::size_t arrays) {
    std::vector<std::string_view> words;
    while (arrays > 0) {
      split(trimmed(line()), ' ', words);
      if (words.empty())
        continue;
      if (words[0] == "METADATA") {
        while (!trimmed(line()).empty()) {
        }
        continue;
      }
      if (words.size() != 4)
        fail("name, components, tuples and type of an array are expected");
      const std::size_t components = count(words[1]), tuples = count(words[2]);
      values(words[3], components * tuples,
             of_points_ ? arrays_.wanted(unescaped(words[0]), components) : nullptr);
      --arrays;
    }
  }

  /// VTK writes a blank in a name as %20.
  static std::string unescaped(std::string_view name) {
    std::string text;
    for (std::size_t k = 0; k < name.size(); ++k)
      if (name.substr(k, 3) == "%20") {
        text += ' ';
        k += 2;
      } else {
        text += name[k];
      }
    return text;
  }

  std::filesystem::path path_;
  std::string text_;
  std::size_t at_ = 0, number_ = 0, tuples_ = 0;
  bool binary_ = false, of_points_ = false;
  PointArrays arrays_;
};

} // namespace cdem::io::detail
