#pragma once

/// @file
/// When growing spheres touch.

#include <cdem/packing/detail/cell_grid.hpp>
#include <cdem/packing/detail/sphere_state.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace cdem::packing::detail {

/// How two growing spheres near each other: after the time t their centres' distance squared less the sum of their
/// radii squared is a t^2 + 2 b t + c.
struct Approach {
  double a, b, c;

  /// @param d  from one centre to the other      @param w  rate of d
  /// @param S  sum of the radii                  @param G  rate of S, not negative
  Approach(const Vec3& d, const Vec3& w, double S, double G)
      : a(w[0] * w[0] + w[1] * w[1] + w[2] * w[2] - G * G),
        b(d[0] * w[0] + d[1] * w[1] + d[2] * w[2] - S * G),
        c(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - S * S) {}

  /// Time until they touch, the smallest root t >= 0 at which the surfaces approach, written without cancellation;
  /// infinity if there is none.
  ///
  /// Spheres that touch or overlap by rounding (c <= 0) collide at once if they approach (b < 0), and are let go if
  /// they part.
  double time_to_contact() const {
    const double discriminant = b * b - a * c;
    const double root = std::sqrt(std::max(discriminant, 0.0));
    if (b < 0) {
      const double time = std::max(c, 0.0) / (root - b);
      return discriminant >= 0 || c <= 0 ? time : never;
    }
    // The surfaces part; they meet again only if growth outruns them.
    return a < 0 ? (b + root) / -a : never;
  }
};

/// Time until a growing sphere reaches its shell from inside; infinity if it never does.
///
/// Smallest t > 0 at which |y + v t| = room - g t.
/// @param y     from the shell's centre to the sphere's     @param v  rate of y
/// @param room  the shell's radius minus the sphere's       @param g  rate of the sphere's radius, not negative
inline double time_to_shell(const Vec3& y, const Vec3& v, double room, double g) {
  const double a = v.squaredNorm() - g * g;
  const double b = y.dot(v) + room * g;
  const double c = y.squaredNorm() - room * room;
  if (c >= 0 || room <= 0)
    return 0;
  const double root = std::sqrt(std::max(b * b - a * c, 0.0));
  if (b > 0)
    return -c / (b + root);
  return a > 0 ? (root - b) / a : never;
}

/// The spheres as they are at one time.
struct Present {
  double now, scale, growth; ///< radii are sizes times scale, and grow at sizes times growth
  bool periodic;
};

/// The first contact that comes before the other sphere's next event, and its place in the list.
struct Soonest {
  double time = never; ///< from now
  std::size_t place = 0;
};

/// Of several at the same time the one with the smallest number.
inline Soonest soonest_of(const double* times, std::span<const ParticleIndex> list, const Body* bodies,
                          double now) {
  Soonest soonest;
  for (std::size_t k = 0; k < list.size(); ++k)
    if (now + times[k] < bodies[list[k]].next &&
        (times[k] < soonest.time || (times[k] == soonest.time && list[k] < list[soonest.place])))
      soonest = {times[k], k};
  return soonest;
}

/// Times from now until one sphere touches each of others, in the order of the list; the same bits on any processor.
/// @param list    not empty
/// @param centre  of the sphere at the present time
/// @param times   [list, rounded up to a multiple of 4]
/// @return        the first that comes before the other sphere's next event
inline Soonest plain_contact_times(const Body* bodies, std::span<const ParticleIndex> list,
                                   const Body& sphere, const Vec3& centre, const Present& at, double* times) {
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Body& other = bodies[list[k]];
    const Vec3 apart = other.centre_at(at.now) - centre;
    const double size = sphere.size + other.size;
    times[k] = Approach(at.periodic ? nearest_image(apart) : apart, other.velocity - sphere.velocity,
                        size * at.scale, size * at.growth)
                   .time_to_contact();
  }
  return soonest_of(times, list, bodies, at.now);
}

#if defined(__x86_64__) && defined(__GNUC__)

/// Four numbers, one of each of four bodies.
struct Four {
  __m256d x, y, z, w;
};

/// The halves of four bodies turned into four numbers of each kind. Read 16 bytes at a time, as they are written: a
/// wider read would have to wait for a body that has just changed.
[[gnu::target("avx2"), gnu::always_inline]] inline Four four_of(const double* a, const double* b,
                                                                const double* c, const double* d) {
  const __m256d ac = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(a)), _mm_load_pd(c), 1);
  const __m256d bd = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(b)), _mm_load_pd(d), 1);
  const __m256d ac2 = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(a + 2)), _mm_load_pd(c + 2), 1);
  const __m256d bd2 = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(b + 2)), _mm_load_pd(d + 2), 1);
  return {_mm256_unpacklo_pd(ac, bd), _mm256_unpackhi_pd(ac, bd), _mm256_unpacklo_pd(ac2, bd2),
          _mm256_unpackhi_pd(ac2, bd2)};
}

