#pragma once

/// @file
/// Named arrays in one binary file that notices when it was damaged.
///
/// The file, all numbers in the byte order of the machine that wrote it:
///
///     head      8 bytes  89 "cdem" 0d 0a 1a: no text file begins so, and a transfer as text breaks it
///               4 bytes  number of the format, 1
///               4 bytes  0x01020304, shows another byte order
///               8 bytes  length of the file
///               8 bytes  checksum of all that follows
///     section   48 bytes name, filled up with zeros
///               1 byte   'f' floating-point, 'i' signed, 'u' unsigned
///               1 byte   bytes of a number
///               2 bytes  zero
///               4 bytes  numbers in an element: 3 for a vector
///               8 bytes  number of elements
///               the elements, filled up with zeros to a multiple of 8 bytes
///     section   ...

#include <cdem/io/atomic_file.hpp>
#include <cdem/io/detail/tuple.hpp>

#include <algorithm>
#include <cstring>
#include <ranges>
#include <span>
#include <vector>

namespace cdem::io {

namespace detail {

/// 64-bit checksum of a sequence of 8-byte words: h = mix(h ^ word), with mix a multiplication by an odd number and
/// an exclusive-or with its upper half (FNV-1a on words, with the upper bits brought down). Both are one to one, so
/// that a change within one word is always noticed.
class Checksum {
public:
  /// @param bytes  a multiple of 8
  void update(const std::byte* data, std::size_t bytes) {
    for (std::size_t at = 0; at < bytes; at += 8) {
      std::uint64_t word;
      std::memcpy(&word, data + at, 8);
      value_ = (value_ ^ word) * 0x9e3779b97f4a7c15u;
      value_ ^= value_ >> 32;
    }
  }
  std::uint64_t value() const noexcept { return value_; }

private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

struct CheckpointHead {
  std::array<unsigned char, 8> magic{0x89, 'c', 'd', 'e', 'm', 0x0d, 0x0a, 0x1a};
  std::uint32_t version = 1;
  std::uint32_t byte_order = 0x01020304;
  std::uint64_t length = 0;
  std::uint64_t checksum = 0;
};
static_assert(sizeof(CheckpointHead) == 32);

/// What the elements of a section are.
struct ElementType {
  char kind = 'f';
  std::uint8_t bytes = 8;
  std::uint16_t zero = 0;
  std::uint32_t components = 1;

  friend bool operator==(const ElementType&, const ElementType&) = default;

  std::uint64_t element_bytes() const noexcept { return std::uint64_t{bytes} * components; }

  std::string text() const {
    const std::string number = (kind == 'f'   ? "float"
                                : kind == 'i' ? "int"
                                              : "unsigned int") +
                               std::to_string(8 * bytes);
    return components == 1 ? number : std::to_string(components) + " x " + number;
  }
};

template <TupleValue T>
constexpr ElementType element_type() {
  using Scalar = typename Tuple<T>::Scalar;
  static_assert(sizeof(T) == Tuple<T>::components * sizeof(Scalar), "elements without holes are expected");
  const char kind = std::is_floating_point_v<Scalar> ? 'f' : std::is_signed_v<Scalar> ? 'i' : 'u';
  return {kind, sizeof(Scalar), 0, Tuple<T>::components};
}

struct SectionHead {
  std::array<char, 48> name{};
  ElementType type;
  std::uint64_t count = 0;
};
static_assert(sizeof(SectionHead) == 64);

} // namespace detail

/// Writes named arrays into a checkpoint, one after the other; the file appears with commit().
///
///     io::CheckpointWriter checkpoint("state.cdem");
///     checkpoint.add("displacement", motion.displacement);
///     checkpoint.add("step", motion.step);
///     checkpoint.commit();
class CheckpointWriter {
public:
  /// @throws core::FileError if the file cannot be written
  explicit CheckpointWriter(std::filesystem::path path) : file_(std::move(path)) {
    const detail::CheckpointHead unfinished;
    file_.write(&unfinished, sizeof unfinished);
  }

