#pragma once

/// @file
/// Ctrl-C ends a run between two whole steps.

#include <cdem/core/error.hpp>

#include <atomic>
#include <csignal>

namespace cdem::io {

/// While it lives, SIGINT (Ctrl-C) and SIGTERM set a flag instead of ending the program; a second one ends it at
/// once. The handlers found before are put back at the end of its life.
///
///     io::Interrupt interrupt;
///     const core::Monitor monitor(progress.listener(), interrupt.flag());
class Interrupt {
public:
  /// Installs the handlers and clears the flag.
  /// @throws core::InvalidInput while another Interrupt lives: signals belong to the whole program
  Interrupt() {
    core::expect(!alive_.exchange(true), "number of io::Interrupt alive", 2, "one at a time is expected");
    requested_.store(false);
    struct sigaction action {};
    action.sa_handler = &Interrupt::handle;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, &before_interrupt_);
    sigaction(SIGTERM, &action, &before_terminate_);
  }
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  ~Interrupt() {
    sigaction(SIGINT, &before_interrupt_, nullptr);
    sigaction(SIGTERM, &before_terminate_, nullptr);
    alive_.store(false);
  }

  /// Whether a signal has come.
  bool requested() const noexcept { return requested_.load(std::memory_order_relaxed); }

  /// The flag for core::Monitor; it outlives this object.
  const std::atomic<bool>* flag() const noexcept { return &requested_; }

private:
  static void handle(int signal) {
    if (!requested_.exchange(true))
      return;
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }

  static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch nothing else");
  static inline std::atomic<bool> requested_{false};
  static inline std::atomic<bool> alive_{false};
  struct sigaction before_interrupt_ {};
  struct sigaction before_terminate_ {};
};

} // namespace cdem::io
