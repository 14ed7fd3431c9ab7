#pragma once

/// @file
/// What VTK's files are packed in: base64 (RFC 4648), and zlib's format (RFC 1950, 1951). Decoding alone, on strings in
/// memory, so that the headers need no library for it.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cdem::io::detail {

/// Bytes of base64 text; blanks are skipped, and it ends at the first padding. None if a character is no base64.
inline std::optional<std::string> decode_base64(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    std::uint32_t value = 0;
    if (c >= 'A' && c <= 'Z')
      value = static_cast<std::uint32_t>(c - 'A');
    else if (c >= 'a' && c <= 'z')
      value = static_cast<std::uint32_t>(c - 'a') + 26;
    else if (c >= '0' && c <= '9')
      value = static_cast<std::uint32_t>(c - '0') + 52;
    else if (c == '+' || c == '/')
      value = c == '+' ? 62 : 63;
    else if (c == ' ' || c == '\n' || c == '\r' || c == '\t')
      continue;
    else if (c == '=')
      break;
    else
      return std::nullopt;
    bits = bits << 6 | value;
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 0xff);
    }
  }
  return bytes;
}

/// Decoder of one zlib stream.
class Inflater {
public:
  explicit Inflater(std::string_view data) : data_(data) {}

  /// @param expected  bytes that must come out
  /// @return          none if the stream is damaged, cut, or gives another number of bytes
  std::optional<std::string> decode(std::size_t expected) {
    out_.reserve(expected);
    expected_ = expected;
    const std::uint32_t method = bits(8), flags = bits(8);
    if ((method & 15) != 8 || (method << 8 | flags) % 31 != 0 || (flags & 32) != 0)
      return std::nullopt;
    for (bool last = false; !last && !failed_;) {
      last = bits(1) == 1;
      switch (bits(2)) {
      case 0:
        stored();
        break;
      case 1:
        block(fixed_lengths(), Code(std::vector<std::uint8_t>(30, 5)));
        break;
      case 2:
        dynamic();
        break;
      default:
        failed_ = true;
      }
    }
    left_ = 0; // to the next whole byte
    std::uint32_t checksum = 0;
    for (int k = 0; k < 4; ++k)
      checksum = checksum << 8 | bits(8);
    if (failed_ || out_.size() != expected || checksum != adler())
      return std::nullopt;
    return std::move(out_);
  }

private:
  /// A canonical Huffman code: how many codes of each length, and the symbols in the order of their codes.
  struct Code {
    std::array<std::uint16_t, 16> count{};
    std::vector<std::uint16_t> symbol;

    explicit Code(const std::vector<std::uint8_t>& lengths) {
      for (const std::uint8_t length : lengths)
        ++count[length];
      count[0] = 0;
      for (std::uint8_t length = 1; length < 16; ++length)
        for (std::size_t s = 0; s < lengths.size(); ++s)
          if (lengths[s] == length)
            symbol.push_back(static_cast<std::uint16_t>(s));
    }
  };

  std::uint32_t bits(int wanted) {
    while (left_ < wanted) {
      if (at_ >= data_.size()) {
        failed_ = true;
        return 0;
      }
      buffer_ |= std::uint64_t{static_cast<unsigned char>(data_[at_++])} << left_;
      left_ += 8;
    }
    const auto value = static_cast<std::uint32_t>(buffer_ & ((std::uint64_t{1} << wanted) - 1));
    buffer_ >>= wanted;
    left_ -= wanted;
    return value;
  }

  /// The next symbol: codes of one length are consecutive numbers.
  std::uint32_t decode(const Code& code) {
    std::uint32_t word = 0, first = 0, index = 0;
    for (std::size_t length = 1; length < 16 && !failed_; ++length) {
      word |= bits(1);
      const std::uint32_t count = code.count[length];
      if (word - first < count)
        return code.symbol[index + word - first];
      index += count;
      first = (first + count) << 1;
      word <<= 1;
    }
    failed_ = true;
    return 0;
  }

