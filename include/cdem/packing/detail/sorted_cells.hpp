#pragma once

/// @file
/// Spheres kept in the order of cubic cells along a Hilbert curve, for neighbour searches over all of them at once.

#include <cdem/core/parallel.hpp>
#include <cdem/core/types.hpp>
#include <cdem/packing/detail/quad.hpp>
#include <cdem/particles/space_filling_order.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace cdem::packing::detail {

/// Cells of the unit cube, numbered along a Hilbert curve; a cell's spheres are consecutive.
class SortedCells {
public:
  /// @param edge      wanted edge of a cell; the cells are a little larger
  /// @param periodic  whether a search goes on beyond a face at the opposite one
  SortedCells(double edge, bool periodic)
      : periodic_(periodic), cells_(static_cast<int>(std::clamp(1 / edge, 1.0, 1000.0))) {
    const auto n = static_cast<std::uint32_t>(cells_);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
    keys.reserve(std::size_t{n} * n * n);
    for (std::uint32_t c = 0; c < n; ++c)
      for (std::uint32_t b = 0; b < n; ++b)
        for (std::uint32_t a = 0; a < n; ++a)
          keys.emplace_back(particles::detail::hilbert_key({a, b, c}),
                            static_cast<std::uint32_t>(keys.size()));
    std::sort(keys.begin(), keys.end());
    rank_.resize(keys.size());
    for (std::size_t k = 0; k < keys.size(); ++k)
      rank_[keys[k].second] = static_cast<std::uint32_t>(k);
    first_.assign(keys.size() + 1, 0);
  }

  /// Assigns the spheres to their cells and says in which order they must be put: the new sphere i is the old sphere
  /// order[i]. Spheres of one cell keep their order.
  /// @param spheres  centres in the unit cube; those a rounding outside belong to the nearest cell
  void sort(const std::vector<Quad>& spheres, std::vector<ParticleIndex>& order, core::ThreadPool& pool) {
    cell_.resize(spheres.size());
    order.resize(spheres.size());
    core::parallel_for(pool, spheres.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        cell_[i] = rank_[index(place_of(spheres[i]))];
    });
    std::fill(first_.begin(), first_.end(), 0);
    for (const std::uint32_t cell : cell_)
      ++first_[cell];
    ParticleIndex sum = 0;
    for (ParticleIndex& first : first_)
      sum += std::exchange(first, sum);
    for (std::size_t i = 0; i < spheres.size(); ++i)
      order[first_[cell_[i]]++] = static_cast<ParticleIndex>(i);
    std::copy_backward(first_.begin(), first_.end() - 1,
                       first_.end()); // each first has become the next cell's
    first_[0] = 0;
  }

  /// Place of the cell that holds a point of the unit cube, in the grid.
  std::array<int, 3> place_of(const Quad& point) const {
    return {clamped(point[0]), clamped(point[1]), clamped(point[2])};
  }

  /// Whether that search goes on at an opposite face.
  bool wraps_around(const std::array<int, 3>& place, double reach) const {
    const int layers = layers_within(reach);
    return periodic_ &&
           std::any_of(place.begin(), place.end(), [&](int a) { return a < layers || a >= cells_ - layers; });
  }

  /// Calls visit(begin, end) with the ranges of spheres that may be closer than `reach` to a point of the cell at
  /// `place`, each once.
  template <class Visit>
  void visit_around(const std::array<int, 3>& place, double reach, Visit&& visit) const {
    const int layers = layers_within(reach);
    const Range x = range(place[0], layers), y = range(place[1], layers), z = range(place[2], layers);
    for (int c = z.begin; c != z.end; ++c)
      for (int b = y.begin; b != y.end; ++b)
        for (int a = x.begin; a != x.end; ++a) {
          const std::uint32_t cell = rank_[index({wrapped(a), wrapped(b), wrapped(c)})];
          visit(first_[cell], first_[cell + 1]);
        }
  }

private:
  struct Range {
    int begin, end;
  };

  int layers_within(double reach) const {
    return static_cast<int>(std::min(std::ceil(reach * cells_), 1.0 * cells_));
  }
  int clamped(double coordinate) const {
    return std::clamp(static_cast<int>(coordinate * cells_), 0, cells_ - 1);
  }
  int wrapped(int a) const { return a < 0 ? a + cells_ : (a >= cells_ ? a - cells_ : a); }
  std::size_t index(const std::array<int, 3>& place) const {
    const auto n = static_cast<std::size_t>(cells_);
    return (static_cast<std::size_t>(place[2]) * n + static_cast<std::size_t>(place[1])) * n +
           static_cast<std::size_t>(place[0]);
  }
  Range range(int place, int layers) const {
    if (!periodic_)
      return {std::max(place - layers, 0), std::min(place + layers + 1, cells_)};
    return 2 * layers + 1 < cells_ ? Range{place - layers, place + layers + 1} : Range{0, cells_};
  }

  bool periodic_;
  int cells_;                        ///< along an edge
  std::vector<std::uint32_t> rank_;  ///< [cells] along the curve, by place in the grid
  std::vector<ParticleIndex> first_; ///< [cells + 1] first sphere of each cell
  std::vector<std::uint32_t> cell_;  ///< [spheres] while sorting
};

} // namespace cdem::packing::detail
