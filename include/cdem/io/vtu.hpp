#pragma once

/// @file
/// Unstructured grids in VTK's XML format, for ParaView, VisIt, PyVista and meshio.

#include <cdem/io/atomic_file.hpp>
#include <cdem/io/detail/tuple.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <ranges>
#include <span>
#include <utility>
#include <vector>

namespace cdem::io {

/// Cell types, with VTK's numbers. The order of the corners is VTK's: a hexahedron has its lower face
/// counter-clockwise seen from above, then the upper face above it; a wedge one triangle, then the other.
enum class CellType : std::uint8_t { vertex = 1, line = 3, tetrahedron = 10, hexahedron = 12, wedge = 13 };

/// Corners of a cell.
constexpr std::size_t corners_of(CellType type) {
  switch (type) {
  case CellType::vertex:
    return 1;
  case CellType::line:
    return 2;
  case CellType::tetrahedron:
    return 4;
  case CellType::hexahedron:
    return 8;
  case CellType::wedge:
    return 6;
  }
  core::reject("cell type", static_cast<int>(type), "1, 3, 10, 12 or 13 is expected");
}

namespace detail {

/// VTK's name of a scalar type.
template <class T>
std::string vtk_name() {
  if constexpr (std::is_floating_point_v<T>) {
    static_assert(sizeof(T) <= 8, "VTK knows float and double");
    return "Float" + std::to_string(8 * sizeof(T));
  } else {
    return (std::is_signed_v<T> ? "Int" : "UInt") + std::to_string(8 * sizeof(T));
  }
}

/// Text inside an XML attribute or element.
inline std::string xml_text(std::string_view text) {
  std::string escaped;
  for (const char c : text)
    switch (c) {
    case '&':
      escaped += "&amp;";
      break;
    case '<':
      escaped += "&lt;";
      break;
    case '>':
      escaped += "&gt;";
      break;
    case '"':
      escaped += "&quot;";
      break;
    default:
      escaped += c;
    }
  return escaped;
}

inline void expect_array_name(std::string_view name) {
  bool printable = !name.empty();
  for (const char c : name)
    printable = printable && static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
  core::expect(printable, "name of an array", "'" + std::string(name) + "'",
               "a name without control characters is expected");
}

} // namespace detail

/// A named array to be written: what computes its values, not the values. Nothing is copied: the data a DataArray
/// was made from must live until the file is written.
class DataArray {
public:
  /// The values value(0) ... value(count - 1), each a number, a std::array of numbers or a fixed-size Eigen matrix.
  ///
  /// @param name   with the unit, such as "displacement [m]"
  /// @param value  called with a number in [0, count), in order, each time the file is written
  /// @throws core::InvalidInput for an empty name or one with control characters
  template <class Function>
  requires detail::TupleValue<std::decay_t<std::invoke_result_t<const Function&, std::size_t>>>
  DataArray(std::string name, std::size_t count, Function value) : name_(std::move(name)), count_(count) {
    using Value = std::decay_t<std::invoke_result_t<const Function&, std::size_t>>;
    using Tuple = detail::Tuple<Value>;
    using Scalar = typename Tuple::Scalar;
    detail::expect_array_name(name_);
    type_ = detail::vtk_name<Scalar>();
    components_ = Tuple::components;
    tuple_bytes_ = components_ * sizeof(Scalar);
    fill_ = [value = std::move(value)](std::size_t begin, std::size_t end, std::byte* out) {
      for (std::size_t i = begin; i < end; ++i) {
        const Value tuple = value(i);
        for (std::size_t c = 0; c < Tuple::components; ++c, out += sizeof(Scalar)) {
          const Scalar component = Tuple::component(tuple, c);
          std::memcpy(out, &component, sizeof(Scalar));
        }
      }
    };
  }

  /// The values of an array (std::vector, std::array, std::span) that lives until the file is written; a temporary
  /// container is refused by the compiler.
  template <class Range>
  requires std::ranges::contiguous_range<Range> && std::ranges::borrowed_range<Range> &&
      detail::TupleValue<std::ranges::range_value_t<Range>>
      DataArray(std::string name, Range&& values)
      : DataArray(std::move(name), std::ranges::size(values),
                  [data = std::ranges::cdata(values)](std::size_t i) { return data[i]; }) {}

  const std::string& name() const noexcept { return name_; }
  /// Number of values.
  std::size_t size() const noexcept { return count_; }
  /// Numbers in a value.
  std::size_t components() const noexcept { return components_; }
  /// Bytes of all the values.
  std::uint64_t bytes() const noexcept { return count_ * tuple_bytes_; }

  /// The <DataArray> element of the file's head.
  std::string element(std::uint64_t offset) const {
    return "<DataArray type=\"" + type_ + "\" Name=\"" + detail::xml_text(name_) +
           "\" NumberOfComponents=\"" + std::to_string(components_) + "\" NumberOfTuples=\"" +
           std::to_string(count_) + "\" format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
  }

