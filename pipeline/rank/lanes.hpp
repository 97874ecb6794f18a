// Lanes of int32 and of double for the instruction set this unit is compiled for. Everything here has internal linkage: nothing
// compiled for a newer processor may be shared with other units.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace scansion {
namespace {

// Every Halves type has: kLanes; V, a vector of 32 bit lanes, each lane also seen as two 16 bit halves; load; spread, one value
// in all lanes; zero; across, the pair (-high, low) of each lane (low, high); sub16, difference of halves; madd, sum of the
// products of both halves; abs32, max32, min32; top, the largest lane in all lanes; lane0; set1; S, a set of lanes: greater,
// equal, both, either; pick(S, yes, no); bits; kAll, the bits of all lanes.
//
// Every Reals type: kLanes doubles; load from int32,
// set1; sub, add, mul, mul_add, mul_sub (fused or not: what they give must be exact either way); abs, max, min; top, the
// largest lane; store; M, a set of lanes: first(count); inside(dot, length), 0 < dot < length; keep(M, V); pick(M, yes, no);
// equal; at_least; greater; both, either, without; bits.

#if defined(__AVX2__)

struct Halves8 {
  static constexpr unsigned kLanes = 8;
  using V = __m256i;
  static V load(const std::uint32_t* p) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)); }
  static V spread(const std::uint32_t* p) { return _mm256_set1_epi32(static_cast<int>(*p)); }
  static V zero() { return _mm256_setzero_si256(); }
  static V across(V a) {
    const V turned = _mm256_or_si256(_mm256_slli_epi32(a, 16), _mm256_srli_epi32(a, 16));
    return _mm256_sign_epi16(turned, _mm256_set1_epi32(0x0001FFFF));
  }
  static V sub16(V a, V b) { return _mm256_sub_epi16(a, b); }
  static V madd(V a, V b) { return _mm256_madd_epi16(a, b); }
  static V abs32(V a) { return _mm256_abs_epi32(a); }
  static V max32(V a, V b) { return _mm256_max_epi32(a, b); }
  static V min32(V a, V b) { return _mm256_min_epi32(a, b); }
  static V top(V a) {
    a = _mm256_max_epi32(a, _mm256_permute2x128_si256(a, a, 1));
    a = _mm256_max_epi32(a, _mm256_shuffle_epi32(a, 0x4E));
    return _mm256_max_epi32(a, _mm256_shuffle_epi32(a, 0xB1));
  }
  static std::int32_t lane0(V a) { return _mm_cvtsi128_si32(_mm256_castsi256_si128(a)); }
  using S = V;
  static constexpr std::uint32_t kAll = 0xFF;
  static V set1(std::int32_t v) { return _mm256_set1_epi32(v); }
  static S greater(V a, V b) { return _mm256_cmpgt_epi32(a, b); }
  static S equal(V a, V b) { return _mm256_cmpeq_epi32(a, b); }
  static S both(S a, S b) { return _mm256_and_si256(a, b); }
  static S either(S a, S b) { return _mm256_or_si256(a, b); }
  static V pick(S set, V yes, V no) { return _mm256_blendv_epi8(no, yes, set); }
  static std::uint32_t bits(S set) { return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(set))); }
  static void store(std::uint32_t* to, V a) { _mm256_storeu_si256(reinterpret_cast<V*>(to), a); }
};

#endif

#if defined(__AVX512BW__) && defined(__AVX512VL__) && defined(__AVX512DQ__)

