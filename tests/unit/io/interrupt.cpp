#include <cdem/core/progress.hpp>
#include <cdem/io/interrupt.hpp>

#include <doctest/doctest.h>

#include <sys/wait.h>
#include <unistd.h>

using namespace cdem;

namespace {
int caught = 0;
void count_signal(int) {
  ++caught;
}
} // namespace

TEST_CASE("A signal raises the flag, and a monitored run throws Interrupted") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const io::Interrupt interrupt;
    const core::Monitor monitor({}, interrupt.flag());
    CHECK_FALSE(interrupt.requested()); // the second time round: the flag was cleared
    CHECK_NOTHROW(monitor.report({"packing", 0.5, "density 0.6"}));
    std::raise(signal);
    CHECK(interrupt.requested());
    CHECK(monitor.stop_requested());
    CHECK_THROWS_WITH_AS(monitor.report({"packing", 0.5, "density 0.6"}),
                         "packing interrupted at 50 %: density 0.6", core::Interrupted);
  }
}

TEST_CASE("The handlers found before are put back") {
  const auto before = std::signal(SIGINT, count_signal);
  {
    const io::Interrupt interrupt;
    std::raise(SIGINT);
    CHECK(caught == 0);
  }
  std::raise(SIGINT);
  CHECK(caught == 1);
  std::signal(SIGINT, before);
}

TEST_CASE("A second signal ends the program at once") {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const io::Interrupt interrupt;
    std::raise(SIGINT);
    if (!interrupt.requested())
      _exit(1);
    std::raise(SIGINT);
    _exit(2); // not reached
  }
  int status = 0;
  waitpid(child, &status, 0);
  REQUIRE(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGINT);
}

TEST_CASE("Two at a time are refused, one after the other are not") {
  {
    const io::Interrupt first;
    CHECK_THROWS_WITH_AS(io::Interrupt(),
                         "number of io::Interrupt alive = 2 is not accepted: one at a time is expected",
                         core::InvalidInput);
  }
  CHECK_NOTHROW(io::Interrupt());
}
