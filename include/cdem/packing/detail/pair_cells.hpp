#pragma once

/// @file
/// Spheres sorted into the cells of a box, for passes over all near pairs of millions of spheres.

#include <cdem/geometry/box.hpp>
#include <cdem/packing/detail/cell_grid.hpp>
#include <cdem/particles/particle_set.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cdem::packing::detail {

/// The spheres cell by cell, cells along x contiguous: the neighbours of a sphere are a few runs of consecutive numbers,
/// whose distances are computed in vector registers.
class PairCells {
public:
  /// @param reach  m; largest distance of the pairs visited, at most half of every periodic edge
  PairCells(const particles::ParticleSet& spheres, const geometry::Box& box, double reach)
      : reach_(reach), size_(box.size()) {
    const double spacing = std::cbrt(box.volume() / static_cast<double>(spheres.size()));
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      periodic_[axis] = box.periodic[axis];
      inverse_[k] = periodic_[axis] ? 1 / size_[k] : 0;
      const double edge = std::max({reach / 4, spacing, size_[k] / 1024});
      cells_[axis] = std::max(1, static_cast<int>(size_[k] / edge));
      edge_[k] = size_[k] / cells_[axis];
      stencil_[axis] = static_cast<int>(std::ceil(reach / edge_[k]));
      if (cells_[axis] <
          2 * stencil_[axis] + 1) { // images in one another's cells: one cell, and the nearest image
        folded_ = folded_ || periodic_[axis];
        cells_[axis] = 1;
        stencil_[axis] = 0;
        edge_[k] = size_[k];
      }
    }
    sort(spheres, box);
  }

  std::size_t size() const noexcept { return number_.size(); }
  /// Number that the sphere has in the set given.
  ParticleIndex number(std::size_t i) const { return number_[i]; }
  /// Rows of cells along x; visit_pairs() of all rows meets every pair once.
  std::size_t rows() const {
    return static_cast<std::size_t>(cells_[1]) * static_cast<std::size_t>(cells_[2]);
  }

  /// Calls visit(i, j, squared distance) for each pair within reach of which sphere i lies in a row of [begin, end).
  /// Numbers are those of the sorted order. Several threads may do so at once.
  template <class Visit>
  void visit_pairs(std::size_t begin, std::size_t end, Visit&& visit) const {
    for (std::size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row) % cells_[1], z = static_cast<int>(row) / cells_[1];
      for (int dz = 0; dz <= stencil_[2]; ++dz)
        for (int dy = dz == 0 ? 0 : -stencil_[1]; dy <= stencil_[1]; ++dy) {
          const double rest = reach_ * reach_ - square(gap(dy, 1)) - square(gap(dz, 2));
          int other_y = y + dy, other_z = z + dz;
          Vec3 shift = Vec3::Zero(); // of the spheres of the other row
          if (rest < 0 || !inside(other_y, 1, shift) || !inside(other_z, 2, shift))
            continue;
          const int far = std::min(stencil_[0], static_cast<int>(std::sqrt(rest) / edge_[0]) + 1);
          visit_rows(row, static_cast<std::size_t>(other_z * cells_[1] + other_y), far, dy == 0 && dz == 0,
                     shift, visit);
        }
    }
  }

