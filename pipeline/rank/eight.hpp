// Eight short intervals side by side, a lane for each: what the instruction set of this unit offers for them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/lanes.hpp"
#include "pipeline/rank/vector_job.hpp"

namespace scansion {
namespace {

// What has been found for eight intervals: the split points and the two parts of each interval, as they may have to wait.
struct Parts {
  alignas(32) Waiting left[8];
  alignas(32) Waiting right[8]; ///< a is the split point, bound its squared distance
  alignas(32) std::uint32_t at[8]; ///< place of the split point in its interval, 1 for the first inner point
};

// Eight has, beside the halves (lanes.hpp): sets of lanes as V, all ones or 0: greater, both, either, pick(set, yes, no), bits; four,
// points 0..3 of each interval; Real, eight doubles: real (from V), mul, div, pick; finish, what waits after a split.

#if defined(__AVX2__)

struct Eight : Halves8 {
  struct Real {
    __m256d low, high;
  };

  static V set1(std::int32_t v) { return _mm256_set1_epi32(v); }
  static V greater(V a, V b) { return _mm256_cmpgt_epi32(a, b); }
  static V both(V a, V b) { return _mm256_and_si256(a, b); }
  static V pick(V set, V yes, V no) { return _mm256_blendv_epi8(no, yes, set); }
  static void four(const std::uint32_t* pairs, const Waiting* w, V* p) {
    const auto load_two = [&](unsigned i) {
      return _mm256_inserti128_si256(_mm256_castsi128_si256(half(pairs + w[i].a)), half(pairs + w[i + 4].a), 1);
    };
    const V a = load_two(0);
    const V b = load_two(1);
    const V c = load_two(2);
    const V d = load_two(3);
    const V ab_low = _mm256_unpacklo_epi32(a, b);
    const V ab_high = _mm256_unpackhi_epi32(a, b);
    const V cd_low = _mm256_unpacklo_epi32(c, d);
    const V cd_high = _mm256_unpackhi_epi32(c, d);
    p[0] = _mm256_unpacklo_epi64(ab_low, cd_low);
    p[1] = _mm256_unpackhi_epi64(ab_low, cd_low);
    p[2] = _mm256_unpacklo_epi64(ab_high, cd_high);
    p[3] = _mm256_unpackhi_epi64(ab_high, cd_high);
  }

  static Real real(V v) {
    return {_mm256_cvtepi32_pd(_mm256_castsi256_si128(v)), _mm256_cvtepi32_pd(_mm256_extracti128_si256(v, 1))};
  }
  static Real mul(Real a, Real b) { return {_mm256_mul_pd(a.low, b.low), _mm256_mul_pd(a.high, b.high)}; }
  static Real div(Real a, Real b) { return {_mm256_div_pd(a.low, b.low), _mm256_div_pd(a.high, b.high)}; }
  static Real pick(V set, Real yes, Real no) {
    const auto blend = [](__m256d a, __m256d b, __m128i lanes) {
      return _mm256_blendv_pd(b, a, _mm256_castsi256_pd(_mm256_cvtepi32_epi64(lanes)));
    };
    return {blend(yes.low, no.low, _mm256_castsi256_si128(set)), blend(yes.high, no.high, _mm256_extracti128_si256(set, 1))};
  }

  // The parts of intervals w whose point `at` splits them at the squared distance `ratio`.
  static void finish(const Waiting* w, V at, Real ratio, Parts& parts) {
    _mm256_store_si256(reinterpret_cast<V*>(parts.at), at);
    finish_four(w, _mm256_castsi256_si128(at), ratio.low, parts.left, parts.right);
    finish_four(w + 4, _mm256_extracti128_si256(at, 1), ratio.high, parts.left + 4, parts.right + 4);
  }

private:
  static __m128i half(const void* p) { return _mm_loadu_si128(static_cast<const __m128i*>(p)); }

  static void finish_four(const Waiting* w, __m128i at, __m256d ratio, Waiting* left, Waiting* right) {
    const auto load_two = [&](unsigned i) {
      return _mm256_inserti128_si256(_mm256_castsi128_si256(half(w + i)), half(w + i + 2), 1);
    };
    const V even = load_two(0);
    const V odd = load_two(1);
    const V bound = _mm256_unpackhi_epi64(even, odd);
    const V q = _mm256_castpd_si256(_mm256_min_pd(ratio, _mm256_castsi256_pd(bound)));
    const V below = _mm256_add_epi64(_mm256_unpacklo_epi64(even, odd), _mm256_set1_epi64x(std::int64_t{1} << 32U));
    store_four(below, q, left);
    store_four(_mm256_add_epi64(below, _mm256_cvtepu32_epi64(at)), q, right);
  }
  static void store_four(V place, V q, Waiting* to) {
    const V even = _mm256_unpacklo_epi64(place, q);
    const V odd = _mm256_unpackhi_epi64(place, q);
    _mm256_store_si256(reinterpret_cast<V*>(to), _mm256_permute2x128_si256(even, odd, 0x20));
    _mm256_store_si256(reinterpret_cast<V*>(to + 2), _mm256_permute2x128_si256(even, odd, 0x31));
  }
};

#else

struct Eight : Halves8 {
  struct Real {
    double lane[kLanes];
  };
  template <class Each>
  static Real make_real(Each each) {
    Real r{};
    for (unsigned i = 0; i < kLanes; ++i) r.lane[i] = each(i);
    return r;
  }

  static V set1(std::int32_t v) {
    return make([&](unsigned) { return v; });
  }
  static V greater(V a, V b) {
    return make([&](unsigned i) { return a.lane[i] > b.lane[i] ? -1 : 0; });
  }
  static V both(V a, V b) {
    return make([&](unsigned i) { return a.lane[i] & b.lane[i]; });
  }
  static V pick(V set, V yes, V no) {
    return make([&](unsigned i) { return set.lane[i] != 0 ? yes.lane[i] : no.lane[i]; });
  }
  static void four(const std::uint32_t* pairs, const Waiting* w, V* p) {
    for (unsigned k = 0; k < 4; ++k) p[k] = make([&](unsigned i) { return static_cast<std::int32_t>(pairs[w[i].a + k]); });
  }
  static Real real(V v) {
    return make_real([&](unsigned i) { return static_cast<double>(v.lane[i]); });
  }
  static Real mul(Real a, Real b) {
    return make_real([&](unsigned i) { return a.lane[i] * b.lane[i]; });
  }
  static Real div(Real a, Real b) {
    return make_real([&](unsigned i) { return a.lane[i] / b.lane[i]; });
  }
  static Real pick(V set, Real yes, Real no) {
    return make_real([&](unsigned i) { return set.lane[i] != 0 ? yes.lane[i] : no.lane[i]; });
  }
  static void finish(const Waiting* w, V at, Real ratio, Parts& parts) {
    for (unsigned i = 0; i < kLanes; ++i) {
      const auto place = static_cast<std::uint32_t>(at.lane[i]);
      const double q = ratio.lane[i] < w[i].bound ? ratio.lane[i] : w[i].bound;
      parts.at[i] = place;
      parts.left[i] = {w[i].a, w[i].level + 1, q};
      parts.right[i] = {w[i].a + place, w[i].level + 1, q};
    }
  }
};

#endif

} // namespace
} // namespace scansion