/// plain_contact_times() in registers of four numbers, without fused multiply-add.
[[gnu::target("avx2")]] inline Soonest avx2_contact_times(const Body* bodies,
                                                          std::span<const ParticleIndex> list,
                                                          const Body& sphere, const Vec3& centre,
                                                          const Present& at, double* times) {
  const __m256d zero = _mm256_setzero_pd(), now = _mm256_set1_pd(at.now), scale = _mm256_set1_pd(at.scale),
                growth = _mm256_set1_pd(at.growth), infinity = _mm256_set1_pd(never);
  // Adding 3 * 2^51 leaves no bits for a fraction; without a period everything is its own nearest image.
  const __m256d shift = _mm256_set1_pd(0x1.8p52), period = _mm256_set1_pd(at.periodic ? 1 : 0);
  const __m256d x = _mm256_set1_pd(centre[0]), y = _mm256_set1_pd(centre[1]), z = _mm256_set1_pd(centre[2]),
                u = _mm256_set1_pd(sphere.velocity[0]), v = _mm256_set1_pd(sphere.velocity[1]),
                w = _mm256_set1_pd(sphere.velocity[2]), size = _mm256_set1_pd(sphere.size);
  __m256d soonest = infinity, place_of_soonest = zero, alike = zero;
  __m256d here = _mm256_setr_pd(0, 1, 2, 3);
  const std::size_t last = list.size() - 1;
  for (std::size_t k = 0; k < list.size(); k += 4) {
    const double* const a = bodies[list[k]].origin.data();
    const double* const b = bodies[list[std::min(k + 1, last)]].origin.data();
    const double* const c = bodies[list[std::min(k + 2, last)]].origin.data();
    const double* const d = bodies[list[std::min(k + 3, last)]].origin.data();
    const Four place = four_of(a, b, c, d), rate = four_of(a + 4, b + 4, c + 4, d + 4);
    __m256d dx = (place.x + rate.x * now) - x, dy = (place.y + rate.y * now) - y,
            dz = (place.z + rate.z * now) - z;
    dx = dx - period * ((dx + shift) - shift);
    dy = dy - period * ((dy + shift) - shift);
    dz = dz - period * ((dz + shift) - shift);
    const __m256d du = rate.x - u, dv = rate.y - v, dw = rate.z - w, sum = size + rate.w;
    const __m256d S = sum * scale, G = sum * growth;
    const __m256d qa = ((du * du + dv * dv) + dw * dw) - G * G;
    const __m256d qb = ((dx * du + dy * dv) + dz * dw) - S * G;
    const __m256d qc = ((dx * dx + dy * dy) + dz * dz) - S * S;
    const __m256d discriminant = qb * qb - qa * qc;
    const __m256d root = _mm256_sqrt_pd(_mm256_max_pd(discriminant, zero));
    const __m256d nearing = _mm256_cmp_pd(qb, zero, _CMP_LT_OQ);
    const __m256d above = _mm256_blendv_pd(qb + root, _mm256_max_pd(qc, zero), nearing);
    const __m256d below = _mm256_blendv_pd(zero - qa, root - qb, nearing);
    const __m256d meet = _mm256_blendv_pd(
        _mm256_cmp_pd(qa, zero, _CMP_LT_OQ),
        _mm256_or_pd(_mm256_cmp_pd(discriminant, zero, _CMP_GE_OQ), _mm256_cmp_pd(qc, zero, _CMP_LE_OQ)),
        nearing);
    const __m256d touch = _mm256_blendv_pd(infinity, above / below, meet);
    _mm256_storeu_pd(times + k, touch);
    const __m256d contact =
        _mm256_blendv_pd(infinity, touch, _mm256_cmp_pd(now + touch, place.w, _CMP_LT_OQ));
    const __m256d sooner = _mm256_cmp_pd(contact, soonest, _CMP_LT_OQ);
    alike = _mm256_or_pd(alike, _mm256_and_pd(_mm256_cmp_pd(contact, soonest, _CMP_EQ_OQ),
                                              _mm256_cmp_pd(contact, infinity, _CMP_LT_OQ)));
    soonest = _mm256_blendv_pd(soonest, contact, sooner);
    place_of_soonest = _mm256_blendv_pd(place_of_soonest, here, sooner);
    here = here + _mm256_set1_pd(4);
  }
  const __m128d pair = _mm_min_pd(_mm256_castpd256_pd128(soonest), _mm256_extractf128_pd(soonest, 1));
  const double time = _mm_cvtsd_f64(_mm_min_sd(pair, _mm_unpackhi_pd(pair, pair)));
  const auto lanes =
      static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(soonest, _mm256_set1_pd(time), _CMP_EQ_OQ)));
  if (time < never && (_mm256_movemask_pd(alike) != 0 || (lanes & (lanes - 1)) != 0))
    return soonest_of(times, list, bodies, at.now);
  alignas(32) double places[4];
  _mm256_store_pd(places, place_of_soonest);
  const auto place = static_cast<std::size_t>(places[std::countr_zero(lanes)]);
  return {time, std::min(place, last)};
}

inline bool has_avx2() noexcept {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}

#else

inline bool has_avx2() noexcept {
  return false;
}

#endif

/// plain_contact_times() by the quickest way this processor has.
inline Soonest contact_times(const Body* bodies, std::span<const ParticleIndex> list, const Body& sphere,
                             const Vec3& centre, const Present& at, double* times) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (has_avx2())
    return avx2_contact_times(bodies, list, sphere, centre, at, times);
#endif
  return plain_contact_times(bodies, list, sphere, centre, at, times);
}

} // namespace cdem::packing::detail
