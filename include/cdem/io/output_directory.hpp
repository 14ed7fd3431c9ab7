#pragma once

/// @file
/// The folder a run writes into.

#include <cdem/io/atomic_file.hpp>

namespace cdem::io {

/// A folder that exists and can be written: checked before the hours of work whose results it will hold.
class OutputDirectory {
public:
  /// Creates the folder, and those above it, where missing.
  ///
  /// @throws core::InvalidInput if `path` is empty
  /// @throws core::FileError    if it cannot be created or written, or is something other than a folder
  explicit OutputDirectory(std::filesystem::path path) : path_(std::move(path)) {
    core::expect(!path_.empty(), "output folder", "''", "the name of a folder is expected");
    std::error_code error;
    const auto status = std::filesystem::status(path_, error);
    if (std::filesystem::exists(status) && !std::filesystem::is_directory(status))
      throw core::FileError("cannot write into " + path_.string() + ": it is not a folder");
    error.clear();
    std::filesystem::create_directories(path_, error);
    if (error)
      throw core::FileError("cannot create folder " + path_.string() + ": " + error.message());
    try {
      const AtomicFile probe(path_ / "probe"); // opened and dropped: leaves nothing
    } catch (const core::FileError& unwritable) {
      const std::string what = unwritable.what();
      throw core::FileError("cannot write into " + path_.string() + what.substr(what.rfind(": ")));
    }
  }

  const std::filesystem::path& path() const noexcept { return path_; }

  /// Path of a file in the folder.
  /// @throws core::InvalidInput unless `name` is a plain file name: results stay inside the folder
  std::filesystem::path file(std::string_view name) const {
    core::expect(!name.empty() && name != "." && name != ".." && name.find('/') == std::string_view::npos,
                 "name of an output file", "'" + std::string(name) + "'",
                 "a name without a folder is expected");
    return path_ / name;
  }

private:
  std::filesystem::path path_;
};

} // namespace cdem::io