struct Lanes {
  static constexpr unsigned kLanes = 16;
  using V = __m512i;
  static V load(const std::uint32_t* p) { return _mm512_loadu_si512(p); }
  static V spread(const std::uint32_t* p) { return _mm512_set1_epi32(static_cast<int>(*p)); }
  static V zero() { return _mm512_setzero_si512(); }
  static V across(V a) {
    const V turned = _mm512_rol_epi32(a, 16);
    return _mm512_mask_sub_epi16(turned, 0x55555555, _mm512_setzero_si512(), turned);
  }
  static V sub16(V a, V b) { return _mm512_sub_epi16(a, b); }
  static V madd(V a, V b) { return _mm512_madd_epi16(a, b); }
  static V abs32(V a) { return _mm512_abs_epi32(a); }
  static V max32(V a, V b) { return _mm512_max_epi32(a, b); }
  static V min32(V a, V b) { return _mm512_min_epi32(a, b); }
  static V top(V a) {
    a = _mm512_max_epi32(a, _mm512_shuffle_i32x4(a, a, 0x4E));
    a = _mm512_max_epi32(a, _mm512_shuffle_i32x4(a, a, 0xB1));
    a = _mm512_max_epi32(a, _mm512_shuffle_epi32(a, _MM_PERM_BADC));
    return _mm512_max_epi32(a, _mm512_shuffle_epi32(a, _MM_PERM_CDAB));
  }
  static std::int32_t lane0(V a) { return _mm_cvtsi128_si32(_mm512_castsi512_si128(a)); }
  using S = __mmask16;
  static constexpr std::uint32_t kAll = 0xFFFF;
  static V set1(std::int32_t v) { return _mm512_set1_epi32(v); }
  static S greater(V a, V b) { return _mm512_cmpgt_epi32_mask(a, b); }
  static S equal(V a, V b) { return _mm512_cmpeq_epi32_mask(a, b); }
  static S both(S a, S b) { return static_cast<S>(a & b); }
  static S either(S a, S b) { return static_cast<S>(a | b); }
  static V pick(S set, V yes, V no) { return _mm512_mask_mov_epi32(no, set, yes); }
  static std::uint32_t bits(S set) { return set; }
  static void store(std::uint32_t* to, V a) { _mm512_storeu_si512(to, a); }
};

struct Reals {
  static constexpr unsigned kLanes = 8;
  using V = __m512d;
  using M = __mmask8;
  static V load(const std::int32_t* p) { return _mm512_cvtepi32_pd(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))); }
  static V set1(double v) { return _mm512_set1_pd(v); }
  static V sub(V a, V b) { return _mm512_sub_pd(a, b); }
  static V add(V a, V b) { return _mm512_add_pd(a, b); }
  static V mul(V a, V b) { return _mm512_mul_pd(a, b); }
  static V abs(V a) { return _mm512_abs_pd(a); }
  static V max(V a, V b) { return _mm512_max_pd(a, b); }
  static V min(V a, V b) { return _mm512_min_pd(a, b); }
  static V mul_add(V a, V b, V c) { return _mm512_fmadd_pd(a, b, c); }
  static V mul_sub(V a, V b, V c) { return _mm512_fmsub_pd(a, b, c); }
  static double top(V a) { return _mm512_reduce_max_pd(a); }
  static M first(unsigned count) { return static_cast<M>((1U << count) - 1U); }
  static M inside(V dot, V length) {
    return _mm512_mask_cmp_pd_mask(_mm512_cmp_pd_mask(dot, _mm512_setzero_pd(), _CMP_GT_OQ), dot, length, _CMP_LT_OQ);
  }
  static V keep(M m, V a) { return _mm512_maskz_mov_pd(m, a); }
  static M equal(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ); }
  static M both(M a, M b) { return static_cast<M>(a & b); }
  static M at_least(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_GE_OQ); }
  static M without(M a, M b) { return static_cast<M>(a & ~b); }
  static M either(M a, M b) { return static_cast<M>(a | b); }
  static M greater(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ); }
  static V pick(M m, V yes, V no) { return _mm512_mask_mov_pd(no, m, yes); }
  static void store(double* to, V a) { _mm512_storeu_pd(to, a); }
  static std::uint32_t bits(M m) { return m; }
};

#elif defined(__AVX2__)

// Eight ones, then eight zeros: a window of it selects the first lanes.
alignas(64) inline constexpr std::int32_t kWindow[16] = {-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0};

using Lanes = Halves8;

struct Reals {
  static constexpr unsigned kLanes = 4;
  using V = __m256d;
  using M = __m256d;
  static V load(const std::int32_t* p) { return _mm256_cvtepi32_pd(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))); }
  static V set1(double v) { return _mm256_set1_pd(v); }
  static V sub(V a, V b) { return _mm256_sub_pd(a, b); }
  static V add(V a, V b) { return _mm256_add_pd(a, b); }
  static V mul(V a, V b) { return _mm256_mul_pd(a, b); }
  static V abs(V a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a); }
  static V max(V a, V b) { return _mm256_max_pd(a, b); }
  static V min(V a, V b) { return _mm256_min_pd(a, b); }
  static V mul_add(V a, V b, V c) { return _mm256_fmadd_pd(a, b, c); }
  static V mul_sub(V a, V b, V c) { return _mm256_fmsub_pd(a, b, c); }
  static double top(V a) {
    const __m128d two = _mm_max_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
    return _mm_cvtsd_f64(_mm_max_pd(two, _mm_unpackhi_pd(two, two)));
  }
  static M first(unsigned count) {
    return _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm_loadu_si128(reinterpret_cast<const __m128i*>(kWindow + 8 - count))));
  }
  static M inside(V dot, V length) {
    return _mm256_and_pd(_mm256_cmp_pd(dot, _mm256_setzero_pd(), _CMP_GT_OQ), _mm256_cmp_pd(dot, length, _CMP_LT_OQ));
  }
  static V keep(M m, V a) { return _mm256_and_pd(m, a); }
  static M equal(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_EQ_OQ); }
  static M both(M a, M b) { return _mm256_and_pd(a, b); }
  static M at_least(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_GE_OQ); }
  static M without(M a, M b) { return _mm256_andnot_pd(b, a); }
  static M either(M a, M b) { return _mm256_or_pd(a, b); }
  static M greater(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_GT_OQ); }
  static V pick(M m, V yes, V no) { return _mm256_blendv_pd(no, yes, m); }
  static void store(double* to, V a) { _mm256_storeu_pd(to, a); }
  static std::uint32_t bits(M m) { return static_cast<std::uint32_t>(_mm256_movemask_pd(m)); }
};