  void put(char c) {
    if (out_.size() >= expected_)
      failed_ = true;
    else
      out_ += c;
  }

  void stored() {
    buffer_ = 0;
    left_ = 0;
    const std::uint32_t length = bits(16), complement = bits(16);
    if ((length ^ complement) != 0xffff || data_.size() - at_ < length)
      failed_ = true;
    for (std::uint32_t k = 0; k < length && !failed_; ++k)
      put(data_[at_++]);
  }

  static Code fixed_lengths() {
    std::vector<std::uint8_t> lengths(288, 8);
    std::fill(lengths.begin() + 144, lengths.begin() + 256, std::uint8_t{9});
    std::fill(lengths.begin() + 256, lengths.begin() + 280, std::uint8_t{7});
    return Code(lengths);
  }

  /// A block that brings its own two codes, themselves coded.
  void dynamic() {
    static constexpr std::array<std::uint8_t, 19> order{16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                        11, 4,  12, 3, 13, 2, 14, 1, 15};
    const std::uint32_t literals = bits(5) + 257, distances = bits(5) + 1, coded = bits(4) + 4;
    std::vector<std::uint8_t> lengths(19, 0);
    for (std::uint32_t k = 0; k < coded; ++k)
      lengths[order[k]] = static_cast<std::uint8_t>(bits(3));
    const Code lengths_code(lengths);
    lengths.clear();
    while (lengths.size() < literals + distances && !failed_) {
      const std::uint32_t symbol = decode(lengths_code);
      if (symbol < 16) {
        lengths.push_back(static_cast<std::uint8_t>(symbol));
        continue;
      }
      const std::uint8_t repeated = symbol == 16 && !lengths.empty() ? lengths.back() : std::uint8_t{0};
      failed_ = failed_ || (symbol == 16 && lengths.empty());
      lengths.insert(lengths.end(),
                     symbol == 16   ? 3 + bits(2)
                     : symbol == 17 ? 3 + bits(3)
                                    : 11 + bits(7),
                     repeated);
    }
    if (failed_ || lengths.size() != literals + distances) {
      failed_ = true;
      return;
    }
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(literals);
    block(Code({lengths.begin(), middle}), Code({middle, lengths.end()}));
  }

  /// Literals, and copies of what came before.
  void block(const Code& literals, const Code& distances) {
    while (!failed_) {
      const std::uint32_t symbol = decode(literals);
      if (symbol == 256)
        return;
      if (symbol < 256) {
        put(static_cast<char>(symbol));
        continue;
      }
      const std::uint32_t l = symbol - 257;
      std::uint32_t length = l + 3;
      if (l == 28)
        length = 258;
      else if (l >= 8) { // four symbols for each further bit
        const std::uint32_t extra = (l >> 2) - 1;
        length = 3 + ((4 + (l & 3)) << extra) + bits(static_cast<int>(extra));
      }
      const std::uint32_t d = decode(distances);
      std::uint32_t distance = d + 1;
      if (d >= 4) { // two symbols for each further bit
        const std::uint32_t extra = (d >> 1) - 1;
        distance = 1 + ((2 + (d & 1)) << extra) + bits(static_cast<int>(extra));
      }
      if (l > 28 || d > 29 || distance > out_.size())
        failed_ = true;
      for (std::uint32_t k = 0; k < length && !failed_; ++k)
        put(out_[out_.size() - distance]);
    }
  }

  std::uint32_t adler() const {
    std::uint32_t a = 1, b = 0;
    for (const char c : out_) {
      a = (a + static_cast<unsigned char>(c)) % 65521;
      b = (b + a) % 65521;
    }
    return b << 16 | a;
  }

  std::string_view data_;
  std::size_t at_ = 0;
  std::uint64_t buffer_ = 0;
  int left_ = 0; ///< bits in the buffer
  std::size_t expected_ = 0;
  std::string out_;
  bool failed_ = false;
};

} // namespace cdem::io::detail
