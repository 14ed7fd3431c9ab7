#pragma once

/// @file
/// The cells of any conforming mesh as specimens.

#include <cdem/geometry/mesh.hpp>
#include <cdem/stress/tessellation/hexahedra.hpp>

#include <Eigen/LU> // inverse, determinant

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace cdem::stress::tessellation {

/// Tessellation by a conforming mesh of tetrahedra, wedges and hexahedra, mixed at will: [L17] sections 3 to 5 use meshes
/// of wedges and of tetrahedra.
///
/// Each cell is the union of the tetrahedra that geometry::cut_to_tetrahedra() makes of it, which is exact for cells whose faces
/// are not plane too: the cells neither overlap nor leave gaps. A uniform grid of bins, each with the tetrahedra that reach
/// into it, finds those that a point or a piece of a segment may lie in. The mesh's outside, holes included, is
/// outside; a place within 1e-10 of a cell's size of it is inside, so that rounding opens no gaps. There are no periodic faces.
class Polyhedra {
public:
  /// @throws core::InvalidInput for a mesh that is not valid, or a cell of which a tetrahedron has no volume or one of
  ///         the other sign: flat, tangled or too warped
  /// @complexity O(cells), about 0.3 kB for each tetrahedron (a wedge has 3, a hexahedron 6)
  explicit Polyhedra(geometry::Mesh mesh) : mesh_(std::move(mesh)), bins_(bins_around(mesh_)) {
    volume_.reserve(mesh_.cell_count());
    for (std::size_t cell = 0; cell < mesh_.cell_count(); ++cell)
      volume_.push_back(add_cell(cell));
    fill_bins();
  }

  const geometry::Mesh& mesh() const noexcept { return mesh_; }
  std::size_t cell_count() const noexcept { return volume_.size(); }
  /// Volume of a cell, m^3: of its tetrahedra.
  double volume(std::size_t cell) const { return volume_[cell]; }

  /// Mean specimen length: the largest distance between two corners of a specimen averaged over the specimens, in units of the
  /// cube root of the mesh's volume (the side of a cube), [L17] section 2.5.
  double mean_specimen_length() const {
    double sum = 0, volume = 0;
    for (std::size_t cell = 0; cell < cell_count(); ++cell) {
      double square = 0;
      for (const auto a : mesh_.corners(cell))
        for (const auto b : mesh_.corners(cell))
          square = std::max(square, (mesh_.nodes[a] - mesh_.nodes[b]).squaredNorm());
      sum += std::sqrt(square);
      volume += volume_[cell];
    }
    return sum / static_cast<double>(cell_count()) / std::cbrt(volume);
  }

  /// Cell that holds a point; none for a point outside the mesh (or not finite). A point on a face belongs to the tetrahedron in
  /// which it is deepest, the first of equals.
  std::optional<std::size_t> locate(const Vec3& point) const {
    const std::optional<std::size_t> bin = bins_.locate(point);
    if (!bin)
      return std::nullopt;
    double deepest = -tolerance;
    std::optional<std::size_t> cell;
    for (std::size_t k = first_of_bin_[*bin]; k < first_of_bin_[*bin + 1]; ++k) {
      const Tetrahedron& tetrahedron = tetrahedra_[in_bin_[k]];
      const double depth = tetrahedron.coordinates(point).minCoeff();
      if (depth > deepest || (depth == deepest && !cell)) {
        deepest = depth;
        cell = tetrahedron.cell;
      }
    }
    return cell;
  }

  /// Calls callback(cell, begin, end) for each piece of the segment, and returns the part outside the mesh; see CutsSegments. A
  /// piece in a face goes to one of the cells beside it.
  /// @complexity O(bins and tetrahedra near the segment)
  template <class Callback>
  double for_each_piece(const geometry::Segment& segment, Callback&& callback) const {
    Pieces<Callback> pieces{callback};
    std::vector<Span> spans;
    double outside = bins_.for_each_piece(segment, [&](std::size_t bin, double begin, double end) {
      list_spans(segment, bin, begin, end, spans);
      pieces.add_covered(spans, begin, end);
    });
    pieces.flush();
    return outside + pieces.outside;
  }

private:
  /// Part of a cell: its four barycentric coordinates, linear in the point, are all from 0 to 1 inside.
  struct Tetrahedron {
    Eigen::Matrix<double, 4, 3> gradient; ///< 1/m
    Vec3 corner;
    std::uint32_t cell;

    Eigen::Vector4d coordinates(const Vec3& point) const {
      return Eigen::Vector4d::Unit(0) + gradient * (point - corner);
    }
  };

  /// Where a segment runs through a tetrahedron: as it is, and widened by the tolerance.
  struct Span {
    double end; ///< of the segment in the tetrahedron as it is
    double wide_begin, wide_end;
    std::uint32_t cell;
  };

  /// Barycentric coordinate down to which a point still counts as inside: rounding must not open gaps between cells.
  static constexpr double tolerance = 1e-10;
  static constexpr double bins_per_tetrahedron = 1;

  /// Strings the spans together to pieces of whole cells.
  template <class Callback>
  struct Pieces {
    Callback& callback;
    double outside = 0;
    std::size_t cell = 0;
    double begin = 0, end = 0; ///< of the piece not yet handed on; none where equal

    /// Covers [from, to] by the spans: at each place by the one that goes farthest, up to its own end.
    void add_covered(const std::vector<Span>& spans, double from, double to) {
      double done = from;
      while (done < to) {
        const Span* best = nullptr;
        double next = to; // where the next span begins, if none covers this place
        for (const Span& span : spans) {
          if (span.wide_end <= done)
            continue;
          if (span.wide_begin > done)
            next = std::min(next, span.wide_begin);
          else if (!best || span.wide_end > best->wide_end)
            best = &span;
        }
        if (!best) {
          outside += next - done;
          done = next;
          continue;
        }
        double until = best->end > done ? best->end : best->wide_end;
        if (best->wide_end >= to) // the widened end may be all that reaches it
          until = to;
        until = std::min(until, to);
        add(best->cell, done, until);
        done = until;
      }
    }
    void add(std::size_t of, double from, double to) {
      if (of != cell || from != end)
        flush();
      if (begin == end) {
        cell = of;
        begin = from;
      }
      end = to;
    }
    void flush() {
      if (end > begin)
        callback(cell, begin, end);
      begin = end;
    }
  };

  static Hexahedra bins_around(const geometry::Mesh& mesh) {
    mesh.validate();
    geometry::Box box{Vec3::Constant(std::numeric_limits<double>::infinity()),
                      Vec3::Constant(-std::numeric_limits<double>::infinity()),
                      {}};
    for (std::size_t cell = 0; cell < mesh.cell_count(); ++cell)
      for (const auto node : mesh.corners(cell)) {
        box.lower = box.lower.cwiseMin(mesh.nodes[node]);
        box.upper = box.upper.cwiseMax(mesh.nodes[node]);
      }
    const double tetrahedra = static_cast<double>(mesh.tetrahedra.size()) +
                              3 * static_cast<double>(mesh.wedges.size()) +
                              6 * static_cast<double>(mesh.hexahedra.size());
    return Hexahedra::near_cubes(
        box, static_cast<std::size_t>(std::clamp(bins_per_tetrahedron * tetrahedra, 1.0, 1e8)));
  }

  /// Adds the tetrahedra of a cell; returns its volume.
  double add_cell(std::size_t cell) {
    double volume = 0;
    geometry::cut_to_tetrahedra(mesh_.corners(cell), [&](auto a, auto b, auto c, auto d) {
      Mat3 edges;
      edges << mesh_.nodes[b] - mesh_.nodes[a], mesh_.nodes[c] - mesh_.nodes[a],
          mesh_.nodes[d] - mesh_.nodes[a];
      const double part = edges.determinant() / 6;
      const double size = edges.colwise().norm().maxCoeff();
      if (!(std::abs(part) > 1e-9 * size * size * size) || part * volume < 0) [[unlikely]]
        core::reject("volume of a part of cell " + std::to_string(cell), part,
                     "volumes of one sign, and not 0 m^3, are expected: the cell is flat, tangled or too "
                     "warped");
      Tetrahedron tetrahedron;
      tetrahedron.gradient.bottomRows<3>() = edges.inverse();
      tetrahedron.gradient.row(0) = -tetrahedron.gradient.bottomRows<3>().colwise().sum();
      tetrahedron.corner = mesh_.nodes[a];
      tetrahedron.cell = static_cast<std::uint32_t>(cell);
      tetrahedra_.push_back(tetrahedron);
      volume += part;
    });
    return std::abs(volume);
  }

  /// Lists in each bin the tetrahedra that reach into it, or come within the tolerance of it.
  void fill_bins() {
    first_of_bin_.assign(bins_.cell_count() + 1, 0);
    for (const Tetrahedron& tetrahedron : tetrahedra_)
      for_each_bin(tetrahedron, [&](std::size_t bin) { ++first_of_bin_[bin + 1]; });
    for (std::size_t bin = 1; bin < first_of_bin_.size(); ++bin)
      first_of_bin_[bin] += first_of_bin_[bin - 1];
    in_bin_.resize(first_of_bin_.back());
    std::vector<std::uint64_t> next(first_of_bin_.begin(), first_of_bin_.end() - 1);
    for (std::size_t k = 0; k < tetrahedra_.size(); ++k)
      for_each_bin(tetrahedra_[k],
                   [&](std::size_t bin) { in_bin_[next[bin]++] = static_cast<std::uint32_t>(k); });
  }

  template <class Use>
  void for_each_bin(const Tetrahedron& tetrahedron, Use&& use) const {
    const Mat3 edges = tetrahedron.gradient.bottomRows<3>().inverse();
    const Vec3 low = tetrahedron.corner + edges.rowwise().minCoeff().cwiseMin(0);
    const Vec3 high = tetrahedron.corner + edges.rowwise().maxCoeff().cwiseMax(0);
    const Vec3 half = bins_.cell_size() / 2;
    std::array<std::size_t, 3> first{}, last{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      const auto bin = [&](double x) {
        const double place = (x - bins_.box().lower[axis]) / (2 * half[axis]);
        return static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, bins_.counts()[k] - 1.0));
      };
      const double margin = 1e-9 * (high[axis] - low[axis]);
      first[k] = bin(low[axis] - margin);
      last[k] = bin(high[axis] + margin);
    }
    const Eigen::Vector4d reach =
        (tetrahedron.gradient.cwiseAbs() * half).array() * (1 + 1e-9) + 10 * tolerance;
    for (std::size_t k = first[2]; k <= last[2]; ++k)
      for (std::size_t j = first[1]; j <= last[1]; ++j)
        for (std::size_t i = first[0]; i <= last[0]; ++i) {
          const std::size_t bin = bins_.index(i, j, k);
          // No corner of the bin is on the inner side of some face: they do not meet.
          if (((tetrahedron.coordinates(bins_.centre(bin)) + reach).array() >= 0).all())
            use(bin);
        }
  }

  /// The spans of the piece [begin, end] of a segment, which lies in `bin`.
  void list_spans(const geometry::Segment& segment, std::size_t bin, double begin, double end,
                  std::vector<Span>& spans) const {
    spans.clear();
    for (std::uint64_t k = first_of_bin_[bin]; k < first_of_bin_[bin + 1]; ++k) {
      const Tetrahedron& tetrahedron = tetrahedra_[in_bin_[k]];
      const Eigen::Vector4d start = tetrahedron.coordinates(segment.start);
      const Eigen::Vector4d rate = tetrahedron.gradient * segment.extent;
      const Eigen::Array4d at_begin = start + begin * rate, at_end = start + end * rate;
      if ((at_begin.max(at_end) < -tolerance).any()) // beyond one face from end to end
        continue;
      Span span{end, begin, end, tetrahedron.cell};
      for (Eigen::Index face = 0; face < 4; ++face) {
        const double crossing = -start[face] / rate[face], widening = tolerance / std::abs(rate[face]);
        if (rate[face] > 0) {
          span.wide_begin = std::max(span.wide_begin, crossing - widening);
        } else if (rate[face] < 0) {
          span.end = std::min(span.end, crossing);
          span.wide_end = std::min(span.wide_end, crossing + widening);
        }
      }
      if (span.wide_end > span.wide_begin)
        spans.push_back(span);
    }
  }

  geometry::Mesh mesh_;
  Hexahedra bins_;
  std::vector<double> volume_; ///< [cells]
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<std::uint64_t> first_of_bin_; ///< [bins + 1] into in_bin_
  std::vector<std::uint32_t> in_bin_;       ///< tetrahedra
};

static_assert(Tessellation<Polyhedra>);

/// The cells of Hexahedra, Wedges or Tetrahedra as a mesh, with the same numbers: to change its nodes, or to add to it.
template <class Cells>
geometry::Mesh mesh_of(const Cells& cells) {
  geometry::Mesh mesh;
  mesh.nodes = cells.corner_points();
  auto corners = cells.cell_corners();
  constexpr std::size_t count = std::tuple_size_v<typename decltype(corners)::value_type>;
  static_assert(count == 4 || count == 6 || count == 8, "tetrahedra, wedges or hexahedra are expected");
  if constexpr (count == 4)
    mesh.tetrahedra = std::move(corners);
  else if constexpr (count == 6)
    mesh.wedges = std::move(corners);
  else
    mesh.hexahedra = std::move(corners);
  return mesh;
}

} // namespace cdem::stress::tessellation
