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
  alignas(32) Waiting right[8];    ///< a is the split point, bound its squared distance
  alignas(32) std::uint32_t at[8]; ///< place of the split point in its interval, 1 for the first inner point
};

/// Bits of the intervals that were not split: those to be measured by other means because points lie beyond an end of the
/// chord, and those that end here, as close to their chord as the floor (parts.right has their bounds).
struct Unsplit {
  std::uint32_t apart, stopped;
};

// Eight has, beside the halves (lanes.hpp): four, points 0..3 of each interval; Real, eight doubles: real (from V), mul, div,
// min, pick; above(Real, limit), bits; Open, eight waiting intervals: open, bound; put, intervals that begin `at` points later
// and some levels deeper.

#if defined(__AVX2__)

struct Eight : Halves8 {
  using Halves8::pick;
  struct Real {
    __m256d low, high;
  };

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

  static Real min(Real a, Real b) { return {_mm256_min_pd(a.low, b.low), _mm256_min_pd(a.high, b.high)}; }

  static std::uint32_t above(Real a, double limit) {
    const __m256d all = _mm256_set1_pd(limit);
    const auto bits = [&](__m256d v) {
      return static_cast<std::uint32_t>(_mm256_movemask_pd(_mm256_cmp_pd(v, all, _CMP_GT_OQ)));
    };
    return bits(a.low) | bits(a.high) << 4U;
  }

  struct Open {
    V low, high; ///< a and level as one number
    Real bound;
  };
  static Open open(const Waiting* w) {
    Open o;
    open_four(w, o.low, o.bound.low);
    open_four(w + 4, o.high, o.bound.high);
    return o;
  }
  static void put(const Open& o, std::uint32_t levels, V at, Real q, Waiting* to) {
    const V deeper = _mm256_set1_epi64x(std::int64_t{levels} << 32U);
    const auto moved = [&](V place, __m128i by) {
      return _mm256_add_epi64(_mm256_add_epi64(place, deeper), _mm256_cvtepu32_epi64(by));
    };
    put_four(moved(o.low, _mm256_castsi256_si128(at)), _mm256_castpd_si256(q.low), to);
    put_four(moved(o.high, _mm256_extracti128_si256(at, 1)), _mm256_castpd_si256(q.high), to + 4);
  }

private:
  static __m128i half(const void* p) { return _mm_loadu_si128(static_cast<const __m128i*>(p)); }

  static void open_four(const Waiting* w, V& place, __m256d& bound) {
    const auto load_two = [&](unsigned i) {
      return _mm256_inserti128_si256(_mm256_castsi128_si256(half(w + i)), half(w + i + 2), 1);
    };
    const V even = load_two(0);
    const V odd = load_two(1);
    place = _mm256_unpacklo_epi64(even, odd);
    bound = _mm256_castsi256_pd(_mm256_unpackhi_epi64(even, odd));
  }
  static void put_four(V place, V q, Waiting* to) {
    const V even = _mm256_unpacklo_epi64(place, q);
    const V odd = _mm256_unpackhi_epi64(place, q);
    _mm256_store_si256(reinterpret_cast<V*>(to), _mm256_permute2x128_si256(even, odd, 0x20));
    _mm256_store_si256(reinterpret_cast<V*>(to + 2), _mm256_permute2x128_si256(even, odd, 0x31));
  }
};

#else

struct Eight : Halves8 {
  using Halves8::pick;
  struct Real {
    double lane[kLanes];
  };
  template <class Each>
  static Real make_real(Each each) {
    Real r{};
    for (unsigned i = 0; i < kLanes; ++i) r.lane[i] = each(i);
    return r;
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
  static Real min(Real a, Real b) {
    return make_real([&](unsigned i) { return b.lane[i] < a.lane[i] ? b.lane[i] : a.lane[i]; });
  }

  static std::uint32_t above(Real a, double limit) {
    std::uint32_t r = 0;
    for (unsigned i = 0; i < kLanes; ++i) r |= (a.lane[i] > limit ? 1U : 0U) << i;
    return r;
  }

  struct Open {
    const Waiting* w;
    Real bound;
  };
  static Open open(const Waiting* w) {
    return {w, make_real([&](unsigned i) { return w[i].bound; })};
  }
  static void put(const Open& o, std::uint32_t levels, V at, Real q, Waiting* to) {
    for (unsigned i = 0; i < kLanes; ++i)
      to[i] = {o.w[i].a + static_cast<std::uint32_t>(at.lane[i]), {o.w[i].level + levels}, q.lane[i]};
  }
};

#endif

} // namespace
} // namespace scansion
