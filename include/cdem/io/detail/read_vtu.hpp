#pragma once

/// @file
/// Spheres from VTK's XML files (.vtu, .vtp): points, and point data that name radius and phase. Text, base64 or raw,
/// appended or not, as it is or packed by zlib.

#include <cdem/io/detail/inflate.hpp>
#include <cdem/io/detail/read_vtk.hpp>

#include <algorithm>
#include <utility>

namespace cdem::io::detail {

/// The arrays of points in an XML file, found by their tags; what is not about points is passed over.
class XmlVtk {
public:
  explicit XmlVtk(std::filesystem::path path) : path_(std::move(path)), text_(whole_file(path_)) {}

  SphereFile read() {
    open();
    static constexpr std::array<std::string_view, 9> sections{
        "FieldData", "PointData", "CellData", "Points", "Cells", "Verts", "Lines", "Strips", "Polys"};
    std::string_view section; // the last that was opened
    int pieces = 0;
    while (const auto tag = next_tag()) {
      const std::string_view name = name_of(*tag);
      if (name == "Piece") {
        if (++pieces > 1)
          fail("it holds several pieces, one is expected");
      } else if (name == "DataArray") {
        const std::string_view inside = content();
        if (section == "Points")
          arrays_.points = values(*tag, inside, 3);
        else if (section == "PointData")
          if (auto* wanted = arrays_.wanted(attribute(*tag, "Name"), components(*tag)))
            *wanted = values(*tag, inside, 1);
      } else if (std::find(sections.begin(), sections.end(), name) != sections.end()) {
        section = name;
      }
    }
    return arrays_.spheres([&](const std::string& why) { fail(why); });
  }

private:
  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError("cannot read " + path_.string() + ": " + why);
  }
  /// Fails with the line that is being read.
  [[noreturn]] void fail_here(const std::string& why) const {
    const auto lines =
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, end_)), '\n');
    fail("line " + std::to_string(lines + 1) + ": " + why);
  }

  /// Finds the appended data and what the head says of all arrays.
  void open() {
    end_ = text_.size();
    const std::size_t head = text_.find("<VTKFile");
    if (head == text_.npos)
      fail("it has no element VTKFile");
    at_ = head;
    const std::string tag(next_tag().value());
    const std::string_view type = attribute(tag, "type");
    if (type != "UnstructuredGrid" && type != "PolyData")
      fail_here("the type UnstructuredGrid or PolyData is expected, not '" + std::string(type) + "'");
    reversed_ = (attribute(tag, "byte_order") == "BigEndian") == (std::endian::native == std::endian::little);
    header_.bytes = attribute(tag, "header_type") == "UInt64" ? 8 : 4;
    const std::string_view compressor = attribute(tag, "compressor");
    packed_ = !compressor.empty();
    if (packed_ && compressor != "vtkZLibDataCompressor")
      fail_here("its data are packed by " + std::string(compressor) +
                "; vtkZLibDataCompressor or none is expected");
    const std::size_t appended = text_.find("<AppendedData", at_);
    if (appended != text_.npos) {
      const std::size_t mark = text_.find('_', text_.find('>', appended));
      const std::string_view opening(text_.data() + appended,
                                     std::min(text_.find('>', appended), text_.size()) - appended);
      raw_ = attribute(opening, "encoding") == "raw";
      if (mark != text_.npos)
        appended_ = std::string_view(text_).substr(mark + 1);
      end_ = appended;
    }
    if (text_.rfind("</VTKFile>") == text_.npos)
      fail("the end of the element VTKFile is missing: is the file truncated?");
  }

  /// The inside of the next tag before the appended data.
  std::optional<std::string_view> next_tag() {
    const std::size_t begin = text_.find('<', at_);
    if (begin >= end_)
      return std::nullopt;
    const std::size_t end = text_.find('>', begin);
    if (end >= end_)
      fail_here("a tag does not end");
    at_ = end + 1;
    return std::string_view(text_).substr(begin + 1, end - begin - 1);
  }
  static std::string_view name_of(std::string_view tag) {
    return tag.substr(0, tag.find_first_of(" \t\r\n/", 1));
  }
  /// Text up to the next tag.
  std::string_view content() const { return std::string_view(text_).substr(at_, text_.find('<', at_) - at_); }

  /// Value of an attribute; empty where it is missing.
  static std::string_view attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != tag.npos; at = tag.find(name, at + 1)) {
      const std::size_t equals = at + name.size();
      if (at == 0 || !is_blank(tag[at - 1]) || equals + 1 >= tag.size() || tag[equals] != '=')
        continue;
      const char quote = tag[equals + 1];
      return tag.substr(equals + 2, tag.find(quote, equals + 2) - equals - 2);
    }
    return {};
  }
  static std::size_t components(std::string_view tag) {
    return number_in<std::size_t>(attribute(tag, "NumberOfComponents")).value_or(1);
  }

  std::vector<double> values(std::string_view tag, std::string_view inside,
                             std::size_t expected_components) const {
    const std::string name(attribute(tag, "Name"));
    if (components(tag) != expected_components)
      fail_here("array '" + name + "' has " + std::to_string(components(tag)) + " components, " +
                std::to_string(expected_components) + " are expected");
    const VtkType type = VtkType::named(attribute(tag, "type"));
    if (type.kind == 0)
      fail_here("array '" + name + "' is of type '" + std::string(attribute(tag, "type")) +
                "', which is not known");
    const std::string_view format = attribute(tag, "format");
    std::vector<double> numbers;
    if (format == "ascii") {
      for (std::size_t at = 0; (at = inside.find_first_not_of(" \t\r\n", at)) != inside.npos;) {
        const std::size_t end = std::min(inside.find_first_of(" \t\r\n", at), inside.size());
        const auto value = number_in<double>(inside.substr(at, end - at));
        if (!value)
          fail_here("array '" + name + "' holds '" + std::string(inside.substr(at, end - at)) +
                    "', a number is expected");
        numbers.push_back(*value);
        at = end;
      }
      return numbers;
    }
    std::string_view data = trimmed(inside);
    bool raw = false;
    if (format == "appended") {
      const auto offset = number_in<std::size_t>(attribute(tag, "offset"));
      if (!offset || *offset >= appended_.size())
        fail_here("array '" + name + "' begins behind the end of the file");
      data = appended_.substr(*offset);
      raw = raw_;
    } else if (format != "binary") {
      fail_here("array '" + name + "' is of format '" + std::string(format) +
                "'; ascii, binary or appended is expected");
    }
    const auto bytes = raw ? decode_raw(data) : decode_text(data);
    if (!bytes || bytes->size() % type.bytes != 0)
      fail_here("array '" + name + "' is damaged or cut");
    for (std::size_t at = 0; at < bytes->size(); at += type.bytes)
      numbers.push_back(type.at(bytes->data() + at, reversed_));
    return numbers;
  }

  /// The k-th number of a head.
  std::size_t head(std::string_view bytes, std::size_t k) const {
    return static_cast<std::size_t>(header_.at(bytes.data() + k * header_.bytes, reversed_));
  }
  /// Numbers in a head: the length; packed: blocks, length of one, of the last, then the packed length of each.
  std::optional<std::size_t> head_numbers(std::string_view bytes) const {
    if (!packed_)
      return 1;
    if (bytes.size() < 3 * header_.bytes || head(bytes, 0) > text_.size())
      return std::nullopt;
    return 3 + head(bytes, 0);
  }

  std::optional<std::string> decode_raw(std::string_view data) const {
    const auto numbers = head_numbers(data);
    if (!numbers || data.size() < *numbers * header_.bytes)
      return std::nullopt;
    return unpack(data.substr(0, *numbers * header_.bytes), data.substr(*numbers * header_.bytes));
  }

  /// Base64: without packing head and data are one text, with it the head is a text of its own.
  std::optional<std::string> decode_text(std::string_view data) const {
    data = data.substr(0, data.find_first_of("<_"));
    const auto characters = [](std::size_t bytes) { return (bytes + 2) / 3 * 4; };
    const auto first = decode_base64(data.substr(0, characters(3 * header_.bytes)));
    if (!first || first->size() < header_.bytes)
      return std::nullopt;
    const auto numbers = head_numbers(*first);
    if (!numbers)
      return std::nullopt;
    if (!packed_) {
      const std::size_t length = head(*first, 0),
                        whole = characters(header_.bytes + std::min(length, data.size()));
      const auto all = decode_base64(data.substr(0, whole));
      if (!all || all->size() < header_.bytes)
        return std::nullopt;
      return unpack(std::string_view(*all).substr(0, header_.bytes),
                    std::string_view(*all).substr(header_.bytes));
    }
    const std::size_t split = characters(*numbers * header_.bytes);
    if (split > data.size())
      return std::nullopt;
    const auto heads = decode_base64(data.substr(0, split));
    if (!heads || heads->size() < *numbers * header_.bytes)
      return std::nullopt;
    std::size_t length = 0;
    for (std::size_t k = 3; k < *numbers; ++k)
      length += std::min(head(*heads, k), data.size());
    const auto body = decode_base64(data.substr(split, characters(length)));
    return body ? unpack(*heads, *body) : std::nullopt;
  }

  /// The array's bytes from head and body.
  std::optional<std::string> unpack(std::string_view heads, std::string_view body) const {
    if (!packed_) {
      const std::size_t length = head(heads, 0);
      return length <= body.size() ? std::optional(std::string(body.substr(0, length))) : std::nullopt;
    }
    const std::size_t blocks = head(heads, 0), full = head(heads, 1), last = head(heads, 2);
    std::string bytes;
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::size_t length = head(heads, 3 + block),
                        wanted = block + 1 == blocks && last > 0 ? last : full;
      if (length > body.size() || wanted > 2000 * (length + 1)) // zlib packs 1032 into 1 at best
        return std::nullopt;
      const auto part = Inflater(body.substr(0, length)).decode(wanted);
      if (!part)
        return std::nullopt;
      bytes += *part;
      body.remove_prefix(length);
    }
    return bytes;
  }

  std::filesystem::path path_;
  std::string text_;
  std::size_t at_ = 0, end_ = 0; ///< end of what is XML
  std::string_view appended_;
  VtkType header_{'u', 4};
  bool raw_ = false, packed_ = false, reversed_ = false;
  PointArrays arrays_;
};

} // namespace cdem::io::detail
