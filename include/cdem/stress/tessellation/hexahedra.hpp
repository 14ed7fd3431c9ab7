#pragma once

/// @file
/// A box cut into nx x ny x nz equal hexahedra.

#include <cdem/core/error.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/geometry/segment.hpp>
#include <cdem/stress/tessellation/tessellation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace cdem::stress::tessellation {

namespace detail {

/// One direction of a structured grid: n intervals of unit length between planes 0, 1, ... n.
struct GridDirection {
  double lower = 0;  ///< m
  double length = 1; ///< m
  double count = 1;  ///< n, a whole number
  bool periodic = false;

  /// Coordinate in intervals. What lies within 1e-12 of the length from a wall is put on the wall, so that
  /// rounding of a position or a branch pushes nothing out of the box.
  double coordinate(double x) const {
    const double c = (x - lower) / length * count;
    const double rounding = 1e-12 * count;
    if (periodic)
      return c;
    return std::abs(c) <= rounding ? 0 : std::abs(c - count) <= rounding ? count : c;
  }

  /// Whether interval `cell` is one of the n, and not the space before the first or after the last.
  bool holds(double cell) const { return cell >= 0 && cell < count; }
};

/// Walks along one direction of a segment, from plane to plane.
struct GridWalk {
  double start = 0; ///< coordinate of the segment's start
  double rate = 0;  ///< coordinate gained over the whole segment
  double cell = 0;  ///< interval walked through: -1 and n lie outside the walls
  double plane = 0; ///< the plane met next
  double crossing = std::numeric_limits<double>::infinity(); ///< parameter in [0, 1] at which it is met

  GridWalk(const GridDirection& direction, double x, double extent) {
    const double n = direction.count;
    start = direction.coordinate(x);
    rate = extent / direction.length * n;
    if (direction.periodic) {
      start -= n * std::floor(start / n);
    } else if (const double end = direction.coordinate(x + extent); end == 0 || end == n) {
      rate = end - start; // ends on the wall: met at the parameter 1, not a rounding before it
    }
    // Each interval is half open, [cell, cell + 1): one that starts on a plane and goes down starts below it.
    cell = rate < 0 ? std::ceil(start) - 1 : std::floor(start);
    if (!direction.periodic) {
      if (rate == 0 && start == n)
        cell = n - 1; // the last interval is closed
      cell = std::clamp(cell, -1.0, n);
    }
    plane = rate < 0 ? cell : cell + 1;
    if (direction.periodic)
      wrap(n);
    find_crossing(direction);
  }

  /// Passes the plane met next.
  void step(const GridDirection& direction) {
    const double way = rate < 0 ? -1 : 1;
    cell += way;
    plane += way;
    if (direction.periodic)
      wrap(direction.count);
    find_crossing(direction);
  }

private:
  void wrap(double n) {
    if (cell >= n)
      cell -= n;
    else if (cell < 0)
      cell += n;
  }
  // Computed from the start each time, so that nothing drifts and crossings come in the order of the planes.
  void find_crossing(const GridDirection& direction) {
    const bool met = rate != 0 && (direction.periodic || (plane >= 0 && plane <= direction.count));
    crossing = met ? (plane - start) / rate : std::numeric_limits<double>::infinity();
  }
};

} // namespace detail

/// Structured tessellation of a box in equal hexahedra, [L17] section 2.5.
///
/// Cell (i, j, k) has the number i + nx (j + ny k). Each is half open, [lower, upper) along each axis, the
/// last of a row closed, so that every point of the box belongs to exactly one. In the periodic directions of
/// the box a point or a segment that leaves through a face re-enters through the opposite one.
///
/// [L17] asks for at least 80 particles a specimen and a specimen length of at most 0.17 L.
class Hexahedra {
public:
  using Counts = std::array<int, 3>;