  /// Writes the number of bytes (UInt64), then the values, through a buffer of 64 KiB.
  void write(AtomicFile& file) const {
    const std::uint64_t total = bytes();
    file.write(&total, sizeof total);
    const std::size_t block = std::max<std::size_t>(1, (std::size_t{1} << 16) / tuple_bytes_);
    std::vector<std::byte> buffer(block * tuple_bytes_);
    for (std::size_t begin = 0; begin < count_; begin += block) {
      const std::size_t end = std::min(count_, begin + block);
      fill_(begin, end, buffer.data());
      file.write(buffer.data(), (end - begin) * tuple_bytes_);
    }
  }

private:
  std::string name_;
  std::size_t count_;
  std::size_t components_ = 0;
  std::size_t tuple_bytes_ = 0;
  std::string type_;
  std::function<void(std::size_t, std::size_t, std::byte*)> fill_;
};

/// An unstructured grid and its data, written as a `.vtu` file: XML head, then raw binary (appended, UInt64 headers,
/// the machine's byte order). The memory needed is a small buffer, whatever the size of the grid; the arrays it is
/// given must live until the file is written.
///
///     io::Vtu grid(positions);
///     grid.cells(io::CellType::line, pairs);              // corners one after the other, two a line
///     grid.cell_data({"force [N]", forces});
///     grid.field_data("TimeValue", 0.5);                  // ParaView's name for the time, s
///     grid.write("bonds.vtu");
///
/// Values that are not finite are written as they are; a point must be finite.
class Vtu {
public:
  /// @param points  [points] m
  explicit Vtu(std::span<const Vec3> points)
      : Vtu(points.size(), [points](std::size_t i) { return points[i]; }) {}
  explicit Vtu(std::vector<Vec3>&&) = delete; // it would not live until the file is written

  /// @param point  computes the points: a Vector3 of float or double, m, for each number in [0, count)
  template <class Function>
  Vtu(std::size_t count, Function point)
      : points_("Points", count, [point = std::move(point)](std::size_t i) {
          const auto p = point(i);
          static_assert(detail::Tuple<std::decay_t<decltype(p)>>::components == 3);
          for (int k = 0; k < 3; ++k)
            if (!std::isfinite(p[k])) [[unlikely]]
              core::reject(std::string("coordinate ") + "xyz"[k] + " of point " + std::to_string(i), p[k],
                           "a finite number is expected");
          return p;
        }) {}

  std::size_t point_count() const noexcept { return points_.size(); }
  std::size_t cell_count() const noexcept { return cell_count_; }

  /// Adds `count` cells of one type. `corner(k)` is the number of a point: corner k % n of cell k / n, with n corners
  /// a cell. Numbers are checked while the file is written.
  template <class Function>
  requires std::integral<std::decay_t<std::invoke_result_t<const Function&, std::size_t>>>
  void cells(CellType type, std::size_t count, Function corner) {
    const auto checked = [corner = std::move(corner), points = point_count()](std::size_t k) {
      const auto point = corner(k);
      if (!(std::cmp_greater_equal(point, 0) && std::cmp_less(point, points))) [[unlikely]]
        core::reject("corner of a cell", point,
                     "the number of a point, below " + std::to_string(points) + ", is expected");
      return static_cast<std::int64_t>(point);
    };
    blocks_.push_back({type, cell_count_, corner_count_, checked});
    cell_count_ += count;
    corner_count_ += count * corners_of(type);
  }

  /// Adds the cells of one type whose corners are listed one after the other.
  /// @param corners  [cells x corners of the type], must live until the file is written; a temporary container is
  ///                 refused by the compiler
  /// @throws core::InvalidInput unless it holds whole cells
  template <class Range>
  requires std::ranges::contiguous_range<Range> && std::ranges::borrowed_range<Range> &&
      std::integral<std::ranges::range_value_t<Range>>
  void cells(CellType type, Range&& corners) {
    const std::size_t count = std::ranges::size(corners);
    core::expect(count % corners_of(type) == 0, "number of corners", count,
                 "a multiple of " + std::to_string(corners_of(type)) + " is expected");
    cells(type, count / corners_of(type),
          [data = std::ranges::cdata(corners)](std::size_t k) { return data[k]; });
  }

  /// Makes each point a cell, so that it is drawn.
  void vertices() {
    cells(CellType::vertex, point_count(), [](std::size_t k) { return k; });
  }

  /// Adds an array of one value a point.
  /// @throws core::InvalidInput for another number of values, or a name that is there already
  void point_data(DataArray array) { add(point_data_, std::move(array), point_count(), "point"); }

  /// Adds an array of one value a cell; the cells are added first.
  /// @throws core::InvalidInput for another number of values, or a name that is there already
  void cell_data(DataArray array) { add(cell_data_, std::move(array), cell_count_, "cell"); }

