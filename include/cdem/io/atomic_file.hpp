#pragma once

/// @file
/// Files that appear whole or not at all.

#include <cdem/core/error.hpp>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace cdem::io {

/// A file under construction: written beside its final place under a temporary name ending in ".part", flushed to
/// the disk, and renamed by commit(). Until then an older file of that name stays as it is; a file that is
/// dropped without commit(), as an exception does, leaves nothing behind.
///
/// Every failure throws core::FileError, "cannot write <path>: <reason>".
class AtomicFile {
public:
  /// Opens the temporary file.
  /// @throws core::FileError if the folder is missing or cannot be written, or if `path` is something other than
  ///         a file (a folder, a device)
  explicit AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code error;
    const auto status = std::filesystem::status(path_, error);
    if (path_.empty() || path_.filename().empty())
      fail("the name of a file is expected");
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
      fail(std::filesystem::is_directory(status) ? "it is a folder" : "it is not a regular file");
    std::random_device random;
    for (int attempt = 0; attempt < 16 && !file_; ++attempt) {
      temporary_ = path_;
      temporary_ += "." + std::to_string(random()) + ".part";
      errno = 0;
      file_.reset(std::fopen(temporary_.c_str(), "wbx"));
      if (!file_ && errno != EEXIST)
        break;
    }
    if (!file_)
      fail(reason());
    std::setvbuf(file_.get(), buffer_.data(), _IOFBF, buffer_.size());
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() {
    if (!file_)
      return;
    file_.reset();
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
  }

  /// Where the file will stand.
  const std::filesystem::path& path() const noexcept { return path_; }
  /// Bytes written so far.
  std::uint64_t size() const noexcept { return size_; }

  /// Appends bytes.
  void write(const void* data, std::size_t bytes) {
    expect_open();
    errno = 0;
    if (bytes > 0 && std::fwrite(data, 1, bytes, file_.get()) != bytes)
      fail(reason());
    size_ += bytes;
  }
  /// Appends text.
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// Replaces bytes written before, such as a length in a header; the next write() appends again.
  void overwrite(std::uint64_t offset, const void* data, std::size_t bytes) {
    expect_open();
    core::expect(offset + bytes <= size_, "end of the bytes to overwrite", offset + bytes,
                 "at most the " + std::to_string(size_) + " bytes written are expected");
    errno = 0;
    if (std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0 ||
        std::fwrite(data, 1, bytes, file_.get()) != bytes || std::fseek(file_.get(), 0, SEEK_END) != 0)
      fail(reason());
  }

  /// Flushes, closes and gives the file its name.
  /// @throws core::FileError if the disk does not take all of it; nothing is left behind then
  void commit() {
    expect_open();
    errno = 0;
    if (std::fflush(file_.get()) != 0)
      fail(reason());
    if (fsync(fileno(file_.get())) != 0 && errno != EINVAL && errno != ENOTSUP) // some file systems cannot
      fail(reason());
    if (std::fclose(file_.release()) != 0)
      discard(reason());
    std::error_code error;
    std::filesystem::rename(temporary_, path_, error);
    if (error)
      discard(error.message());
  }

private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };

  static std::string reason() {
    return errno == 0 ? "unknown error" : std::generic_category().message(errno);
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError("cannot write " + path_.string() + ": " + why);
  }
  [[noreturn]] void discard(const std::string& why) const {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    fail(why);
  }
  void expect_open() const {
    if (!file_)
      fail("the file is already complete");
  }

  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::vector<char> buffer_ = std::vector<char>(1 << 18); ///< must outlive file_
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
};

} // namespace cdem::io
