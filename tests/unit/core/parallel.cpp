#include <cdem/core/parallel.hpp>
#include <cdem/core/random.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

using namespace cdem::core;

TEST_CASE("parallel_for meets each index once, in blocks that do not depend on the threads") {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool(threads);
    CHECK(pool.size() == threads);
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, block_size - 1, block_size, block_size + 1, 2 * block_size,
          7 * block_size + 13, std::size_t{100003}}) {
      CAPTURE(threads);
      CAPTURE(count);
      std::vector<int> visits(count, 0);
      std::vector<std::size_t> ends((count + block_size - 1) / block_size, 0);
      parallel_for(pool, count, [&](std::size_t begin, std::size_t end) {
        ends[begin / block_size] = end;
        for (std::size_t i = begin; i < end; ++i)
          ++visits[i];
      });
      CHECK(visits == std::vector<int>(count, 1));
      for (std::size_t block = 0; block < ends.size(); ++block)
        CHECK(ends[block] == std::min(count, (block + 1) * block_size));
    }
  }
}

TEST_CASE("threads do share the work, each a contiguous part") {
  ThreadPool pool(4);
  std::vector<std::thread::id> who(103);
  pool.for_each_block(who.size(), [&](std::size_t block) { who[block] = std::this_thread::get_id(); });
  CHECK(std::set<std::thread::id>(who.begin(), who.end()).size() == 4);
  int changes = 0;
  for (std::size_t block = 1; block < who.size(); ++block)
    changes += who[block] != who[block - 1];
  CHECK(changes == 3);
  CHECK(who[0] == std::this_thread::get_id());
}

TEST_CASE("parallel_sum has the same bits for any number of threads") {
  Random random(1);
  std::vector<double> values(50 * block_size + 77);
  for (double& value : values)
    value = random.normal() * std::pow(10, random.uniform(-8, 8)); // the order of the sum matters
  const auto sum_of = [&](int threads) {
    ThreadPool pool(threads);
    return parallel_sum(pool, values.size(), 0.0, [&](std::size_t begin, std::size_t end) {
      return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                             values.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
    });
  };
  const double serial = sum_of(1);
  long double exact = 0, size = 0;
  for (const double value : values) {
    exact += value;
    size += std::abs(value);
  }
  CHECK(std::abs(static_cast<double>(exact) - serial) < 1e-14 * static_cast<double>(size));
  for (const int threads : {2, 3, 8}) {
    const double other = sum_of(threads);
    CHECK(std::memcmp(&other, &serial, sizeof serial) == 0);
  }
  ThreadPool pool(2);
  CHECK(parallel_sum(pool, 0, 0.0, [](std::size_t, std::size_t) { return 1.0; }) == 0);
}

TEST_CASE("parallel_sum adds whatever has +=") {
  ThreadPool pool(3);
  const std::string text =
      parallel_sum(pool, 3 * block_size + 1, std::string(),
                   [](std::size_t begin, std::size_t) { return std::to_string(begin / block_size); });
  CHECK(text == "0123"); // in block order
}

TEST_CASE("an exception reaches the caller, the same for any number of threads, and the pool lives on") {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 50; ++repeat) {
      std::string caught;
      try {
        pool.for_each_block(40, [](std::size_t block) {
          if (block % 10 == 7)
            throw std::runtime_error("block " + std::to_string(block));
        });
      } catch (const std::runtime_error& error) {
        caught = error.what();
      }
      CHECK(caught == "block 7");
      std::vector<int> visits(40, 0);
      pool.for_each_block(40, [&](std::size_t block) { ++visits[block]; });
      CHECK(visits == std::vector<int>(40, 1));
    }
  }
}

TEST_CASE("a pool serves thousands of loops, also after its workers fell asleep") {
  ThreadPool pool(3);
  std::vector<std::size_t> counts(64, 0);
  for (int loop = 0; loop < 5000; ++loop) {
    if (loop % 1000 == 0) // longer than the workers spin
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    pool.for_each_block(counts.size(), [&](std::size_t block) { ++counts[block]; });
  }
  CHECK(counts == std::vector<std::size_t>(64, 5000));
}

TEST_CASE("pools are made and unmade without being used") {
  for (int repeat = 0; repeat < 50; ++repeat) {
    ThreadPool pool(4);
    CHECK(pool.size() == 4);
  }
}

TEST_CASE("0 threads are all processors, other numbers are refused") {
  CHECK(ThreadPool(0).size() >= 1);
  for (const int bad : {-1, -1000, 4097})
    CHECK_THROWS_WITH_AS(
        ThreadPool{bad},
        ("threads = " + std::to_string(bad) + " is not accepted: 0 (all processors) to 4096 is expected")
            .c_str(),
        InvalidInput);
}
