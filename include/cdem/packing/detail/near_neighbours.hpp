#pragma once

/// @file
/// Near-neighbour lists that are renewed one sphere at a time.

#include <cdem/packing/detail/cell_grid.hpp>
#include <cdem/packing/detail/sphere_state.hpp>

#include <algorithm>
#include <cmath>
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
/// @complexity  a renewal looks at the spheres of the surrounding cells; about 150 bytes a sphere near jamming
class NearNeighbours {
public:
  NearNeighbours(std::size_t spheres, bool periodic)
      : grid_(spheres, cell_edge(spheres), periodic), shells_(spheres), slices_(spheres),
        periodic_(periodic) {}

  const Shell& shell(ParticleIndex sphere) const { return shells_[sphere]; }
  const CellGrid& grid() const { return grid_; }

  const SphereArray<Shell>& shells() const { return shells_; }

  /// Asks for the memory of which of() and shell() are going to speak.
  void fetch(ParticleIndex sphere) const {
    __builtin_prefetch(&slices_[sphere]);
    __builtin_prefetch(&shells_[sphere]);
  }
  /// The same for the list itself; reads its place.
  void fetch_list(ParticleIndex sphere) const { __builtin_prefetch(entries_.data() + slices_[sphere].begin); }

  /// The spheres that `sphere` may meet.
  std::span<const ParticleIndex> of(ParticleIndex sphere) const {
    const Slice& slice = slices_[sphere];
    return {entries_.data() + slice.begin, slice.count};
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
      const std::size_t begin = entries_.size();
      find(i, [this](ParticleIndex j) { entries_.push_back(j); });
      const std::size_t count = entries_.size() - begin;
      entries_.resize(begin + count + spare_entries, no_sphere);
      slices_[i] = {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(count),
                    static_cast<std::uint32_t>(count + spare_entries)};
    }
  }

  /// Gives a sphere a new shell and changes its list and its neighbours'.
  void renew(ParticleIndex sphere, const Shell& shell) {
    for (const ParticleIndex other : of(sphere))
      drop(other, sphere);
    slices_[sphere].count = 0;
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
  struct Slice {
    std::uint32_t begin = 0, count = 0, capacity = 0;
  };
  static constexpr std::size_t spare_entries = 4;

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
    Slice& slice = slices_[sphere];
    ParticleIndex* const begin = entries_.data() + slice.begin;
    ParticleIndex* const last = begin + --slice.count;
    *std::find(begin, last, other) = *last;
  }

  void append(ParticleIndex sphere, ParticleIndex other) {
    Slice& slice = slices_[sphere];
    if (slice.count == slice.capacity)
      move_to_end(slice);
    entries_[slice.begin + slice.count++] = other;
  }

  void move_to_end(Slice& slice) {
    const auto begin = static_cast<std::uint32_t>(entries_.size());
    unused_ += slice.capacity;
    slice.capacity = slice.capacity + slice.capacity / 2 + static_cast<std::uint32_t>(spare_entries);
    entries_.resize(entries_.size() + slice.capacity, no_sphere);
    std::copy_n(entries_.begin() + slice.begin, slice.count, entries_.begin() + begin);
    slice.begin = begin;
  }

  /// Closes the holes that grown lists have left.
  void compact() {
    SphereArray<ParticleIndex> entries;
    entries.reserve(entries_.size() - unused_);
    for (Slice& slice : slices_) {
      const auto begin = static_cast<std::uint32_t>(entries.size());
      const auto from = entries_.begin() + slice.begin;
      entries.insert(entries.end(), from, from + slice.capacity);
      slice.begin = begin;
    }
    entries_.swap(entries);
    unused_ = 0;
  }

  CellGrid grid_;                      ///< by the shells' centres
  SphereArray<Shell> shells_;          ///< [spheres]
  SphereArray<Slice> slices_;          ///< [spheres] where its list stands in `entries_`
  SphereArray<ParticleIndex> entries_; ///< the lists, each followed by spare room
  std::size_t unused_ = 0;             ///< entries that belong to no list any more
  double largest_ = 0;                 ///< no shell's radius is larger
  bool periodic_;
};

} // namespace cdem::packing::detail
