#include <cdem/core/progress.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace cdem::core;

TEST_CASE("a default monitor listens to nothing and stops nothing") {
  const Monitor monitor;
  CHECK_FALSE(monitor.listens());
  CHECK_FALSE(monitor.stop_requested());
  CHECK_NOTHROW(monitor.report({"stage", 0.5, "detail"}));
}

TEST_CASE("a listener gets what is reported, in order") {
  std::vector<std::string> heard;
  const Monitor monitor([&](const Progress& progress) {
    heard.push_back(std::string(progress.stage) + " " + to_text(progress.fraction) + " " + progress.detail);
  });
  CHECK(monitor.listens());
  CHECK_FALSE(monitor.stop_requested());
  monitor.report({"packing", 0.25, "density 0.5"});
  monitor.report({"packing", 1, "density 0.64"});
  CHECK(heard == std::vector<std::string>{"packing 0.25 density 0.5", "packing 1 density 0.64"});
}

TEST_CASE("a stop is thrown at the next report, after the listener heard it") {
  std::atomic<bool> stop = false;
  int heard = 0;
  const Monitor monitor([&](const Progress&) { ++heard; }, &stop);
  CHECK_NOTHROW(monitor.report({"verlet", 0.1, "step 10"}));
  stop = true;
  CHECK(monitor.stop_requested());
  CHECK_THROWS_WITH_AS(monitor.report({"verlet", 0.37, "step 37"}), "verlet interrupted at 37 %: step 37",
                       Interrupted);
  CHECK(heard == 2);
  stop = false; // the run may go on
  CHECK_NOTHROW(monitor.report({"verlet", 0.38, "step 38"}));
}

TEST_CASE("a stop needs no listener, and copies share it") {
  std::atomic<bool> stop = false;
  const Monitor monitor({}, &stop);
  const Monitor copy = monitor;
  CHECK_FALSE(copy.listens());
  stop = true;
  CHECK(copy.stop_requested());
  CHECK_THROWS_AS(copy.report({"x", 0, ""}), Interrupted);
}
