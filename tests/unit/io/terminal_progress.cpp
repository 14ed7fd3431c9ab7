#include <cdem/io/terminal_progress.hpp>

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

using namespace cdem;

namespace {

/// A TerminalProgress with a clock set by hand, and what it wrote.
struct Screen {
  explicit Screen(bool terminal) : progress(file.get(), terminal, [this] { return now; }) {}

  void show(double at, double fraction, const std::string& detail = "", const char* stage = "packing") {
    now = at;
    progress.show({stage, fraction, detail});
  }

  std::string text() {
    std::fflush(file.get());
    std::rewind(file.get());
    std::string all;
    for (int c; (c = std::fgetc(file.get())) != EOF;)
      all += static_cast<char>(c);
    return all;
  }

  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::unique_ptr<std::FILE, Close> file{std::tmpfile()};
  double now = 0;
  io::TerminalProgress progress;
};

std::ptrdiff_t lines_of(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

} // namespace

TEST_CASE("Durations read as people say them") {
  CHECK(io::duration_text(0) == "0.0 s");
  CHECK(io::duration_text(4.23) == "4.2 s");
  CHECK(io::duration_text(9.96) == "10 s");
  CHECK(io::duration_text(59.4) == "59 s");
  CHECK(io::duration_text(59.6) == "1 min 00 s");
  CHECK(io::duration_text(185) == "3 min 05 s");
  CHECK(io::duration_text(3600 + 600) == "1 h 10 min");
  CHECK(io::duration_text(3 * 86400 + 4 * 3600) == "3 d 4 h");
  CHECK(io::duration_text(1e30) == "for ever");
  CHECK(io::duration_text(-1) == "?");
  CHECK(io::duration_text(std::nan("")) == "?");
}

TEST_CASE("At a constant pace the time left is exact") {
  io::TimeLeft left;
  CHECK_FALSE(left.seconds());
  for (int i = 1; i <= 80; ++i) {
    left.update(0.5 * i, 0.01 * i);
    REQUIRE(left.seconds());
    CHECK(*left.seconds() == doctest::Approx(0.5 * (100 - i)).epsilon(1e-9));
  }
}

TEST_CASE("A run that slows down is followed, without a jump") {
  io::TimeLeft left;
  for (int i = 1; i <= 50; ++i)
    left.update(0.1 * i, 0.01 * i);  // a tenth of a second a percent
  left.update(6, 0.51);              // now a second a percent
  CHECK(*left.seconds() < 49 * 0.2); // not yet believed
  for (int i = 52; i <= 70; ++i)
    left.update(i - 45, 0.01 * i);
  CHECK(*left.seconds() == doctest::Approx(30).epsilon(0.2));
}

TEST_CASE("Nothing done, or going back, gives no nonsense") {
  io::TimeLeft left;
  left.update(1, 0);
  left.update(2, 0);
  CHECK_FALSE(left.seconds());
  left.update(3, 0.5);
  const auto before = left.seconds();
  left.update(4, 0.4);
  CHECK(left.seconds() == before);
}

TEST_CASE("In a file: a line at the start, every tenth of the way, and at the end") {
  Screen screen(false);
  for (int i = 0; i <= 1000; ++i)
    screen.show(0.04 * i, 0.001 * i, "density 0.6");
  const std::string text = screen.text();
  CHECK(lines_of(text) == 11);
  CHECK(text.find("packing    0 %  density 0.6\n") == 0);
  CHECK(text.find("packing   50 %  20 s left  density 0.6\n") != std::string::npos);
  CHECK(text.find("packing  100 %  in 40 s  density 0.6\n") != std::string::npos);
  CHECK(text.find('\r') == std::string::npos);
  CHECK(text.find('\x1b') == std::string::npos);
}

TEST_CASE("In a file: a slow run is heard of every ten seconds, a fast one writes two lines") {
  Screen slow(false);
  for (int i = 0; i <= 100; ++i)
    slow.show(i, 0.0001 * i);
  CHECK(lines_of(slow.text()) == 11);
  Screen fast(false);
  for (int i = 0; i <= 100; ++i)
    fast.show(0.001 * i, 0.01 * i);
  CHECK(lines_of(fast.text()) == 2);
}

TEST_CASE("On a terminal one line is drawn again and again, at most ten times a second") {
  Screen screen(true);
  for (int i = 0; i <= 1000; ++i)
    screen.show(0.01 * i, 0.001 * i, "density 0.6");
  const std::string text = screen.text();
  CHECK(lines_of(text) == 1);
  CHECK(text.back() == '\n');
  const auto drawn = std::count(text.begin(), text.end(), '\r');
  CHECK(drawn > 80);
  CHECK(drawn <= 102);
  CHECK(text.find("\rpacking  [############------------]  50 %  5.0 s left  density 0.6\x1b[K") !=
        std::string::npos);
}

TEST_CASE("A long line is cut to the terminal's width, never inside a character") {
  Screen screen(true);
  std::string detail;
  for (int i = 0; i < 60; ++i)
    detail += "\xce\xbd"; // nu, two bytes
  screen.show(0, 0.5, detail);
  screen.show(1, 0.5, " " + detail);
  const std::string text = screen.text();
  for (std::size_t begin = text.find('\r'); begin != std::string::npos; begin = text.find('\r', begin + 1)) {
    const std::string line = text.substr(begin + 1, text.find('\x1b', begin) - begin - 1);
    CHECK(line.size() < 80);
    const auto whole = std::count(line.begin(), line.end(), '\xce');
    CHECK(whole == std::count(line.begin(), line.end(), '\xbd'));
  }
}

TEST_CASE("Each stage has its own line and its own clock") {
  Screen screen(true);
  screen.show(0, 0, "", "packing");
  screen.show(5, 0.5, "", "packing");
  screen.show(100, 0, "", "solving");
  screen.show(110, 0.5, "", "solving");
  screen.progress.end_line();
  screen.progress.end_line(); // once is enough
  const std::string text = screen.text();
  CHECK(lines_of(text) == 2);
  CHECK(text.find("solving  [############------------]  50 %  10 s left") != std::string::npos);
}

TEST_CASE("Fractions that make no sense do not crash") {
  Screen screen(true);
  for (const double fraction : {-1.0, 2.0, std::nan(""), 1.0 / 0.0})
    screen.show(1, fraction);
  const std::string text = screen.text();
  CHECK(text.find("  0 %") != std::string::npos);
  CHECK(text.find("100 %") != std::string::npos);
}

TEST_CASE("A Monitor's reports arrive") {
  Screen screen(false);
  const core::Monitor monitor(screen.progress.listener());
  CHECK(monitor.listens());
  monitor.report({"solving", 1.0, "residual 1e-9"});
  CHECK(screen.text() == "solving  100 %  in 0.0 s  residual 1e-9\n");
}
