#include <cdem/core/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using cdem::core::Random;

TEST_CASE("the bits are those of mt19937_64 as the standard fixes it") {
  Random random(5489); // the engine's default seed; [rand.predef] gives its 10,000th number
  for (int i = 1; i < 10000; ++i)
    random.bits();
  CHECK(random.bits() == 9981545732273789042u);
}

TEST_CASE("the first numbers of a seed are known") {
  Random random(5489); // published first outputs of the reference implementation's 64-bit twister
  CHECK(random.bits() == 14514284786278117030u);
  CHECK(random.bits() == 4620546740167642908u);
  CHECK(random.bits() == 13109570281517897720u);
  Random same(5489);
  CHECK(same.uniform() == static_cast<double>(14514284786278117030u >> 11) / 9007199254740992.0);
}

TEST_CASE("the same seed gives the same numbers, another seed others") {
  Random a(42), b(42), c(43);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const double x = a.normal();
    CHECK(x == b.normal());
    equal += x == c.normal();
  }
  CHECK(equal == 0);
}

TEST_CASE("uniform numbers: range, moments and an even spread") {
  Random random(1);
  constexpr int count = 400000, cells = 100;
  double sum = 0, squares = 0, product = 0, previous = 0.5, lowest = 1, highest = 0;
  std::vector<int> hits(cells, 0);
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform();
    lowest = std::min(lowest, x);
    highest = std::max(highest, x);
    sum += x - 0.5;
    squares += (x - 0.5) * (x - 0.5);
    product += (x - 0.5) * (previous - 0.5);
    previous = x;
    ++hits[static_cast<std::size_t>(x * cells)];
  }
  CHECK(lowest >= 0);
  CHECK(highest < 1);
  // five standard deviations of each estimate
  CHECK(std::abs(sum / count) < 5 * std::sqrt(1.0 / 12 / count));
  CHECK(std::abs(squares / count - 1.0 / 12) < 5 * std::sqrt(1.0 / 180 / count));
  CHECK(std::abs(product / count) < 5 / 12.0 / std::sqrt(count));
  double chi_square = 0;
  for (const int h : hits)
    chi_square += (h - count / cells) * (h - count / cells) / static_cast<double>(count / cells);
  CHECK(chi_square < 99 + 5 * std::sqrt(2 * 99.0));
  CHECK(chi_square > 99 - 5 * std::sqrt(2 * 99.0));
}

TEST_CASE("uniform numbers between two bounds") {
  Random random(2), unit(2);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(-3, 5);
    CHECK(x >= -3);
    CHECK(x < 5);
    CHECK(x == -3 + 8 * unit.uniform());
  }
  CHECK(random.uniform(2, 2) == 2);
}

TEST_CASE("normal numbers: moments and tails") {
  Random random(3);
  constexpr int count = 400000;
  double sum[5] = {};
  int beyond_one = 0, beyond_three = 0, finite = 0;
  for (int i = 0; i < count; ++i) {
    const double x = random.normal();
    finite += std::isfinite(x);
    for (int k = 1; k <= 4; ++k)
      sum[k] += std::pow(x, k) / count;
    beyond_one += std::abs(x) > 1;
    beyond_three += std::abs(x) > 3;
  }
  CHECK(finite == count);
  const double root = std::sqrt(count); // variances of x^k are 1, 2, 15, 96
  CHECK(std::abs(sum[1]) < 5 / root);
  CHECK(std::abs(sum[2] - 1) < 5 * std::sqrt(2) / root);
  CHECK(std::abs(sum[3]) < 5 * std::sqrt(15) / root);
  CHECK(std::abs(sum[4] - 3) < 5 * std::sqrt(96) / root);
  for (const auto& [hits, limit] : {std::pair{beyond_one, 1.0}, {beyond_three, 3.0}}) {
    const double p = std::erfc(limit / std::sqrt(2));
    CHECK(std::abs(hits / static_cast<double>(count) - p) < 5 * std::sqrt(p * (1 - p)) / root);
  }
}
