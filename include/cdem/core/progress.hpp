#pragma once

/// @file
/// How a long run tells where it stands, and how it is asked to stop.

#include <cdem/core/error.hpp>

#include <atomic>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace cdem::core {

/// Where a long run stands.
struct Progress {
  std::string_view stage; ///< what is running, such as "packing"
  double fraction = 0;    ///< done part in [0, 1]
  std::string detail;     ///< the figures worth watching, such as "density 0.612"
};

/// Handed to every long run: receives its progress and may ask it to stop.
///
/// A default Monitor listens to nothing and never stops a run.
class Monitor {
public:
  Monitor() = default;
  /// @param listener  called by the thread that runs, a few times a second
  /// @param stop      polled by the run; when it turns true the run throws Interrupted between two whole steps
  explicit Monitor(std::function<void(const Progress&)> listener, const std::atomic<bool>* stop = nullptr)
      : listener_(std::move(listener)), stop_(stop) {}

  /// Whether the user asked to stop.
  bool stop_requested() const noexcept { return stop_ && stop_->load(std::memory_order_relaxed); }

  /// Whether report() has a listener: lets a run skip writing the text.
  bool listens() const noexcept { return static_cast<bool>(listener_); }

  /// Passes progress on, then throws Interrupted if a stop was asked for.
  void report(const Progress& progress) const {
    if (listener_)
      listener_(progress);
    if (stop_requested())
      throw Interrupted(std::string(progress.stage) + " interrupted at " +
                        to_text(static_cast<int>(100 * progress.fraction)) + " %: " + progress.detail);
  }

private:
  std::function<void(const Progress&)> listener_;
  const std::atomic<bool>* stop_ = nullptr;
};

} // namespace cdem::core
