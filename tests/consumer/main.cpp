// What a user's first program does: it includes the toolkit, links, runs, and gets a right answer.

#include <cdem/cdem.hpp>

#include <cmath>
#include <iostream>

int main() {
  cdem::core::ThreadPool pool(2);
  const double sum = cdem::core::parallel_sum(pool, 10'000, 0.0, [](std::size_t begin, std::size_t end) {
    double part = 0;
    for (std::size_t i = begin; i < end; ++i)
      part += static_cast<double>(i);
    return part;
  });
  const double volume = cdem::geometry::Box::cube(0.5, true).volume();
  std::cout << "sum " << sum << ", volume " << volume << '\n';
  return sum == 49'995'000 && std::abs(volume - 0.125) < 1e-15 ? 0 : 1;
}
