#pragma once

/// @file
/// Gmsh's mesh files: the cursor over text and binary numbers, and the sections.

#include <cdem/geometry/mesh.hpp>
#include <cdem/io/detail/line_reader.hpp>

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <unordered_map>

namespace cdem::io::detail {

/// Walks through a file whose numbers are either text, in rows of one line each, or binary.
class GmshCursor {
public:
  explicit GmshCursor(std::filesystem::path path) : path_(std::move(path)), text_(whole_file(path_)) {}

  bool binary = false;

  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError(
        "cannot read " + path_.string() +
        (binary ? ": after byte " + std::to_string(at_) : ": line " + std::to_string(line_)) + ": " + why);
  }

  /// The next line that is not blank, trimmed; none at the end of the file.
  std::optional<std::string_view> line() {
    while (at_ < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', at_), text_.size());
      const std::string_view found = trimmed(std::string_view(text_).substr(at_, end - at_));
      begin_line(std::min(end + 1, text_.size()));
      if (!found.empty())
        return found;
    }
    return std::nullopt;
  }
  void expect_line(std::string_view wanted) {
    const auto found = line();
    if (found != wanted)
      fail((found ? "'" + std::string(found->substr(0, 40)) + "' stands here, '" : "the file ends here, '") +
           std::string(wanted) + "' is expected");
  }
  /// Goes behind the line "$End<name>".
  void skip_section(std::string_view name) {
    const std::string end = "$End" + std::string(name);
    const std::size_t found = text_.find("\n" + end, at_ > 0 ? at_ - 1 : 0);
    if (found == text_.npos)
      fail("the section $" + std::string(name) + " has no '" + end + "': is the file truncated?");
    line_ +=
        static_cast<std::size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                            text_.begin() + static_cast<std::ptrdiff_t>(found) + 1, '\n'));
    at_ = found + 1;
    expect_line(end);
  }

  /// Begins a row of numbers: in text, a line. `what` it holds is expected.
  void row(const char* what) {
    row_ = what;
    if (binary)
      return;
    const auto found = line();
    if (!found)
      fail("the file ends here, " + row_ + " is expected");
    split(*found, ' ', fields_);
    field_ = 0;
  }
  /// Ends a row: in text, nothing may follow.
  void end_row() const {
    if (!binary && field_ != fields_.size())
      fail("'" + std::string(fields_[field_]) + "' follows " + row_ + ", " + std::to_string(field_) +
           " numbers are expected");
  }
  /// The next number of the row.
  template <class Number>
  Number next(const char* name) {
    Number value{};
    if (binary) {
      if (text_.size() - at_ < sizeof value)
        fail(std::string("the file ends here, ") + name + " of " + row_ + " is expected");
      std::memcpy(&value, text_.data() + at_, sizeof value);
      at_ += sizeof value;
    } else {
      if (field_ == fields_.size())
        fail(std::string("the line ends here, ") + name + " of " + row_ + " is expected");
      const auto read = number_in<Number>(fields_[field_]);
      if (!read)
        fail(std::string(name) + " of " + row_ + " is '" + std::string(fields_[field_].substr(0, 40)) +
             "', " + (std::is_floating_point_v<Number> ? "a number" : "a whole number") + " is expected");
      value = *read;
      ++field_;
    }
    if constexpr (std::is_floating_point_v<Number>)
      if (!std::isfinite(value))
        fail(std::string(name) + " of " + row_ + " is " + core::to_text(value) +
             ", a finite number is expected");
    return value;
  }
  /// The number of things that follow, each of a byte at least.
  std::size_t count(const char* name) {
    const auto value = next<std::uint64_t>(name);
    if (value > text_.size())
      fail(std::string(name) + " is " + std::to_string(value) + ", more than the file can hold");
    return static_cast<std::size_t>(value);
  }
  /// Passes over what is left of the row: in text, anything; in binary, so many bytes.
  void skip_rest(std::size_t bytes) {
    if (binary && text_.size() - at_ < bytes)
      fail("the file ends here, " + row_ + " is expected");
    at_ += binary ? bytes : 0;
    field_ = fields_.size();
  }

private:
  void begin_line(std::size_t at) {
    at_ = at;
    ++line_;
  }

  std::filesystem::path path_;
  std::string text_;
  std::size_t at_ = 0, line_ = 0; ///< the next byte; lines read so far
  std::string row_;
  std::vector<std::string_view> fields_;
  std::size_t field_ = 0;
};