#else

struct Halves8 {
  static constexpr unsigned kLanes = 8;
  struct V {
    std::int32_t lane[kLanes];
  };
  template <class Each>
  static V make(Each each) {
    V r{};
    for (unsigned i = 0; i < kLanes; ++i) r.lane[i] = each(i);
    return r;
  }
  static std::int32_t low(std::int32_t v) { return static_cast<std::int16_t>(v); }
  static std::int32_t high(std::int32_t v) { return v >> 16; }
  static V load(const std::uint32_t* p) {
    return make([&](unsigned i) { return static_cast<std::int32_t>(p[i]); });
  }
  static V spread(const std::uint32_t* p) {
    return make([&](unsigned) { return static_cast<std::int32_t>(*p); });
  }
  static V zero() { return {}; }
  static V across(V a) {
    return make([&](unsigned i) {
      const auto turned = static_cast<std::uint32_t>(-high(a.lane[i])) & 0xFFFFU;
      return static_cast<std::int32_t>(turned | static_cast<std::uint32_t>(a.lane[i]) << 16U);
    });
  }
  static V sub16(V a, V b) {
    return make([&](unsigned i) {
      const auto x = static_cast<std::uint32_t>(a.lane[i]);
      const auto y = static_cast<std::uint32_t>(b.lane[i]);
      return static_cast<std::int32_t>(((x - y) & 0xFFFFU) | ((x & 0xFFFF0000U) - (y & 0xFFFF0000U)));
    });
  }
  static V madd(V a, V b) {
    return make([&](unsigned i) { return low(a.lane[i]) * low(b.lane[i]) + high(a.lane[i]) * high(b.lane[i]); });
  }
  static V abs32(V a) {
    return make([&](unsigned i) { return a.lane[i] < 0 ? -a.lane[i] : a.lane[i]; });
  }
  static V max32(V a, V b) {
    return make([&](unsigned i) { return a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i]; });
  }
  static V min32(V a, V b) {
    return make([&](unsigned i) { return a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i]; });
  }
  static V top(V a) {
    std::int32_t r = a.lane[0];
    for (unsigned i = 1; i < kLanes; ++i) r = a.lane[i] > r ? a.lane[i] : r;
    return make([&](unsigned) { return r; });
  }
  static std::int32_t lane0(V a) { return a.lane[0]; }
  using S = V;
  static constexpr std::uint32_t kAll = 0xFF;
  static V set1(std::int32_t v) {
    return make([&](unsigned) { return v; });
  }
  static S greater(V a, V b) {
    return make([&](unsigned i) { return a.lane[i] > b.lane[i] ? -1 : 0; });
  }
  static S equal(V a, V b) {
    return make([&](unsigned i) { return a.lane[i] == b.lane[i] ? -1 : 0; });
  }
  static S both(S a, S b) {
    return make([&](unsigned i) { return a.lane[i] & b.lane[i]; });
  }
  static S either(S a, S b) {
    return make([&](unsigned i) { return a.lane[i] | b.lane[i]; });
  }
  static V pick(S set, V yes, V no) {
    return make([&](unsigned i) { return set.lane[i] != 0 ? yes.lane[i] : no.lane[i]; });
  }
  static std::uint32_t bits(S set) {
    std::uint32_t r = 0;
    for (unsigned i = 0; i < kLanes; ++i) r |= (set.lane[i] != 0 ? 1U : 0U) << i;
    return r;
  }
  static void store(std::uint32_t* to, V a) {
    for (unsigned i = 0; i < kLanes; ++i) to[i] = static_cast<std::uint32_t>(a.lane[i]);
  }
};
using Lanes = Halves8;