private:
  static double square(double x) { return x * x; }
  /// Least distance along an axis of points whose cells are `d` apart.
  double gap(int d, int axis) const { return std::max(0, std::abs(d) - 1) * edge_[axis]; }
  /// Brings a cell's number into the box, adding to the shift what brings its spheres back; false beyond a wall.
  bool inside(int& cell, int axis, Vec3& shift) const {
    const auto a = static_cast<std::size_t>(axis);
    if (cell >= 0 && cell < cells_[a])
      return true;
    shift[axis] += cell < 0 ? -size_[axis] : size_[axis];
    cell += cell < 0 ? cells_[a] : -cells_[a];
    return periodic_[a];
  }

  /// Pairs between two rows of cells, or within one.
  template <class Visit>
  void visit_rows(std::size_t row, std::size_t other, int far, bool same, const Vec3& shift,
                  Visit& visit) const {
    const auto first = [&](std::size_t r, int cell) {
      return start_[r * static_cast<std::size_t>(cells_[0]) + static_cast<std::size_t>(cell)];
    };
    const Vec3 edge(size_[0], 0, 0);
    for (int x = 0; x < cells_[0]; ++x) {
      const int low = same ? x : x - far, high = x + far + 1; // cells [low, high) of the other row
      for (ParticleIndex i = first(row, x); i < first(row, x + 1); ++i) {
        const Vec3 centre = Vec3(coordinate_[0][i], coordinate_[1][i], coordinate_[2][i]) - shift;
        const auto run = [&](int from, int to, const Vec3& seen_from) {
          const ParticleIndex begin = std::max(first(other, from), same && from == x ? i + 1 : 0);
          if (folded_)
            visit_run<true>(i, seen_from, begin, first(other, to), visit);
          else
            visit_run<false>(i, seen_from, begin, first(other, to), visit);
        };
        run(std::max(low, 0), std::min(high, cells_[0]), centre);
        if (!periodic_[0])
          continue;
        if (low < 0)
          run(low + cells_[0], cells_[0], centre + edge);
        if (high > cells_[0])
          run(0, high - cells_[0], centre - edge);
      }
    }
  }

  /// Sphere i, seen from `centre`, with each of a run.
  template <bool Folded, class Visit>
  void visit_run(ParticleIndex i, const Vec3& centre, ParticleIndex begin, ParticleIndex end,
                 Visit& visit) const {
    constexpr ParticleIndex most = 64;
    std::array<double, most> squared;
    std::array<ParticleIndex, most> near;
    const double x = centre[0], y = centre[1], z = centre[2], reach = reach_ * reach_;
    for (; begin < end; begin += most) {
      const ParticleIndex count = std::min(most, end - begin);
      const double* px = coordinate_[0].data() + begin;
      const double* py = coordinate_[1].data() + begin;
      const double* pz = coordinate_[2].data() + begin;
      ParticleIndex found = 0; // chosen without a branch, which would be guessed wrong half the time
      for (ParticleIndex k = 0; k < count; ++k) {
        double dx = px[k] - x, dy = py[k] - y, dz = pz[k] - z;
        if constexpr (Folded) {
          dx -= size_[0] * nearest_integer(dx * inverse_[0]);
          dy -= size_[1] * nearest_integer(dy * inverse_[1]);
          dz -= size_[2] * nearest_integer(dz * inverse_[2]);
        }
        const double square = dx * dx + dy * dy + dz * dz;
        squared[found] = square;
        near[found] = begin + k;
        found += square <= reach ? 1U : 0U;
      }
      for (ParticleIndex f = 0; f < found; ++f)
        visit(i, near[f], squared[f]);
    }
  }

  /// A counting sort by cell; the order within a cell is that of the numbers.
  void sort(const particles::ParticleSet& spheres, const geometry::Box& box) {
    const std::size_t count = spheres.size();
    std::vector<std::uint32_t> cell(count);
    start_.assign(rows() * static_cast<std::size_t>(cells_[0]) + 1, 0);
    const auto cell_of = [&](const Vec3& point) {
      std::array<int, 3> c{};
      for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        c[axis] = static_cast<int>(std::clamp((point[k] - box.lower[k]) / edge_[k], 0.0, cells_[axis] - 1.0));
      }
      return static_cast<std::uint32_t>((c[2] * cells_[1] + c[1]) * cells_[0] + c[0]);
    };
    for (std::size_t i = 0; i < count; ++i)
      ++start_[(cell[i] = cell_of(box.wrap(spheres.position[i]))) + 1];
    for (std::size_t c = 1; c < start_.size(); ++c)
      start_[c] += start_[c - 1];
    std::vector<ParticleIndex> next(start_.begin(), start_.end() - 1);
    number_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      number_[next[cell[i]]++] = static_cast<ParticleIndex>(i);
    for (int k = 0; k < 3; ++k) {
      auto& values = coordinate_[static_cast<std::size_t>(k)];
      values.resize(count);
      for (std::size_t i = 0; i < count; ++i)
        values[i] = box.wrap(spheres.position[number_[i]])[k];
    }
  }

  double reach_;
  Vec3 size_, inverse_, edge_;
  std::array<bool, 3> periodic_{};
  bool folded_ = false; ///< a periodic axis has one cell: nearest images are sought pair by pair
  std::array<int, 3> cells_{}, stencil_{};
  std::vector<ParticleIndex> start_;  ///< [cells + 1] first sphere of each cell
  std::vector<ParticleIndex> number_; ///< [spheres] of each in the set given
  std::array<std::vector<double>, 3> coordinate_;
};

} // namespace cdem::packing::detail
