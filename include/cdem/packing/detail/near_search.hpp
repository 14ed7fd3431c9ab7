#pragma once

/// @file
/// Search through candidates for the spheres near a sphere, four at a time.

#include <cdem/core/types.hpp>
#include <cdem/packing/detail/quad.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace cdem::packing::detail {

/// What makes a sphere near: its surface is closer than `skin`, at this scale of the radii.
struct NearRule {
  double scale, skin;
  bool wraps; ///< whether through a periodic face, too
};

/// Spheres of some cells, coordinate by coordinate.
class NearCandidates {
public:
  void clear() { count_ = 0; }

  /// Adds the spheres [begin, end) of all.
  void add(const Quad* spheres, ParticleIndex begin, ParticleIndex end) {
    make_room(count_ + (end - begin));
    double* const __restrict x = values_[0].data() + count_;
    double* const __restrict y = values_[1].data() + count_;
    double* const __restrict z = values_[2].data() + count_;
    double* const __restrict size = values_[3].data() + count_;
    ParticleIndex* const __restrict index = spheres_.data() + count_;
    for (ParticleIndex j = begin; j < end; ++j) {
      const std::size_t c = j - begin;
      x[c] = spheres[j].component[0];
      y[c] = spheres[j].component[1];
      z[c] = spheres[j].component[2];
      size[c] = spheres[j].component[3];
      index[c] = j;
    }
    count_ += end - begin;
  }

  /// Those near sphere `i`, then `i` itself up to a multiple of four.
  /// @return  their number; they are in found()
  std::size_t find_near(const Quad& own, ParticleIndex i, const NearRule& rule) {
#if defined(__x86_64__)
    if (core::has_avx2())
      return find_near_avx2(own, i, rule);
#endif
    return find_near_anywhere(own, i, rule);
  }
  const ParticleIndex* found() const {
    return found_.data();
  }

private:
#if defined(__x86_64__)
  [[gnu::target("avx2")]] std::size_t find_near_avx2(const Quad& own, ParticleIndex i, const NearRule& rule) {
    return rule.wraps ? search<true>(own, i, rule) : search<false>(own, i, rule);
  }
#endif
  std::size_t find_near_anywhere(const Quad& own, ParticleIndex i, const NearRule& rule) {
    return rule.wraps ? search<true>(own, i, rule) : search<false>(own, i, rule);
  }

  template <bool wraps>
  [[gnu::always_inline]] std::size_t search(const Quad& own, ParticleIndex i, const NearRule& rule) {
    for (std::size_t c = count_; c % 4 != 0; ++c) { // near to nothing
      values_[0][c] = std::numeric_limits<double>::quiet_NaN();
      spheres_[c] = i;
    }
    const double *const x = values_[0].data(), *const y = values_[1].data(), *const z = values_[2].data(),
                        *const size = values_[3].data();
    const ParticleIndex* const index = spheres_.data();
    ParticleIndex* const found = found_.data();
    const double own_x = own.component[0], own_y = own.component[1], own_z = own.component[2],
                 own_reach = own.component[3] * rule.scale + rule.skin;
    std::size_t count = 0;
    for (std::size_t c = 0; c < count_; c += 4) {
      core::Four dx, dy, dz, reach;
      load(dx, x + c);
      load(dy, y + c);
      load(dz, z + c);
      load(reach, size + c);
      dx -= own_x;
      dy -= own_y;
      dz -= own_z;
      if constexpr (wraps) {
        wrap(dx);
        wrap(dy);
        wrap(dz);
      }
      reach = reach * rule.scale + own_reach;
      const auto near = dx * dx + dy * dy + dz * dz < reach * reach;
      for (std::size_t lane = 0; lane < 4; ++lane) {
        const ParticleIndex j = index[c + lane];
        found[count] = j;
        count += static_cast<std::size_t>(-near[lane]) & static_cast<std::size_t>(j != i);
      }
    }
    while (count % 4 != 0)
      found[count++] = i; // acts on itself with no force
    return count;
  }

  void make_room(std::size_t count) {
    if (count + 4 < spheres_.size())
      return;
    for (auto& values : values_)
      values.resize(2 * count + 64);
    spheres_.resize(2 * count + 64);
    found_.resize(2 * count + 64);
  }

  std::size_t count_ = 0;
  std::array<std::vector<double>, 4> values_; ///< x, y, z, size
  std::vector<ParticleIndex> spheres_, found_;
};

} // namespace cdem::packing::detail