struct Reals {
  static constexpr unsigned kLanes = 2;
  struct V {
    double lane[kLanes];
  };
  using M = std::uint32_t;
  static V load(const std::int32_t* p) { return {{static_cast<double>(p[0]), static_cast<double>(p[1])}}; }
  static V set1(double v) { return {{v, v}}; }
  static V sub(V a, V b) { return {{a.lane[0] - b.lane[0], a.lane[1] - b.lane[1]}}; }
  static V add(V a, V b) { return {{a.lane[0] + b.lane[0], a.lane[1] + b.lane[1]}}; }
  static V mul(V a, V b) { return {{a.lane[0] * b.lane[0], a.lane[1] * b.lane[1]}}; }
  static double magnitude(double v) { return v < 0 ? -v : v; }
  static V abs(V a) { return {{magnitude(a.lane[0]), magnitude(a.lane[1])}}; }
  static double larger(double a, double b) { return a > b ? a : b; }
  static double lesser(double a, double b) { return a < b ? a : b; }
  static V min(V a, V b) { return {{lesser(a.lane[0], b.lane[0]), lesser(a.lane[1], b.lane[1])}}; }
  static V mul_add(V a, V b, V c) { return add(mul(a, b), c); }
  static V mul_sub(V a, V b, V c) { return sub(mul(a, b), c); }
  static V max(V a, V b) { return {{larger(a.lane[0], b.lane[0]), larger(a.lane[1], b.lane[1])}}; }
  static double top(V a) { return larger(a.lane[0], a.lane[1]); }
  static M first(unsigned count) { return (1U << count) - 1U; }
  static M pair(bool zero, bool one) { return (zero ? 1U : 0U) | (one ? 2U : 0U); }
  static M inside(V dot, V length) {
    return pair(dot.lane[0] > 0 && dot.lane[0]<length.lane[0], dot.lane[1]> 0 && dot.lane[1] < length.lane[1]);
  }
  static V keep(M m, V a) { return {{(m & 1U) != 0 ? a.lane[0] : 0.0, (m & 2U) != 0 ? a.lane[1] : 0.0}}; }
  static M equal(V a, V b) { return pair(a.lane[0] == b.lane[0], a.lane[1] == b.lane[1]); }
  static M both(M a, M b) { return a & b; }
  static M at_least(V a, V b) { return pair(a.lane[0] >= b.lane[0], a.lane[1] >= b.lane[1]); }
  static M without(M a, M b) { return a & ~b; }
  static M either(M a, M b) { return a | b; }
  static M greater(V a, V b) { return pair(a.lane[0] > b.lane[0], a.lane[1] > b.lane[1]); }
  static V pick(M m, V yes, V no) {
    return {{(m & 1U) != 0 ? yes.lane[0] : no.lane[0], (m & 2U) != 0 ? yes.lane[1] : no.lane[1]}};
  }
  static void store(double* to, V a) {
    to[0] = a.lane[0];
    to[1] = a.lane[1];
  }
  static std::uint32_t bits(M m) { return m; }
};

#endif

/// Each value becomes the sum of those before it, modulo 2^32. Writes up to seven values behind the last.
inline void sums_before(std::uint32_t* values, std::uint32_t n) {
#if defined(__AVX2__)
  __m256i before = _mm256_setzero_si256();
  for (std::uint32_t i = 0; i < n; i += 8) {
    auto* const place = reinterpret_cast<__m256i*>(values + i);
    const __m256i here = _mm256_loadu_si256(place);
    __m256i sum = _mm256_add_epi32(here, _mm256_slli_si256(here, 4));
    sum = _mm256_add_epi32(sum, _mm256_slli_si256(sum, 8));
    // The shifts stay in 128 bit halves: the upper one lacks the total of the lower.
    const __m256i lower = _mm256_permute2x128_si256(sum, sum, 0x08);
    sum = _mm256_add_epi32(sum, _mm256_shuffle_epi32(lower, 0xFF));
    _mm256_storeu_si256(place, _mm256_add_epi32(before, _mm256_sub_epi32(sum, here)));
    before = _mm256_add_epi32(before, _mm256_permutevar8x32_epi32(sum, _mm256_set1_epi32(7)));
  }
#else
  std::uint32_t sum = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t here = values[i];
    values[i] = sum;
    sum += here;
  }
#endif
}

} // namespace
} // namespace scansion
