#pragma once

/// @file
/// Neighbour search in a k-d tree. The only header that includes nanoflann.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/network/neighbour_search.hpp>

#include <nanoflann.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace cdem::network {

namespace detail {

/// Points as nanoflann wants to read them.
struct PointCloud {
  std::vector<Vec3> points;

  std::size_t kdtree_get_point_count() const noexcept { return points.size(); }
  double kdtree_get_pt(std::size_t point, std::size_t axis) const noexcept {
    return points[point][static_cast<Eigen::Index>(axis)];
  }
  template <class BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const noexcept {
    return false; // left to nanoflann
  }
};

/// Hands each point found straight to the visitor: no list of results, and none of the result types that
/// changed from one release of nanoflann to the next.
template <class Visitor>
class VisitingResultSet {
public:
  using DistanceType = double;
  using IndexType = ParticleIndex;

  VisitingResultSet(double squared_radius, Visitor& visit) : squared_radius_(squared_radius), visit_(visit) {}

  bool addPoint(double, ParticleIndex point) {
    visit_(point);
    ++found_;
    return true; // go on searching
  }
  double worstDist() const noexcept { return squared_radius_; }
  std::size_t size() const noexcept { return found_; }
  bool empty() const noexcept { return found_ == 0; }
  bool full() const noexcept { return true; }
  void sort() const noexcept {}

private:
  double squared_radius_;
  Visitor& visit_;
  std::size_t found_ = 0;
};

} // namespace detail

/// k-d tree of the particles' centres, periodic images included; a model of NeighbourSearch.
///
/// The tree holds each particle once, wrapped into the box; a query whose ball reaches through a periodic
/// face is repeated about the images of its point. This needs no ghost copies, hence no bound on the radius
/// when the tree is built, and costs nothing away from the faces. Works with nanoflann 1.4 and later.
class KdTree {
public:
  /// @param points  [particles] m, finite
  /// @param box     its periodic directions are respected; points may lie outside it
  /// @throws        core::InvalidInput for no point, more than 2^32 - 1 points or a bad box
  /// @complexity    O(particles log particles), 24 bytes a particle and the tree of about the same size
  KdTree(const std::vector<Vec3>& points, const geometry::Box& box)
      : box_(checked(points, box)), cloud_{wrapped(points, box)}, tree_(3, cloud_, {points_per_leaf}) {
    double largest = std::max(box.lower.cwiseAbs().maxCoeff(), box.upper.cwiseAbs().maxCoeff());
    for (const Vec3& point : cloud_.points)
      largest = std::max(largest, point.cwiseAbs().maxCoeff());
    rounding_ = 16 * std::numeric_limits<double>::epsilon() * largest;
  }
  KdTree(const KdTree&) = delete; // nanoflann's index refers to the points
  KdTree& operator=(const KdTree&) = delete;

  /// Calls visit(j) for each particle j with a periodic image within `radius` of `point`, once for each such
  /// image.
  ///
  /// The radius is enlarged by the rounding error of the coordinates, so that no pair is lost to it: the
  /// caller compares exactly what it must compare exactly.
  /// @param radius  m; nothing is visited if it is not above 0, nor is a periodic image farther than the next
  ///                box: below half of every periodic edge nothing is missed and no particle is visited twice
  template <class Visitor>
  void for_each_within(const Vec3& point, double radius, Visitor&& visit) const {
    if (!(radius > 0))
      return;
    const double reach = radius * (1 + 8 * std::numeric_limits<double>::epsilon()) + rounding_;
    visit_images(box_.wrap(point), reach, 0, visit);
  }

private:
  using Metric = nanoflann::L2_Simple_Adaptor<double, detail::PointCloud, double, ParticleIndex>;
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, detail::PointCloud, 3, ParticleIndex>;

  static constexpr std::size_t points_per_leaf = 12;

  static const geometry::Box& checked(const std::vector<Vec3>& points, const geometry::Box& box) {
    box.validate();
    core::expect(!points.empty(), "number of points", points.size(), "at least 1 is expected");
    core::expect(points.size() <= std::numeric_limits<ParticleIndex>::max(), "number of points",
                 points.size(), "at most 2^32 - 1 is expected");
    return box;
  }

  static std::vector<Vec3> wrapped(std::vector<Vec3> points, const geometry::Box& box) {
    for (Vec3& point : points)
      point = box.wrap(point);
    return points;
  }

  /// Queries about `point` and about those of its images, along `axis` and the axes after it, whose ball
  /// reaches into the box.
  template <class Visitor>
  void visit_images(Vec3 point, double reach, int axis, Visitor& visit) const {
    if (axis == 3) {
      detail::VisitingResultSet<Visitor> results(reach * reach, visit);
      static_cast<void>(tree_.radiusSearchCustomCallback(point.data(), results)); // the count
      return;
    }
    visit_images(point, reach, axis + 1, visit);
    if (!box_.periodic[static_cast<std::size_t>(axis)])
      return;
    const double edge = box_.upper[axis] - box_.lower[axis];
    const double coordinate = point[axis];
    if (coordinate - reach < box_.lower[axis]) {
      point[axis] = coordinate + edge;
      visit_images(point, reach, axis + 1, visit);
    }
    if (coordinate + reach >= box_.upper[axis]) {
      point[axis] = coordinate - edge;
      visit_images(point, reach, axis + 1, visit);
    }
  }

  geometry::Box box_;
  detail::PointCloud cloud_;
  Tree tree_;
  double rounding_ = 0; ///< bound on what rounding may add to a distance, m
};

static_assert(NeighbourSearch<KdTree>);

} // namespace cdem::network