  /// Adds an array: numbers, std::array, fixed-size Eigen vectors and matrices, particles::Spatial.
  ///
  /// @throws core::InvalidInput unless `name` has 1 to 47 bytes, none of them zero, and is new
  /// @throws core::FileError    if the disk does not take it
  /// @complexity O(bytes), no copy
  template <std::ranges::contiguous_range Range>
  requires detail::TupleValue<std::ranges::range_value_t<Range>>
  void add(std::string_view name, const Range& elements) {
    using Element = std::ranges::range_value_t<Range>;
    detail::SectionHead head;
    core::expect(!name.empty() && name.size() < head.name.size() && name.find('\0') == name.npos,
                 "name of a section", "'" + std::string(name) + "'", "1 to 47 bytes are expected");
    core::expect(std::find(names_.begin(), names_.end(), name) == names_.end(), "name of a section",
                 "'" + std::string(name) + "'", "a name that is not there already is expected");
    names_.emplace_back(name);
    name.copy(head.name.data(), name.size());
    head.type = detail::element_type<Element>();
    head.count = std::ranges::size(elements);
    append(&head, sizeof head);
    append(std::ranges::cdata(elements), head.count * sizeof(Element));
  }

  /// Adds one number.
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void add(std::string_view name, Number value) { add(name, std::array{value}); }

  /// Adds a text.
  void add(std::string_view name, const char* text) { add(name, std::string_view(text)); }

  /// Writes length and checksum into the head and completes the file.
  /// @throws core::FileError if the disk does not take it; nothing is left behind then
  void commit() {
    detail::CheckpointHead head;
    head.length = file_.size();
    head.checksum = checksum_.value();
    file_.overwrite(0, &head, sizeof head);
    file_.commit();
  }

private:
  /// Appends bytes, filled up to whole words.
  void append(const void* data, std::size_t bytes) {
    if (bytes == 0)
      return;
    const std::size_t whole = bytes / 8 * 8;
    const auto* first = static_cast<const std::byte*>(data);
    checksum_.update(first, whole);
    file_.write(first, whole);
    if (whole < bytes) {
      std::array<std::byte, 8> rest{};
      std::memcpy(rest.data(), first + whole, bytes - whole);
      checksum_.update(rest.data(), rest.size());
      file_.write(rest.data(), rest.size());
    }
  }

  AtomicFile file_;
  detail::Checksum checksum_;
  std::vector<std::string> names_;
};

/// Reads the named arrays of a checkpoint. The whole file is checked when it is opened; arrays are read on demand.
///
/// Every failure throws core::FileError, "cannot read <path>: <what is wrong>".
class CheckpointReader {
public:
  /// Opens and checks the file.
  /// @throws core::FileError if it is missing, no checkpoint, of another version or byte order, truncated or altered
  /// @complexity O(bytes of the file), a small buffer
  explicit CheckpointReader(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code error;
    if (std::filesystem::is_directory(path_, error))
      fail("it is a folder");
    errno = 0;
    file_.reset(std::fopen(path_.c_str(), "rb"));
    if (!file_)
      fail(std::generic_category().message(errno));
    check_whole(std::filesystem::file_size(path_, error));
    list_sections();
  }

  /// Whether there is a section of this name.
  bool has(std::string_view name) const { return find(name) != nullptr; }

  /// Names of the sections, in the order they were added.
  std::vector<std::string> names() const {
    std::vector<std::string> list;
    for (const Section& section : sections_)
      list.push_back(section.name);
    return list;
  }

  /// Reads an array into `elements`, a std::vector or std::string of any allocator, which is resized.
  /// @throws core::FileError if it is not there or holds elements of another type; says which there are
  template <class Container>
  void read(std::string_view name, Container& elements) const {
    using Element = typename Container::value_type;
    const Section& section = at(name);
    if (section.type != detail::element_type<Element>())
      fail("section '" + section.name + "' holds " + section.type.text() + ", " +
           detail::element_type<Element>().text() + " is expected");
    elements.resize(section.count);
    seek(section.offset);
    get(elements.data(), section.count * sizeof(Element));
  }