  /// Adds a number of the whole grid. ParaView takes "TimeValue" for the time.
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void field_data(std::string name, Number value) {
    field_numbers_.push_back(DataArray(std::move(name), 1, [value](std::size_t) { return value; }));
  }

  /// Adds a text of the whole grid, such as a title.
  void field_data(std::string name, std::string_view text) {
    detail::expect_array_name(name);
    std::string codes;
    for (const char c : text)
      codes += std::to_string(static_cast<unsigned char>(c)) + " ";
    field_texts_ += "<DataArray type=\"String\" Name=\"" + detail::xml_text(name) +
                    "\" NumberOfTuples=\"1\" format=\"ascii\">" + codes + "0</DataArray>\n";
  }

  /// Writes the file.
  ///
  /// @throws core::InvalidInput if cells were added after cell data, a point is not finite or a corner is not a
  ///         point
  /// @throws core::FileError    if the file cannot be written; nothing is left behind, see AtomicFile
  /// @complexity O(bytes of the file)
  void write(const std::filesystem::path& path) const {
    for (const DataArray& array : cell_data_)
      expect_count(array, cell_count_, "cell");
    const std::vector<DataArray> structure{points_, connectivity(), offsets(), types()};
    const auto first = structure.begin();

    std::uint64_t offset = 0;
    AtomicFile file(path);
    file.write("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"" +
               std::string(std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian") +
               "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n");
    file.write("<FieldData>\n" + field_texts_ + elements(field_numbers_, offset) + "</FieldData>\n");
    file.write("<Piece NumberOfPoints=\"" + std::to_string(point_count()) + "\" NumberOfCells=\"" +
               std::to_string(cell_count_) + "\">\n");
    file.write("<PointData>\n" + elements(point_data_, offset) + "</PointData>\n");
    file.write("<CellData>\n" + elements(cell_data_, offset) + "</CellData>\n");
    file.write("<Points>\n" + elements({first, first + 1}, offset) + "</Points>\n");
    file.write("<Cells>\n" + elements({first + 1, structure.end()}, offset) + "</Cells>\n");
    file.write("</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
    for (const auto* arrays : {&field_numbers_, &point_data_, &cell_data_, &structure})
      for (const DataArray& array : *arrays)
        array.write(file);
    file.write("\n</AppendedData>\n</VTKFile>\n");
    file.commit();
  }

private:
  /// Consecutive cells of one type.
  struct Block {
    CellType type;
    std::size_t first_cell;
    std::size_t first_corner;
    std::function<std::int64_t(std::size_t)> corner;
  };

  /// The block that holds a cell or a corner: the last one with cells that begins at or before it.
  const Block& block_of(std::size_t number, std::size_t Block::*first) const {
    std::size_t b = blocks_.size() - 1;
    while (blocks_[b].*first > number)
      --b;
    return blocks_[b];
  }

  DataArray connectivity() const {
    return {"connectivity", corner_count_, [this](std::size_t i) {
              const Block& block = block_of(i, &Block::first_corner);
              return block.corner(i - block.first_corner);
            }};
  }
  /// VTK's offset of a cell is the end of its corners.
  DataArray offsets() const {
    return {"offsets", cell_count_, [this](std::size_t c) {
              const Block& block = block_of(c, &Block::first_cell);
              return static_cast<std::int64_t>(block.first_corner +
                                               (c - block.first_cell + 1) * corners_of(block.type));
            }};
  }
  DataArray types() const {
    return {"types", cell_count_, [this](std::size_t c) {
              return static_cast<std::uint8_t>(block_of(c, &Block::first_cell).type);
            }};
  }

  static void expect_count(const DataArray& array, std::size_t count, const char* what) {
    core::expect(array.size() == count, "number of values of '" + array.name() + "'", array.size(),
                 std::string("one a ") + what + " (" + std::to_string(count) + ") is expected");
  }

  static void add(std::vector<DataArray>& arrays, DataArray array, std::size_t count, const char* what) {
    expect_count(array, count, what);
    for (const DataArray& other : arrays)
      core::expect(other.name() != array.name(), "name of an array", "'" + array.name() + "'",
                   "a name that is not there already is expected");
    arrays.push_back(std::move(array));
  }

  /// The elements of `arrays`; advances the offset past their data.
  static std::string elements(std::span<const DataArray> arrays, std::uint64_t& offset) {
    std::string text;
    for (const DataArray& array : arrays) {
      text += array.element(offset);
      offset += sizeof(std::uint64_t) + array.bytes();
    }
    return text;
  }

  DataArray points_;
  std::vector<Block> blocks_;
  std::vector<DataArray> point_data_, cell_data_, field_numbers_;
  std::string field_texts_;
  std::size_t cell_count_ = 0;
  std::size_t corner_count_ = 0;
};

} // namespace cdem::io
