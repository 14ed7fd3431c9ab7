// K u, nanoseconds a bond: an assembled matrix of 6x6 blocks multiplied by hand, beside the library's matrix-free
// product with bonds in double and in float.

#include <cdem/bond/bond_law.hpp>

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "../common/raw_bonds.hpp"
#include "../common/report.hpp"
#include "../common/sample.hpp"

namespace {

/// Rows of 6x6 blocks, row by row.
struct BlockMatrix {
  std::vector<std::uint64_t> begin; ///< [particles + 1]
  std::vector<std::uint32_t> column;
  std::vector<double> values; ///< 36 a block
};

/// Columns of a bond's 12x12 stiffness: minus the loads on its ends when one degree of freedom moves by one.
void add_bond(const bench::RawBond& bond, double* ii, double* ij, double* ji, double* jj) {
  bench::Field motion(2), force(2);
  bench::RawBond alone = bond;
  alone.i = 0;
  alone.j = 1;
  for (std::size_t end = 0; end < 2; ++end)
    for (int dof = 0; dof < 6; ++dof) {
      motion[end][dof] = 1;
      bench::raw_forces({alone}, motion, force);
      motion[end][dof] = 0;
      for (int row = 0; row < 6; ++row) {
        (end == 0 ? ii : ij)[6 * row + dof] -= force[0][row];
        (end == 0 ? ji : jj)[6 * row + dof] -= force[1][row];
      }
    }
}

BlockMatrix assemble(const std::vector<bench::RawBond>& bonds, std::size_t particles) {
  BlockMatrix matrix;
  matrix.begin.assign(particles + 1, 0);
  for (std::size_t i = 0; i < particles; ++i)
    ++matrix.begin[i + 1]; // the diagonal comes first in its row
  for (const auto& bond : bonds) {
    ++matrix.begin[bond.i + std::size_t{1}];
    ++matrix.begin[bond.j + std::size_t{1}];
  }
  for (std::size_t i = 0; i < particles; ++i)
    matrix.begin[i + 1] += matrix.begin[i];
  matrix.column.resize(matrix.begin.back());
  matrix.values.assign(36 * matrix.begin.back(), 0);
  std::vector<std::uint64_t> next(matrix.begin.begin(), matrix.begin.end() - 1);
  for (std::size_t i = 0; i < particles; ++i)
    matrix.column[next[i]++] = static_cast<std::uint32_t>(i);
  for (const auto& bond : bonds) {
    const std::uint64_t ij = next[bond.i]++, ji = next[bond.j]++;
    matrix.column[ij] = bond.j;
    matrix.column[ji] = bond.i;
    const auto block = [&](std::uint64_t number) { return matrix.values.data() + 36 * number; };
    add_bond(bond, block(matrix.begin[bond.i]), block(ij), block(ji), block(matrix.begin[bond.j]));
  }
  return matrix;
}

void multiply(const BlockMatrix& matrix, const bench::Field& u, bench::Field& result) {
  for (std::size_t i = 0; i + 1 < matrix.begin.size(); ++i) {
    double sum[6] = {};
    for (std::uint64_t k = matrix.begin[i]; k < matrix.begin[i + 1]; ++k) {
      const double *block = matrix.values.data() + 36 * k, *v = u[matrix.column[k]].component;
      for (int row = 0; row < 6; ++row, block += 6)
        sum[row] += block[0] * v[0] + block[1] * v[1] + block[2] * v[2] + block[3] * v[4] + block[4] * v[5] +
                    block[5] * v[6];
    }
    for (int row = 0; row < 6; ++row)
      result[i][row] = -sum[row];
  }
}

double bytes_of_fields(const bench::Sample& sample) {
  return 192.0 * static_cast<double>(sample.particles.size()) / static_cast<double>(sample.network.size());
}

void raw_assembled(benchmark::State& state) {
  static std::map<std::int64_t, BlockMatrix> made;
  const bench::Sample& sample = bench::sample(state.range(0));
  const auto& bonds = bench::raw_bonds(state.range(0));
  if (made.count(state.range(0)) == 0)
    made.emplace(state.range(0), assemble(bonds, sample.particles.size()));
  const BlockMatrix& matrix = made.at(state.range(0));
  const bench::Field motion = bench::random_motion(sample.particles.size());
  bench::Field result(motion.size()), expected(motion.size());
  for (auto _ : state) {
    multiply(matrix, motion, result);
    benchmark::DoNotOptimize(result.data());
    benchmark::ClobberMemory();
  }
  bench::raw_forces(bonds, motion, expected);
  if (!(bench::relative_difference(expected, result) < 1e-12))
    state.SkipWithError("the matrix and the raw loop differ");
  const double bytes = 292.0 * static_cast<double>(matrix.column.size()) / static_cast<double>(bonds.size());
  state.counters["bytes_per_bond"] = bytes;
  bench::count_items(state, static_cast<double>(bonds.size()), bytes + bytes_of_fields(sample), 1);
}

template <class Real>
void library(benchmark::State& state) {
  const bench::Sample& sample = bench::sample(state.range(0));
  const auto threads = static_cast<int>(state.range(1));
  const auto& forces = bench::forces_of<Real>(state.range(0));
  const bench::Field motion = bench::random_motion(sample.particles.size());
  bench::Field force(motion.size());
  cdem::core::ThreadPool pool(threads);
  for (auto _ : state) {
    forces.evaluate(motion, force, pool);
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
  }
  const auto bonds = static_cast<double>(sample.network.size());
  state.counters["bytes_per_bond"] = static_cast<double>(forces.memory()) / bonds;
  bench::count_items(state, bonds, 8.0 * sizeof(Real) + bytes_of_fields(sample), threads);
}

constexpr auto milliseconds = benchmark::kMillisecond;
BENCHMARK(raw_assembled)->Arg(100000)->Arg(1000000)->UseRealTime()->Unit(milliseconds);
BENCHMARK(library<double>)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseRealTime()->Unit(milliseconds);
BENCHMARK(library<float>)->ArgsProduct({{100000, 1000000}, {1, 2}})->UseRealTime()->Unit(milliseconds);

} // namespace

BENCHMARK_MAIN();