/// Reads the nodes and the volume elements of a mesh file.
class GmshReader {
public:
  explicit GmshReader(const std::filesystem::path& path) : in_(path) {}

  geometry::Mesh read() {
    read_format();
    while (const auto line = in_.line()) {
      if (line->front() != '$')
        in_.fail("'" + std::string(line->substr(0, 40)) +
                 "' stands here, a section such as $Nodes is expected");
      const std::string name(line->substr(1));
      if (name == "Nodes")
        version_ == 2 ? read_nodes_2() : read_nodes_4();
      else if (name == "Elements")
        version_ == 2 ? read_elements_2() : read_elements_4();
      else if (name == "PartitionedEntities")
        in_.fail("the mesh is partitioned, a whole one is expected");
      else {
        in_.skip_section(name);
        continue;
      }
      in_.expect_line("$End" + name);
    }
    if (mesh_.cell_count() == 0)
      in_.fail("the file ends here, and without any tetrahedron, wedge or hexahedron: a mesh of a volume is "
               "expected");
    keep_used_nodes();
    return std::move(mesh_);
  }

private:
  /// An element type: its corners, and whether it is one of ours.
  struct Kind {
    std::size_t nodes;
    bool volume;
  };

  Kind kind_of(std::int32_t type) const {
    static constexpr std::array<std::uint8_t, 20> nodes{0, 2,  3,  4,  4,  8, 6, 5,  3,  6,
                                                        9, 10, 27, 18, 14, 1, 8, 20, 15, 13};
    if (type == 4 || type == 5 || type == 6)
      return {nodes[static_cast<std::size_t>(type)], true};
    if (type < 1 || type > 19 || type == 7 || (type >= 11 && type <= 14) || type >= 17)
      in_.fail("element type " + std::to_string(type) +
               (type == 7               ? " (pyramid)"
                : type < 1 || type > 19 ? ""
                                        : " (of second order)") +
               " is not read; tetrahedra (4), hexahedra (5) and wedges (6) of first order are expected");
    return {nodes[static_cast<std::size_t>(type)], false};
  }

  void read_format() {
    in_.expect_line("$MeshFormat");
    in_.row("version, file type and data size");
    const auto version = in_.next<double>("version");
    const auto type = in_.next<std::int32_t>("file type");
    const auto size = in_.next<std::int32_t>("data size");
    in_.end_row();
    if (version != 4.1 && version != 2.2)
      in_.fail("version is " + core::to_text(version) + ", 4.1 or 2.2 is expected");
    version_ = version == 2.2 ? 2 : 4;
    if (type < 0 || type > 1 || (type == 1 && version_ == 2))
      in_.fail(
          "file type is " + std::to_string(type) +
          (version_ == 2 ? ", text (0) is expected of version 2.2" : ", text (0) or binary (1) is expected"));
    if (size != 8)
      in_.fail("data size is " + std::to_string(size) + ", 8 is expected");
    in_.binary = type == 1;
    if (in_.binary) {
      in_.row("the mark of the byte order");
      if (in_.next<std::int32_t>("1") != 1)
        in_.fail("the mark of the byte order is not 1: the file is of a machine of the other byte order");
    }
    in_.expect_line("$EndMeshFormat");
  }

  void add_node(std::uint64_t tag, const Vec3& position) {
    if (!node_of_.emplace(tag, static_cast<std::uint32_t>(mesh_.nodes.size())).second)
      in_.fail("node " + std::to_string(tag) + " stands here a second time");
    mesh_.nodes.push_back(position);
  }
  Vec3 position() {
    const auto x = in_.next<double>("x"), y = in_.next<double>("y");
    return {x, y, in_.next<double>("z")};
  }

  void read_nodes_2() {
    in_.row("the number of nodes");
    const std::size_t count = in_.count("number of nodes");
    in_.end_row();
    for (std::size_t n = 0; n < count; ++n) {
      in_.row("a node");
      const auto tag = in_.next<std::uint64_t>("tag");
      add_node(tag, position());
      in_.end_row();
    }
  }

