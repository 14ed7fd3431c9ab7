#pragma once

/// @file
/// The force kernel in 256-bit registers, one bond at a time: x, y, z and a zero fill a register.
///
/// Compiled for AVX2 whatever the flags of the translation unit, and used where the processor has it. It does not
/// ask for fused multiply-add, so that it gives the same bits as the kernel for any processor (unless the whole
/// translation unit is compiled for fused multiply-add, as by -march=native).

#include <cdem/bond/detail/bond_block.hpp>

#if defined(__x86_64__) && defined(__GNUC__)

#include <algorithm>
#include <immintrin.h>

namespace cdem::bond::detail {

/// Whether this processor has the instructions.
inline bool has_avx2() noexcept {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}

struct Avx2 {
  using Register = __m256d; ///< x, y, z, 0

  struct Ends {
    Register linear, angular;
  };

  [[gnu::target("avx2"), gnu::always_inline]] static inline Ends load(const particles::Spatial<>& spatial) {
    return {_mm256_load_pd(spatial.component), _mm256_load_pd(spatial.component + 4)};
  }

  [[gnu::target("avx2"), gnu::always_inline]] static inline void store(particles::Spatial<>& spatial,
                                                                       const Ends& value) {
    _mm256_store_pd(spatial.component, value.linear);
    _mm256_store_pd(spatial.component + 4, value.angular);
  }

  /// y, z, x, 0
  [[gnu::target("avx2"), gnu::always_inline]] static inline Register turned(Register v) {
    return _mm256_permute4x64_pd(v, _MM_SHUFFLE(3, 0, 2, 1));
  }

  /// Four numbers from memory, in double precision.
  [[gnu::target("avx2"), gnu::always_inline]] static inline Register four(const double* numbers) {
    return _mm256_loadu_pd(numbers);
  }
  [[gnu::target("avx2"), gnu::always_inline]] static inline Register four(const float* numbers) {
    return _mm256_cvtps_pd(_mm_loadu_ps(numbers));
  }

  struct Action {
    Register force, couple, moment;
  };

  /// action_of() in registers.
  template <class Real>
  [[gnu::target("avx2"), gnu::always_inline]] static inline Action
  action_of(const BondRecord<Real>& bond, const Ends& first, const Ends& second) {
    const Register d = _mm256_blend_pd(four(bond.half_branch), _mm256_setzero_pd(), 0b1000);
    const Register d_turned = turned(d);
    const Register sum = first.angular + second.angular, turn = second.angular - first.angular;
    const Register slip =
        second.linear - first.linear - turned(sum * d_turned - turned(sum) * d); // minus sum x d
    // both scalar products at once: d.slip and d.turn
    const Register pairs = _mm256_hadd_pd(d * slip, d * turn);
    const __m128d products = _mm256_castpd256_pd128(pairs) + _mm256_extractf128_pd(pairs, 1);
    const __m128d along = products * _mm_set_pd(double{bond.twist}, double{bond.stretch});
    const Register stretch = _mm256_broadcastsd_pd(along);
    const Register twist = _mm256_broadcastsd_pd(_mm_unpackhi_pd(along, along));
    const Register shear = _mm256_set1_pd(double{bond.tangential}) * slip;
    return {shear + stretch * d, turned(d * turned(shear) - d_turned * shear),
            _mm256_set1_pd(double{bond.bending}) * turn + twist * d};
  }

  [[gnu::target("avx2"), gnu::always_inline]] static inline void
  act_on_second(particles::Spatial<>& on_second, const Action& action) {
    const Ends before = load(on_second);
    store(on_second, {before.linear - action.force, before.angular + (action.couple - action.moment)});
  }

  /// See detail::add_forces().
  template <class Real>
  [[gnu::target("avx2")]] static void add_forces(const BondBlock<Real>& block,
                                                 const particles::Spatial<>* displacement,
                                                 particles::Spatial<>* force) {
    const ParticleIndex size = block.end - block.begin;
    particles::Spatial<> elsewhere; // takes what belongs to other blocks
    const BondIndex last = block.bonds_begin[block.end];
    for (ParticleIndex i = block.begin; i < block.end; ++i) {
      const Ends first = load(displacement[i]);
      Ends on_first = load(force[i - block.begin]);
      for (BondIndex b = block.bonds_begin[i]; b < block.bonds_begin[i + 1]; ++b) {
        const BondIndex ahead = std::min(b + prefetch_distance, last - 1);
        __builtin_prefetch(&displacement[block.records[ahead].second]);
        const BondRecord<Real>& bond = block.records[b];
        const Action action = action_of(bond, first, load(displacement[bond.second]));
        on_first.linear += action.force;
        on_first.angular += action.couple + action.moment;
        const ParticleIndex second = bond.second - block.begin; // wraps around for a second before the block
        act_on_second(second < size ? force[second] : elsewhere, action);
      }
      store(force[i - block.begin], on_first);
    }
    for (std::size_t k = 0; k < block.incoming_count; ++k) {
      const std::size_t ahead = std::min(k + prefetch_distance, block.incoming_count - 1);
      __builtin_prefetch(&block.records[block.incoming[ahead].bond]);
      __builtin_prefetch(&displacement[block.incoming[ahead].first]);
      const auto [b, particle] = block.incoming[k];
      const BondRecord<Real>& bond = block.records[b];
      act_on_second(force[bond.second - block.begin],
                    action_of(bond, load(displacement[particle]), load(displacement[bond.second])));
    }
  }
};

} // namespace cdem::bond::detail

#endif