  /// @param counts  number of cells along x, y, z, 1 or more each
  /// @throws core::InvalidInput for a bad box, a count below 1, or a grid of more than 4e9 corners
  Hexahedra(const geometry::Box& box, const Counts& counts) : box_(box), counts_(counts) {
    box.validate();
    double corners = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      core::expect(counts[k] >= 1, std::string("number of specimens along ") + "xyz"[k], counts[k],
                   "1 or more is expected");
      corners *= 1.0 + counts[k];
      const auto axis = static_cast<Eigen::Index>(k);
      directions_[k] = {box.lower[axis], box.size()[axis], static_cast<double>(counts[k]), box.periodic[k]};
    }
    core::expect(corners <= 4e9, "number of corners of the specimens", corners, "at most 4e9 is expected");
    volume_ = box.volume() / static_cast<double>(cell_count());
    core::expect_positive(volume_, "volume of a specimen", "m^3");
  }

  /// Cells as near to cubes as whole numbers allow, about `specimens` of them: exactly n^3 in a cube for n^3
  /// wanted.
  /// @throws core::InvalidInput for a bad box, or specimens outside 1 to 4e9
  static Hexahedra near_cubes(const geometry::Box& box, std::size_t specimens) {
    return {box, cube_counts(box, specimens)};
  }

  /// The finest of such tessellations whose specimens hold, in the mean, at least `per_specimen` particles.
  ///
  /// @param particles     number of particles in the box
  /// @param per_specimen  least mean number of centres in a specimen, such as the 80 of [L17]
  /// @throws core::InvalidInput for a bad box, no particle, or a per_specimen that is not in ]0, particles]
  static Hexahedra holding(const geometry::Box& box, std::size_t particles, double per_specimen) {
    core::expect(particles > 0, "number of particles", particles, "1 or more is expected");
    core::expect_positive(per_specimen, "particles per specimen");
    core::expect(per_specimen <= static_cast<double>(particles), "particles per specimen", per_specimen,
                 "at most the number of particles, " + std::to_string(particles) + ", is expected");
    const double most = std::floor(static_cast<double>(particles) / per_specimen);
    core::expect(most <= 4e9, "particles per specimen", per_specimen,
                 "a number that asks for at most 4e9 specimens is expected");
    Counts counts = cube_counts(box, static_cast<std::size_t>(most));
    while (static_cast<double>(counts[0]) * counts[1] * counts[2] > most)
      --counts[axis_of_shortest_cells(box, counts)];
    return {box, counts};
  }

  const geometry::Box& box() const noexcept { return box_; }
  /// Number of cells along x, y, z.
  const Counts& counts() const noexcept { return counts_; }
  std::size_t cell_count() const noexcept { return count(0) * count(1) * count(2); }
  /// Volume of a cell, m^3: the same for all.
  double volume(std::size_t) const noexcept { return volume_; }
  /// Edges of a cell, m.
  Vec3 cell_size() const { return box_.size().array() / Vec3(counts_[0], counts_[1], counts_[2]).array(); }

  /// Mean specimen length, the largest distance between two corners of a specimen averaged over the
  /// specimens, in units of L, the cube root of the box's volume (the side of a cube).                 [L17]
  /// section 2.5
  double mean_specimen_length() const { return cell_size().norm() / std::cbrt(box_.volume()); }

  /// Number of cell (i, j, k).
  std::size_t index(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return i + count(0) * (j + count(1) * k);
  }

  /// Centre of a cell, m.
  Vec3 centre(std::size_t cell) const {
    return corner(static_cast<double>(cell % count(0)) + 0.5,
                  static_cast<double>(cell / count(0) % count(1)) + 0.5,
                  static_cast<double>(cell / (count(0) * count(1))) + 0.5);
  }

  /// Coordinates of a point within a cell, from 0 to 1 along each axis; in a periodic direction those of the image nearest to
  /// the cell. A point outside the cell has one below 0 or above 1.
  Vec3 local(std::size_t cell, const Vec3& point) const {
    const std::array<std::size_t, 3> place{cell % count(0), cell / count(0) % count(1),
                                           cell / (count(0) * count(1))};
    Vec3 result;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      const double n = directions_[k].count;
      double c = directions_[k].coordinate(point[axis]) - static_cast<double>(place[k]);
      if (directions_[k].periodic)
        c -= n * std::round((c - 0.5) / n);
      result[axis] = c;
    }
    return result;
  }

  /// Cell that holds a point; none for a point outside the walls (or not finite).
  std::optional<std::size_t> locate(const Vec3& point) const {
    if (!point.allFinite())
      return std::nullopt;
    const auto walks = walks_along({point, Vec3::Zero()});
    return inside(walks) ? std::optional(cell_of(walks)) : std::nullopt;
  }

  /// Calls callback(cell, begin, end) for each piece of the segment, from its start to its end, and returns the
  /// part that lies outside the walls; see CutsSegments. A piece along a face goes to the cell above it.
  ///
  /// A cell is met twice if the segment re-enters it through a periodic face.
  /// @param segment  of finite ends
  /// @complexity     O(cells met)
  template <class Callback>
  double for_each_piece(const geometry::Segment& segment, Callback&& callback) const {
    auto walks = walks_along(segment);
    double done = 0;
    double outside = 0;
    while (true) {
      const std::size_t next = first_crossing(walks);
      const double until = std::min(1.0, walks[next].crossing);
      if (until > done) { // a segment through an edge or a corner crosses several planes at once
        if (inside(walks))
          callback(cell_of(walks), done, until);
        else
          outside += until - done;
        done = until;
      }
      if (until >= 1)
        return outside;
      walks[next].step(directions_[next]);
    }
  }

  /// Corners of the cells, m, each once, x running first: (nx + 1)(ny + 1)(nz + 1) points.
  std::vector<Vec3> corner_points() const {
    std::vector<Vec3> points;
    points.reserve((count(0) + 1) * (count(1) + 1) * (count(2) + 1));
    for (int k = 0; k <= counts_[2]; ++k)
      for (int j = 0; j <= counts_[1]; ++j)
        for (int i = 0; i <= counts_[0]; ++i)
          points.push_back(corner(i, j, k));
    return points;
  }

  /// [cells x 8] numbers of each cell's corners in corner_points(), in the order of VTK_HEXAHEDRON: the face
  /// of low z counter-clockwise seen from above, then that of high z.
  std::vector<std::array<std::uint32_t, 8>> cell_corners() const {
    std::vector<std::array<std::uint32_t, 8>> cells;
    cells.reserve(cell_count());
    const auto row = static_cast<std::uint32_t>(counts_[0] + 1);
    const auto layer = row * static_cast<std::uint32_t>(counts_[1] + 1);
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(counts_[2]); ++k)
      for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(counts_[1]); ++j)
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(counts_[0]); ++i) {
          const std::uint32_t c = i + row * j + layer * k;
          const std::uint32_t d = c + layer;
          cells.push_back({c, c + 1, c + row + 1, c + row, d, d + 1, d + row + 1, d + row});
        }
    return cells;
  }