  /// Reads an array.
  template <class Element>
  std::vector<Element> read(std::string_view name) const {
    std::vector<Element> elements;
    read(name, elements);
    return elements;
  }

  /// Reads one number.
  template <class Number>
  Number read_value(std::string_view name) const {
    const auto elements = read<Number>(name);
    if (elements.size() != 1)
      fail("section '" + std::string(name) + "' holds " + std::to_string(elements.size()) +
           " values, 1 is expected");
    return elements.front();
  }

  /// Reads a text.
  std::string read_text(std::string_view name) const {
    std::string text;
    read(name, text);
    return text;
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError("cannot read " + path_.string() + ": " + why);
  }

private:
  struct Section {
    std::string name;
    detail::ElementType type;
    std::uint64_t count;
    std::uint64_t offset; ///< of the first element in the file
  };

  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };

  void check_whole(std::uint64_t length) {
    const detail::CheckpointHead good;
    detail::CheckpointHead head;
    if (length < sizeof head)
      fail("it is no checkpoint, " + std::to_string(length) + " bytes are too few");
    get(&head, sizeof head);
    if (head.magic != good.magic)
      fail("it is no checkpoint, its first bytes are others");
    if (head.byte_order != good.byte_order)
      fail("it was written on a machine of another byte order");
    if (head.version != good.version)
      fail("its format is version " + std::to_string(head.version) + ", this program reads version " +
           std::to_string(good.version));
    if (head.length != length)
      fail("it has " + std::to_string(length) + " bytes where " + std::to_string(head.length) +
           " were written" + (length < head.length ? ": it is truncated" : ""));
    detail::Checksum checksum;
    std::vector<std::byte> buffer(1 << 16);
    for (std::uint64_t left = length - sizeof head; left > 0;) {
      const auto bytes = static_cast<std::size_t>(std::min<std::uint64_t>(left, buffer.size()));
      get(buffer.data(), bytes);
      std::fill(buffer.begin() + static_cast<std::ptrdiff_t>(bytes), buffer.end(), std::byte{});
      checksum.update(buffer.data(), (bytes + 7) / 8 * 8);
      left -= bytes;
    }
    if (checksum.value() != head.checksum)
      fail("its checksum is wrong: it was altered after it was written");
    end_ = length;
  }

  void list_sections() {
    for (std::uint64_t offset = sizeof(detail::CheckpointHead); offset < end_;) {
      detail::SectionHead head;
      if (end_ - offset < sizeof head)
        fail("its last section is incomplete");
      seek(offset);
      get(&head, sizeof head);
      offset += sizeof head;
      const std::uint64_t element = head.type.element_bytes();
      if (head.name.back() != '\0' || element == 0 || head.count > (end_ - offset) / element)
        fail("the head of section " + std::to_string(sections_.size() + 1) + " makes no sense");
      sections_.push_back({head.name.data(), head.type, head.count, offset});
      offset += (head.count * element + 7) / 8 * 8;
    }
  }

  const Section* find(std::string_view name) const {
    const auto found =
        std::find_if(sections_.begin(), sections_.end(), [&](const Section& s) { return s.name == name; });
    return found == sections_.end() ? nullptr : &*found;
  }

  const Section& at(std::string_view name) const {
    if (const Section* section = find(name))
      return *section;
    std::string known;
    for (const Section& section : sections_)
      known += (known.empty() ? "" : ", ") + section.name;
    fail("it has no section '" + std::string(name) + "'; there are: " + known);
  }

  void seek(std::uint64_t offset) const {
    if (std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0)
      fail(std::generic_category().message(errno));
  }

  void get(void* data, std::size_t bytes) const {
    if (bytes > 0 && std::fread(data, 1, bytes, file_.get()) != bytes)
      fail("it cannot be read to its end");
  }

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t end_ = 0; ///< bytes of the file
  std::vector<Section> sections_;
};

} // namespace cdem::io
