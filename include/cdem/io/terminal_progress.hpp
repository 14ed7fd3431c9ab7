#pragma once

/// @file
/// Progress of a long run with the time left.

#include <cdem/core/progress.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

namespace cdem::io {

/// A time as people read it: "4.2 s", "48 s", "3 min 05 s", "2 h 10 min", "3 d 4 h".
inline std::string duration_text(double seconds) {
  if (!(std::isfinite(seconds) && seconds >= 0))
    return "?";
  char text[48];
  if (seconds < 9.95) {
    std::snprintf(text, sizeof text, "%.1f s", seconds);
    return text;
  }
  if (seconds > 1e9)
    return "for ever";
  const long s = std::lround(seconds);
  if (s < 60)
    std::snprintf(text, sizeof text, "%ld s", s);
  else if (s < 3600)
    std::snprintf(text, sizeof text, "%ld min %02ld s", s / 60, s % 60);
  else if (s < 86400)
    std::snprintf(text, sizeof text, "%ld h %02ld min", s / 3600, s / 60 % 60);
  else
    std::snprintf(text, sizeof text, "%ld d %ld h", s / 86400, s / 3600 % 24);
  return text;
}

/// Estimates the time left from the pace of the run.
///
/// The pace is averaged with a weight that falls exponentially with age, over about a quarter of the time elapsed: a
/// run that changes pace is followed, and the estimate does not jump.
class TimeLeft {
public:
  /// @param elapsed   s since the stage began, not decreasing
  /// @param fraction  done part in [0, 1]
  void update(double elapsed, double fraction) {
    const double step = elapsed - elapsed_;
    if (!(step > 0 && fraction >= fraction_))
      return;
    const double weight = pace_ ? 1 - std::exp(-step / std::max(0.25 * elapsed, 1.0)) : 1;
    const double pace = (fraction - fraction_) / step;
    pace_ = pace_ ? *pace_ + weight * (pace - *pace_) : pace;
    elapsed_ = elapsed;
    fraction_ = fraction;
  }

  /// Time left, s; none before something was done.
  std::optional<double> seconds() const {
    if (!pace_ || *pace_ <= 0)
      return std::nullopt;
    return (1 - fraction_) / *pace_;
  }

private:
  double elapsed_ = 0;
  double fraction_ = 0;
  std::optional<double> pace_;
};

/// Shows the progress of a core::Monitor: on a terminal one line drawn again and again, with a bar, the percentage,
/// the run's own figures and the time left; elsewhere (a file, a pipe) a plain line every tenth of the way or every
/// ten seconds, at most one a second.
///
///     io::TerminalProgress progress;                      // on stderr
///     const core::Monitor monitor(progress.listener());
///
/// It must outlive the listeners it gives, and is called by one thread at a time.
class TerminalProgress {
public:
  using Clock = std::function<double()>; ///< s, never decreasing

  explicit TerminalProgress(std::FILE* out = stderr)
      : TerminalProgress(out, is_terminal(out), steady_seconds) {}

  /// With everything given: for tests and for programs that know better.
  /// @param redraw  draw one line again and again
  TerminalProgress(std::FILE* out, bool redraw, Clock clock)
      : out_(out), redraw_(redraw), clock_(std::move(clock)) {}

  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;
  ~TerminalProgress() { end_line(); }

  /// What to hand to a core::Monitor.
  std::function<void(const core::Progress&)> listener() {
    return [this](const core::Progress& progress) { show(progress); };
  }

  /// Shows where the run stands. A fraction that is not in [0, 1] is taken for the nearest that is.
  void show(const core::Progress& progress) {
    const double now = clock_();
    const double fraction = progress.fraction >= 0 ? std::min(progress.fraction, 1.0) : 0.0;
    const bool new_stage = progress.stage != stage_ || (shown_done_ && fraction < 1);
    if (new_stage) {
      end_line();
      stage_ = progress.stage;
      begin_ = now;
      left_ = {};
    }
    fraction_ = fraction;
    left_.update(now - begin_, fraction);
    const bool done = fraction >= 1;
    if (done && shown_done_ && !new_stage)
      return;
    if (!(new_stage || done || is_time(now, fraction)))
      return;
    shown_at_ = now;
    shown_fraction_ = fraction;
    shown_done_ = done;
    if (redraw_)
      draw(line(progress.detail, now, columns_of(out_)));
    else
      std::fprintf(out_, "%s\n", line(progress.detail, now, 0).c_str());
    std::fflush(out_);
    if (done)
      end_line();
  }

  /// Ends the line on a terminal, so that other text can follow.
  void end_line() {
    if (!line_open_)
      return;
    std::fputs("\n", out_);
    std::fflush(out_);
    line_open_ = false;
  }

private:
  static double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  static bool is_terminal(std::FILE* out) {
    const char* kind = std::getenv("TERM");
    return isatty(fileno(out)) != 0 && kind && std::string_view(kind) != "dumb";
  }

  static std::size_t columns_of(std::FILE* out) {
    winsize size{};
    const bool known = ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col >= 20;
    return known ? size.ws_col : 80;
  }

  bool is_time(double now, double fraction) const {
    const double since = now - shown_at_;
    if (redraw_)
      return since >= 0.1;
    return since >= 10 || (since >= 1 && fraction >= shown_fraction_ + 0.1);
  }

  /// "packing  [######------]  52 %  12 s left  density 0.612", without the bar where `columns` is 0.
  std::string line(const std::string& detail, double now, std::size_t columns) const {
    char percent[16];
    std::snprintf(percent, sizeof percent, "%3d %%", static_cast<int>(100 * fraction_));
    std::string text = stage_ + "  ";
    if (columns > 0) {
      constexpr int cells = 24;
      const int full = static_cast<int>(cells * fraction_);
      text += "[" + std::string(static_cast<std::size_t>(full), '#') +
              std::string(static_cast<std::size_t>(cells - full), '-') + "] ";
    }
    text += percent;
    if (fraction_ >= 1)
      text += "  in " + duration_text(now - begin_);
    else if (const auto left = left_.seconds())
      text += "  " + duration_text(*left) + " left";
    if (!detail.empty())
      text += "  " + detail;
    if (columns > 0 && text.size() >= columns) { // a line that wraps could not be drawn again
      text.resize(columns - 1);
      while (static_cast<unsigned char>(text.back()) >= 0x80) // half a character of UTF-8
        text.pop_back();
    }
    return text;
  }

  void draw(const std::string& text) {
    std::fprintf(out_, "\r%s\x1b[K", text.c_str()); // erases what a longer line left
    line_open_ = true;
  }

  std::FILE* out_;
  bool redraw_;
  Clock clock_;
  std::string stage_;
  double begin_ = 0;
  double fraction_ = 0;
  double shown_at_ = 0;
  double shown_fraction_ = 0;
  bool shown_done_ = false;
  bool line_open_ = false;
  TimeLeft left_;
};

} // namespace cdem::io