private:
  using Walks = std::array<detail::GridWalk, 3>;

  std::size_t count(std::size_t axis) const noexcept { return static_cast<std::size_t>(counts_[axis]); }

  static Counts cube_counts(const geometry::Box& box, std::size_t specimens) {
    box.validate();
    core::expect(specimens >= 1 && specimens <= 4'000'000'000u, "number of specimens", specimens,
                 "1 to 4e9 is expected");
    const double edge = std::cbrt(box.volume() / static_cast<double>(specimens));
    Counts counts{};
    for (std::size_t k = 0; k < 3; ++k)
      counts[k] =
          static_cast<int>(std::clamp(std::round(box.size()[static_cast<Eigen::Index>(k)] / edge), 1.0, 2e9));
    return counts;
  }

  static std::size_t axis_of_shortest_cells(const geometry::Box& box, const Counts& counts) {
    std::size_t shortest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k)
      if (const double edge = box.size()[static_cast<Eigen::Index>(k)] / counts[k];
          counts[k] > 1 && edge < least) {
        least = edge;
        shortest = k;
      }
    return shortest;
  }

  /// Point of grid coordinates (i, j, k); the last corners lie exactly on the box's upper faces.
  Vec3 corner(double i, double j, double k) const {
    const Vec3 part(i / counts_[0], j / counts_[1], k / counts_[2]);
    return (Vec3::Ones() - part).cwiseProduct(box_.lower) + part.cwiseProduct(box_.upper);
  }

  Walks walks_along(const geometry::Segment& segment) const {
    return {detail::GridWalk(directions_[0], segment.start[0], segment.extent[0]),
            detail::GridWalk(directions_[1], segment.start[1], segment.extent[1]),
            detail::GridWalk(directions_[2], segment.start[2], segment.extent[2])};
  }
  static std::size_t first_crossing(const Walks& walks) {
    const std::size_t xy = walks[1].crossing < walks[0].crossing ? 1 : 0;
    return walks[2].crossing < walks[xy].crossing ? 2 : xy;
  }
  bool inside(const Walks& walks) const {
    return directions_[0].holds(walks[0].cell) && directions_[1].holds(walks[1].cell) &&
           directions_[2].holds(walks[2].cell);
  }
  std::size_t cell_of(const Walks& walks) const {
    return index(static_cast<std::size_t>(walks[0].cell), static_cast<std::size_t>(walks[1].cell),
                 static_cast<std::size_t>(walks[2].cell));
  }

  geometry::Box box_;
  Counts counts_;
  std::array<detail::GridDirection, 3> directions_;
  double volume_ = 0;
};

static_assert(Tessellation<Hexahedra>);

} // namespace cdem::stress::tessellation
