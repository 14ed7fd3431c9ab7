#include <cdem/io/atomic_file.hpp>
#include <cdem/io/output_directory.hpp>

#include <doctest/doctest.h>

#include <csignal>
#include <sys/resource.h>
#include <unistd.h>

#include "temporary_folder.hpp"

using namespace cdem;

namespace {

/// While it lives, no file may grow beyond so many bytes: a disk that is full.
class FullDisk {
public:
  explicit FullDisk(rlim_t bytes) : before_signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, before_signal_);
  }

private:
  rlimit before_{};
  void (*before_signal_)(int);
};

std::string refusal(const std::filesystem::path& path) {
  return message_of<core::FileError>([&] { io::AtomicFile file(path); });
}

} // namespace

TEST_CASE("A file appears whole at commit, and not before") {
  const TemporaryFolder folder;
  {
    io::AtomicFile file(folder / "a.txt");
    file.write("one ");
    file.write("two");
    CHECK_FALSE(std::filesystem::exists(folder / "a.txt"));
    CHECK(file.size() == 7);
    file.overwrite(0, "ONE", 3);
    file.write("!");
    file.commit();
  }
  CHECK(content_of(folder / "a.txt") == "ONE two!");
  CHECK(folder.entries() == 1);
}

TEST_CASE("A file that is dropped leaves the older one and nothing else") {
  const TemporaryFolder folder;
  put(folder / "a.txt", "old");
  CHECK_THROWS_AS(
      [&] {
        io::AtomicFile file(folder / "a.txt");
        file.write("new");
        throw core::Interrupted("stop");
      }(),
      core::Interrupted);
  CHECK(content_of(folder / "a.txt") == "old");
  CHECK(folder.entries() == 1);
  io::AtomicFile file(folder / "a.txt");
  file.write("new");
  file.commit();
  CHECK(content_of(folder / "a.txt") == "new");
}

TEST_CASE("A full disk is reported with file and reason, and nothing is left") {
  const TemporaryFolder folder;
  const std::string megabyte(1 << 20, 'x');
  const FullDisk disk(100'000);
  SUBCASE("while writing") {
    io::AtomicFile file(folder / "a.bin");
    const std::string message = message_of<core::FileError>([&] { file.write(megabyte); });
    CHECK(message == "cannot write " + (folder / "a.bin").string() + ": File too large");
  }
  SUBCASE("when the buffer is flushed at the end") {
    io::AtomicFile file(folder / "a.bin");
    file.write(std::string_view(megabyte).substr(0, 120'000));
    const std::string message = message_of<core::FileError>([&] { file.commit(); });
    CHECK(message == "cannot write " + (folder / "a.bin").string() + ": File too large");
  }
  CHECK(folder.entries() == 0);
}

TEST_CASE("What cannot become a file is refused when it is opened") {
  const TemporaryFolder folder;
  CHECK(refusal(folder / "missing/a.txt") ==
        "cannot write " + (folder / "missing/a.txt").string() + ": No such file or directory");
  CHECK(refusal(folder.path()) == "cannot write " + folder.path().string() + ": it is a folder");
  CHECK(refusal("") == "cannot write : the name of a file is expected");
  CHECK(refusal("/dev/full") ==
        "cannot write /dev/full: it is not a regular file"); // a rename would replace it
  put(folder / "file", "");
  CHECK(contains(refusal(folder / "file/a.txt"), "Not a directory"));
  if (geteuid() != 0) { // no folder is closed to root
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read);
    CHECK(contains(refusal(folder / "a.txt"), "Permission denied"));
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  }
}

TEST_CASE("A complete file takes no more, and bytes not yet written cannot be replaced") {
  const TemporaryFolder folder;
  io::AtomicFile file(folder / "a.txt");
  file.write("abc");
  CHECK(message_of<core::InvalidInput>([&] { file.overwrite(2, "xy", 2); }) ==
        "end of the bytes to overwrite = 4 is not accepted: at most the 3 bytes written are expected");
  file.commit();
  CHECK(contains(message_of<core::FileError>([&] { file.write("d"); }), "already complete"));
  CHECK(contains(message_of<core::FileError>([&] { file.commit(); }), "already complete"));
  CHECK(content_of(folder / "a.txt") == "abc");
}

TEST_CASE("An output folder is created with those above it and left empty") {
  const TemporaryFolder folder;
  const io::OutputDirectory out(folder / "deep/er");
  CHECK(std::filesystem::is_directory(folder / "deep/er"));
  CHECK(std::filesystem::is_empty(folder / "deep/er"));
  CHECK(out.file("a.csv") == folder / "deep/er/a.csv");
  CHECK_NOTHROW(io::OutputDirectory(folder / "deep")); // one that is there will do
}

TEST_CASE("An output folder that cannot be had is refused") {
  const TemporaryFolder folder;
  put(folder / "file", "");
  const auto refused = [](const std::filesystem::path& path) {
    return message_of<core::FileError>([&] { const io::OutputDirectory out(path); });
  };
  CHECK(refused(folder / "file") ==
        "cannot write into " + (folder / "file").string() + ": it is not a folder");
  CHECK(refused(folder / "file/sub") ==
        "cannot create folder " + (folder / "file/sub").string() + ": Not a directory");
  CHECK_THROWS_AS(io::OutputDirectory(""), core::InvalidInput);
  const io::OutputDirectory out(folder.path());
  for (const char* name : {"", ".", "..", "a/b", "../a"})
    CHECK_THROWS_AS(out.file(name), core::InvalidInput);
  if (std::filesystem::exists("/proc/self")) // a folder that is closed even to root
    CHECK(contains(refused("/proc/self"), "cannot write into /proc/self: "));
}
