#include <cdem/homogenize/running_average.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <optional>
#include <vector>

using namespace cdem;

TEST_CASE("the running average is the mean of all values, and goes on where it was left") {
  homogenize::RunningAverage all, first;
  double sum = 0;
  for (int i = 1; i <= 1000; ++i) {
    all.add(i * i);
    sum += i * i;
    if (i <= 400)
      first.add(i * i);
  }
  CHECK(all.mean() == doctest::Approx(sum / 1000).epsilon(1e-13));
  auto second = homogenize::RunningAverage::restore(first.mean(), first.count());
  for (int i = 401; i <= 1000; ++i)
    second.add(i * i);
  CHECK(second.mean() == all.mean());
  CHECK(second.count() == 1000);
}

TEST_CASE("two successive checks that change little mean convergence") {
  homogenize::ConvergenceRule rule({.interval = 10, .tolerance = 1e-3, .successive = 2});
  CHECK_FALSE(rule.check(0, 1));
  CHECK_FALSE(rule.check(10, 1));      // the first has nothing to compare with
  CHECK_FALSE(rule.check(15, 1));      // no check
  CHECK_FALSE(rule.check(20, 1.0005)); // passed
  CHECK_FALSE(rule.check(30, 1.01));   // failed: counting begins again
  CHECK_FALSE(rule.check(40, 1.0101)); // passed
  CHECK(rule.check(50, 1.0102));       // passed twice
  CHECK(rule.check(60, 2));            // stays converged
}

TEST_CASE("values that are not numbers never converge") {
  homogenize::ConvergenceRule rule({.interval = 1, .tolerance = 1e-3, .successive = 2});
  for (std::uint64_t step = 1; step < 10; ++step)
    CHECK_FALSE(rule.check(step, std::numeric_limits<double>::quiet_NaN()));
}

TEST_CASE("a rule goes on where it was left") {
  homogenize::ConvergenceRule rule({.interval = 1, .tolerance = 1e-3, .successive = 2});
  rule.check(1, 1);
  rule.check(2, 1);
  homogenize::ConvergenceRule later({.interval = 1, .tolerance = 1e-3, .successive = 2});
  later.restore(rule.state());
  CHECK(later.check(3, 1));
}

TEST_CASE("settled is what stays near the reference to the end, and long enough to tell") {
  const std::vector<std::uint64_t> step{10, 20, 30, 40, 50};
  const auto settled = [&](std::vector<double> value, std::uint64_t lasting = 0) {
    return homogenize::settled_from(step, value, -2, 0.1, lasting);
  };
  CHECK(settled({-2, -2.1, -1.9, -2, -2}) == 10);
  CHECK(settled({-2, -2.1, -2.3, -2, -2}) == 40); // left it again
  CHECK(settled({-2, -2.1, -2.3, -2, -2}, 10) == 40);
  CHECK_FALSE(settled({-2, -2.1, -2.3, -2, -2}, 11));
  CHECK_FALSE(settled({-2, -2, -2, -2, 2}));
  CHECK(settled({std::numeric_limits<double>::quiet_NaN(), -1, -2, -2, -2}) == 30);
  CHECK_FALSE(homogenize::settled_from({}, {}, 1, 1));
  CHECK_THROWS_WITH_AS(settled({1}), doctest::Contains("number of steps = 5 is not accepted"),
                       core::InvalidInput);
}

TEST_CASE("a rule is met by a curve where it is met step by step") {
  const homogenize::ConvergenceRule rule({.interval = 20, .tolerance = 1e-3, .successive = 2});
  std::vector<std::uint64_t> step;
  std::vector<double> average;
  homogenize::ConvergenceRule alone = rule;
  std::optional<std::uint64_t> wanted;
  for (std::uint64_t n = 10; n <= 500; n += 10) {
    step.push_back(n);
    average.push_back(1 - 10 / static_cast<double>(n * n));
    if (alone.check(n, average.back()) && !wanted)
      wanted = n;
  }
  REQUIRE(wanted);
  CHECK(homogenize::met_at(rule, step, average) == wanted);
  step.resize(3);
  average.resize(3);
  CHECK_FALSE(homogenize::met_at(rule, step, average)); // two checks at most
  step.pop_back();
  CHECK_THROWS_WITH_AS(homogenize::met_at(rule, step, average), doctest::Contains("number of steps = 2"),
                       core::InvalidInput);
}

TEST_CASE("bad parameters are refused by name") {
  using Rule = homogenize::ConvergenceRule;
  CHECK_THROWS_WITH_AS(Rule({.interval = 0}), doctest::Contains("interval"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(Rule({.tolerance = 0}), doctest::Contains("tolerance"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(Rule({.tolerance = std::numeric_limits<double>::quiet_NaN()}),
                       doctest::Contains("tolerance"), core::InvalidInput);
  CHECK_THROWS_WITH_AS(Rule({.successive = 0}), doctest::Contains("successive"), core::InvalidInput);
}
