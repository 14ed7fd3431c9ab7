#pragma once

/// @file
/// Near-neighbour lists that are renewed one sphere at a time.

#include <cdem/packing/detail/cell_grid.hpp>
#include <cdem/packing/detail/sphere_state.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace cdem::packing::detail {

/// The ball a sphere may not leave before its list of neighbours is renewed (unit of length: the cube's edge).
struct Shell {
  Vec3 centre;
  double radius;
};

/// Lists of the spheres whose shells overlap.
///
/// While each of two spheres is inside its shell, they can only touch if the shells overlap; so a sphere's list holds
/// everything it can meet, whatever the growth, until it reaches its own shell (Donev, Torquato, Stillinger 2005).
/// @complexity  a renewal looks at the spheres of the surrounding cells; about 120 bytes a sphere near jamming
class NearNeighbours {
public:
  NearNeighbours(std::size_t spheres, bool periodic)
      : grid_(spheres, cell_edge(spheres), periodic), shells_(spheres), lists_(spheres), periodic_(periodic) {
  }

  const Shell& shell(ParticleIndex sphere) const { return shells_[sphere]; }
  const CellGrid& grid() const { return grid_; }

  const SphereArray<Shell>& shells() const { return shells_; }

  /// Asks for the memory of shell() and of all but long lists. Always inlined, as all such functions are: GCC takes a
  /// call that only prefetches for one without effect, and leaves it out.
  [[gnu::always_inline]] void fetch(ParticleIndex sphere) const {
    __builtin_prefetch(&lists_[sphere]);
    __builtin_prefetch(&shells_[sphere]);
  }
  /// Asks for a long list; reads what fetch() asked for.
  [[gnu::always_inline]] void fetch_long(ParticleIndex sphere) const {
    const List& list = lists_[sphere];
    if (list.capacity > own_entries)
      for (std::uint32_t k = 0; k < list.count; k += 16)
        __builtin_prefetch(entries_.data() + list.begin + k);
  }

  /// The spheres that `sphere` may meet.
  std::span<const ParticleIndex> of(ParticleIndex sphere) const {
    const List& list = lists_[sphere];
    return {begin_of(list), list.count};
  }

  /// Makes all the lists anew. @param shells  [spheres], centres in the unit cube
  void rebuild(SphereArray<Shell> shells) {
    shells_ = std::move(shells);
    grid_.clear();
    largest_ = 0;
    for (ParticleIndex i = 0; i < shells_.size(); ++i) {
      grid_.insert(i, shells_[i].centre);
      largest_ = std::max(largest_, shells_[i].radius);
    }
    entries_.clear();
    unused_ = 0;
    for (ParticleIndex i = 0; i < shells_.size(); ++i) {
      lists_[i].count = 0;
      lists_[i].capacity = own_entries;
      find(i, [this, i](ParticleIndex j) { append(i, j); });
    }
  }

  /// Gives a sphere a new shell and changes its list and its neighbours'.
  void renew(ParticleIndex sphere, const Shell& shell) {
    for (const ParticleIndex other : of(sphere))
      drop(other, sphere);
    lists_[sphere].count = 0;
    grid_.remove(sphere, shells_[sphere].centre);
    shells_[sphere] = shell;
    grid_.insert(sphere, shell.centre);
    largest_ = std::max(largest_, shell.radius);
    find(sphere, [this, sphere](ParticleIndex other) {
      append(sphere, other);
      append(other, sphere);
    });
    if (unused_ > entries_.size() / 2 && unused_ > 4096)
      compact();
  }

private:
  static constexpr std::uint32_t own_entries = 13;

  /// A list of up to 13 fills a cache line; longer ones stand in `entries_`.
  struct alignas(64) List {
    std::uint32_t count = 0, capacity = own_entries, begin = 0;
    std::array<ParticleIndex, own_entries> own = {};
  };

  const ParticleIndex* begin_of(const List& list) const {
    return list.capacity > own_entries ? entries_.data() + list.begin : list.own.data();
  }
  ParticleIndex* begin_of(List& list) {
    return list.capacity > own_entries ? entries_.data() + list.begin : list.own.data();
  }

  /// Cells of about two spheres: fewer would cost more empty ones, more spheres more distances.
  static double cell_edge(std::size_t spheres) { return std::cbrt(1.8 / static_cast<double>(spheres)); }

  template <class Take>
  void find(ParticleIndex sphere, Take&& take) const {
    const Shell& shell = shells_[sphere];
    grid_.visit_near(shell.centre, shell.radius + largest_, [&](ParticleIndex other) {
      Vec3 d = shells_[other].centre - shell.centre;
      if (periodic_)
        d = nearest_image(d);
      const double reach = shells_[other].radius + shell.radius;
      if (d.squaredNorm() < reach * reach && other != sphere)
        take(other);
      return true;
    });
  }

  void drop(ParticleIndex sphere, ParticleIndex other) {
    List& list = lists_[sphere];
    ParticleIndex* const begin = begin_of(list);
    ParticleIndex* const last = begin + --list.count;
    *std::find(begin, last, other) = *last;
  }

  void append(ParticleIndex sphere, ParticleIndex other) {
    List& list = lists_[sphere];
    if (list.count == list.capacity)
      move_to_end(list);
    begin_of(list)[list.count++] = other;
  }

  void move_to_end(List& list) {
    const auto begin = static_cast<std::uint32_t>(entries_.size());
    const std::uint32_t capacity = (list.capacity + list.capacity / 2 + 15) / 16 * 16;
    entries_.resize(entries_.size() + capacity, no_sphere);
    std::copy_n(begin_of(list), list.count, entries_.begin() + begin);
    if (list.capacity > own_entries)
      unused_ += list.capacity;
    list.capacity = capacity;
    list.begin = begin;
  }

  /// Closes the holes that grown lists have left.
  void compact() {
    SphereArray<ParticleIndex> entries;
    entries.reserve(entries_.size() - unused_);
    for (List& list : lists_) {
      if (list.capacity == own_entries)
        continue;
      const auto begin = static_cast<std::uint32_t>(entries.size());
      const auto from = entries_.begin() + list.begin;
      entries.insert(entries.end(), from, from + list.capacity);
      list.begin = begin;
    }
    entries_.swap(entries);
    unused_ = 0;
  }

  CellGrid grid_;                      ///< by the shells' centres
  SphereArray<Shell> shells_;          ///< [spheres]
  SphereArray<List> lists_;            ///< [spheres]
  SphereArray<ParticleIndex> entries_; ///< the long lists, each followed by spare room
  std::size_t unused_ = 0;             ///< entries that belong to no list any more
  double largest_ = 0;                 ///< no shell's radius is larger
  bool periodic_;
};

} // namespace cdem::packing::detail