  void read_nodes_4() {
    const auto [blocks, count] = section_head("the head of $Nodes", "number of nodes");
    for (std::size_t block = 0; block < blocks; ++block) {
      in_.row("the head of a block of nodes");
      const auto dimension = in_.next<std::int32_t>("dimension");
      in_.next<std::int32_t>("entity");
      const bool parametric = in_.next<std::int32_t>("parametric") != 0;
      std::vector<std::uint64_t> tags(in_.count("number of nodes in the block"));
      in_.end_row();
      if (dimension < 0 || dimension > 3)
        in_.fail("dimension is " + std::to_string(dimension) + ", 0 to 3 is expected");
      for (std::uint64_t& tag : tags) {
        in_.row("a node's tag");
        tag = in_.next<std::uint64_t>("tag");
        in_.end_row();
      }
      for (const std::uint64_t tag : tags) {
        in_.row("a node's position");
        add_node(tag, position());
        if (parametric)
          in_.skip_rest(sizeof(double) * static_cast<std::size_t>(dimension));
        in_.end_row();
      }
    }
    if (mesh_.nodes.size() != count)
      in_.fail("the blocks hold " + std::to_string(mesh_.nodes.size()) + " nodes, the head of $Nodes says " +
               std::to_string(count));
  }

  void read_elements_2() {
    in_.row("the number of elements");
    const std::size_t count = in_.count("number of elements");
    in_.end_row();
    for (std::size_t n = 0; n < count; ++n) {
      in_.row("an element");
      in_.next<std::uint64_t>("tag");
      const auto type = in_.next<std::int32_t>("type");
      const Kind kind = kind_of(type);
      for (std::size_t tags = in_.count("number of tags"); tags > 0; --tags)
        in_.next<std::int64_t>("tag");
      read_corners(type, kind);
    }
  }

  void read_elements_4() {
    const auto [blocks, count] = section_head("the head of $Elements", "number of elements");
    std::size_t read = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
      in_.row("the head of a block of elements");
      in_.next<std::int32_t>("dimension");
      in_.next<std::int32_t>("entity");
      const auto type = in_.next<std::int32_t>("element type");
      const std::size_t in_block = in_.count("number of elements in the block");
      in_.end_row();
      const Kind kind = kind_of(type);
      for (std::size_t n = 0; n < in_block; ++n) {
        in_.row("an element");
        in_.next<std::uint64_t>("tag");
        read_corners(type, kind);
      }
      read += in_block;
    }
    if (read != count)
      in_.fail("the blocks hold " + std::to_string(read) + " elements, the head of $Elements says " +
               std::to_string(count));
  }

  /// Numbers of blocks and of what they hold; least and largest tag follow.
  std::pair<std::size_t, std::size_t> section_head(const char* what, const char* name) {
    in_.row(what);
    const std::size_t blocks = in_.count("number of blocks"), count = in_.count(name);
    in_.next<std::uint64_t>("least tag");
    in_.next<std::uint64_t>("largest tag");
    in_.end_row();
    return {blocks, count};
  }

  /// Reads the corners of an element, the rest of its row; keeps those of a volume.
  void read_corners(std::int32_t type, const Kind& kind) {
    std::array<std::uint32_t, 8> corner{};
    for (std::size_t k = 0; k < kind.nodes; ++k) {
      const auto tag = in_.next<std::uint64_t>("corner");
      if (!kind.volume)
        continue;
      const auto node = node_of_.find(tag);
      if (node == node_of_.end())
        in_.fail("a corner is the node " + std::to_string(tag) +
                 ", a node that $Nodes (it stands before $Elements) holds is expected");
      corner[k] = node->second;
    }
    in_.end_row();
    const auto& c = corner;
    if (type == 4)
      mesh_.tetrahedra.push_back({c[0], c[1], c[2], c[3]});
    else if (type == 5)
      mesh_.hexahedra.push_back(c);
    else if (type == 6) // VTK's first triangle is turned outwards, Gmsh's inwards
      mesh_.wedges.push_back({c[0], c[2], c[1], c[3], c[5], c[4]});
  }

  void keep_used_nodes() {
    constexpr auto unused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(mesh_.nodes.size(), unused);
    for (std::size_t cell = 0; cell < mesh_.cell_count(); ++cell)
      for (const auto node : mesh_.corners(cell))
        number[node] = 0;
    std::uint32_t used = 0;
    for (std::size_t node = 0; node < number.size(); ++node)
      if (number[node] != unused) {
        mesh_.nodes[used] = mesh_.nodes[node];
        number[node] = used++;
      }
    mesh_.nodes.resize(used);
    const auto renumber = [&](auto& cells) {
      for (auto& cell : cells)
        for (auto& node : cell)
          node = number[node];
    };
    renumber(mesh_.tetrahedra);
    renumber(mesh_.wedges);
    renumber(mesh_.hexahedra);
  }

  GmshCursor in_;
  int version_ = 0;
  geometry::Mesh mesh_;
  std::unordered_map<std::uint64_t, std::uint32_t> node_of_; ///< from a node's tag
};

} // namespace cdem::io::detail
