#pragma once

/// @file
/// What a neighbour search is: the one thing the network layer asks of a spatial index.

#include <cdem/core/types.hpp>
#include <cdem/geometry/box.hpp>

#include <concepts>
#include <vector>

namespace cdem::network {

namespace detail {
/// The least a search may hand its finds to: something called with a particle's number.
struct AnyVisitor {
  void operator()(ParticleIndex) const {}
};
} // namespace detail

/// Is made from the points, one per particle, and the box whose periodic directions it respects.
template <class S>
concept BuiltFromPoints = std::constructible_from < S,
        const std::vector<Vec3>
&, const geometry::Box& > ;

/// `search.for_each_within(point, radius, visit)` calls visit(j) for every particle j with a periodic image
/// within `radius` of `point`, once for each such image, in any order; one that is farther by rounding alone
/// may be visited too. It is const and may be called by several threads at once.
template <class S>
concept FindsWithinRadius = requires(const S& search, const Vec3& point, double radius,
                                     detail::AnyVisitor visit) {
  search.for_each_within(point, radius, visit);
};

/// A spatial index of the particles' centres. Models: KdTree.
template <class S>
concept NeighbourSearch = BuiltFromPoints<S> && FindsWithinRadius<S>;

} // namespace cdem::network
