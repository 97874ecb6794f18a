// Points by distance descending, depth, index: a radix sort by the leading bits of distance and depth, then whatever is left.
// Included by the units of each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/order_job.hpp"
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace scansion {
namespace {

// A key holds, from the top: the leading 32 bits of the largest distance minus the point's; 8 bits of depth; the index.
// Ascending keys are the order wanted, but for distances that differ in the bits cut off and for depths and indexes that do not
// fit.
inline constexpr unsigned kIndexBits = 24;
inline constexpr unsigned kDistanceAt = 32;
inline constexpr unsigned kDistanceBits = 32;
inline constexpr std::uint32_t kMostDepth = 255;
inline constexpr std::uint64_t kIndexMask = (std::uint64_t{1} << kIndexBits) - 1;
static_assert(kOrderPoints == std::size_t{1} << kIndexBits);

inline std::uint64_t bits_of(double distance) {
  return __builtin_bit_cast(std::uint64_t, distance);
}

class RadixOrder {
public:
  explicit RadixOrder(const OrderJob& job) : job_(job), keys_(job.keys), other_(job.sorted), size_(job.n - 2) {}

  bool run() {
    if (is_flat() && sort_by_depth()) return true;
    fill_keys();
    // Few points need few bits to differ, and small tables; settling does the rest.
    if (job_.n < 512)
      sort_in_two<std::uint16_t, 4, 5, 10>();
    else if (job_.n < 4096)
      sort_in_two<std::uint16_t, 5, 6, 11>();
    else if (job_.n < 65'536)
      sort_in_two<std::uint16_t, 5, 7, 12>();
    else
      sort_in_two<std::uint32_t, 5, 9, 14>();
    if (!settle()) sort<0, 1, 2, 3, 4, 5, 6, 7>();
    return finish();
  }

private:
  /// No inner point lies off the chord.
  [[nodiscard]] bool is_flat() const {
    const double* const distance = job_.distance + 1;
    if (bits_of(distance[0]) != 0) return false; // nearly all runs
    std::uint64_t bits = 0;
    for (std::uint32_t i = 0; i < size_; ++i) bits |= bits_of(distance[i]);
    return bits == 0;
  }

  // Depths of bisection are few and small. False: these are not.
  bool sort_by_depth() {
    const std::uint32_t* __restrict const depth = job_.depth + 1;
    std::uint32_t* __restrict const count = job_.counts;
    __builtin_memset(count, 0, sizeof(std::uint32_t) * (kMostDepth + 1));
    std::uint32_t deepest = 0;
    for (std::uint32_t i = 0; i < size_; ++i) {
      deepest |= depth[i];
      ++count[depth[i] & kMostDepth];
    }
    if (deepest > kMostDepth) return false;
    counts_to_places<kMostDepth + 1>(count);
    std::uint32_t* __restrict const order = job_.order + 2;
    for (std::uint32_t i = 0; i < size_; ++i) order[count[depth[i]]++] = i + 1;
    return true;
  }

  void fill_keys() {
    const double* __restrict const distance = job_.distance + 1;
    const std::uint32_t* __restrict const depth = job_.depth + 1;
    std::uint64_t* __restrict const keys = keys_;
    const std::uint32_t size = size_;
    // Zeros are equal whatever the leading bits are, so the least of the others sets the range; 32 bits say enough of it.
    std::uint32_t most = 0;
    std::uint32_t least_minus_one = ~std::uint32_t{0};
    for (std::uint32_t i = 0; i < size; ++i) {
      const auto leading = static_cast<std::uint32_t>(bits_of(distance[i]) >> 32U);
      most = leading > most ? leading : most;
      least_minus_one = leading - 1 < least_minus_one ? leading - 1 : least_minus_one;
    }
    const std::int64_t high = std::int64_t{most} << 32U | 0xFFFFFFFF;
    const auto range =
        static_cast<std::uint64_t>(most > 0 ? high - (static_cast<std::int64_t>(least_minus_one + 1) << 32U) + 1 : 0);
    const unsigned width = range == 0 ? 0 : 64U - static_cast<unsigned>(__builtin_clzll(range));
    const unsigned cut = width > kDistanceBits ? width - kDistanceBits : 0;
    const unsigned up = kDistanceBits - (width - cut);
    const std::int64_t last = (std::int64_t{1} << (width - cut)) - 1;
    std::uint32_t deepest = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::int64_t below = (high - static_cast<std::int64_t>(bits_of(distance[i]))) >> cut;
      const auto leading = static_cast<std::uint64_t>(below < last ? below : last) << up;
      const std::uint32_t d = depth[i];
      deepest |= d;
      keys[i] = leading << kDistanceAt | (std::uint64_t{d} << kIndexBits & 0xFFFFFFFFU) | (i + 1);
    }
    fits_ = deepest <= kMostDepth && job_.n <= kOrderPoints;
  }

  // By the leading bits of the distance, of equal ones by the last bits of the depth: equal distances are common (parts of an
  // interval have its distance at most, small ones have few values). The first pass takes the depth and the later bits of the
  // distance, the second one the first bits.
  template <class Count, unsigned kDepth, unsigned kLow, unsigned kHigh>
  void sort_in_two() {
    constexpr unsigned kTable = 1U << (kDepth + kLow);
    constexpr unsigned kTop = 1U << kHigh;
    static_assert((kTable + kTop) * sizeof(Count) <= kOrderCounts * sizeof(std::uint32_t));
    auto* __restrict const low_count = reinterpret_cast<Count*>(job_.counts);
    Count* __restrict const high_count = low_count + kTable;
    __builtin_memset(low_count, 0, sizeof(Count) * (kTable + kTop));
    const std::uint64_t* __restrict const keys = keys_;
    std::uint32_t* __restrict const digits = job_.digits;
    const std::uint32_t size = size_;
    for (std::uint32_t i = 0; i < size; ++i) {
      const auto depth = static_cast<std::uint32_t>(keys[i] >> kIndexBits) & ((1U << kDepth) - 1);
      const auto distance = static_cast<std::uint32_t>(keys[i] >> (64 - kHigh - kLow)) & ((1U << kLow) - 1);
      digits[i] = distance << kDepth | depth;
    }
#pragma GCC unroll 4
    for (std::uint32_t i = 0; i < size; ++i) {
      ++low_count[digits[i]];
      ++high_count[keys[i] >> (64 - kHigh)];
    }
    counts_to_places<kTable>(low_count);
    counts_to_places<kTop>(high_count);
    std::uint64_t* __restrict const by_low = other_;
#pragma GCC unroll 4
    for (std::uint32_t i = 0; i < size; ++i) by_low[low_count[digits[i]]++] = keys[i];
    std::uint64_t* __restrict const sorted = keys_;
#pragma GCC unroll 4
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint64_t key = by_low[i];
      sorted[high_count[key >> (64 - kHigh)]++] = key;
    }
  }

  static unsigned byte_of(std::uint64_t key, unsigned byte) {
    return static_cast<unsigned>(key >> (8 * byte)) & 0xFFU;
  }

  template <unsigned... kBytes>
  void sort() {
    constexpr unsigned kTable = 256;
    std::uint32_t* __restrict const counts = job_.counts;
    __builtin_memset(counts, 0, sizeof(std::uint32_t) * kTable * sizeof...(kBytes));
    const std::uint64_t* __restrict const keys = keys_;
    const std::uint32_t size = size_;
#pragma GCC unroll 4
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint64_t key = keys[i];
      std::uint32_t* count = counts;
      ((++count[byte_of(key, kBytes)], count += kTable), ...);
    }
    std::uint32_t* count = counts;
    ((scatter<kBytes>(count), count += kTable), ...);
  }

  // Each count becomes the sum of those before it.
  template <unsigned kSize, class Count>
  static void counts_to_places(Count* const count) {
#if defined(__AVX2__)
    constexpr bool kShort = sizeof(Count) == 2;
    __m256i before = _mm256_setzero_si256();
    const auto add = [](__m256i a, __m256i b) { return kShort ? _mm256_add_epi16(a, b) : _mm256_add_epi32(a, b); };
    for (unsigned d = 0; d < kSize; d += 32 / sizeof(Count)) {
      auto* const place = reinterpret_cast<__m256i*>(count + d);
      const __m256i here = _mm256_loadu_si256(place);
      __m256i sum = here;
      if constexpr (kShort) sum = add(sum, _mm256_slli_si256(sum, 2));
      sum = add(sum, _mm256_slli_si256(sum, 4));
      sum = add(sum, _mm256_slli_si256(sum, 8));
      // The shifts stay in 128 bit halves: the upper one lacks the total of the lower.
      const __m256i last = _mm256_set1_epi32(kShort ? 0x0F0E0F0E : 0x0F0E0D0C);
      const __m256i lower = _mm256_permute2x128_si256(sum, sum, 0x08);
      sum = add(sum, _mm256_shuffle_epi8(lower, last));
      _mm256_storeu_si256(place, add(before, kShort ? _mm256_sub_epi16(sum, here) : _mm256_sub_epi32(sum, here)));
      before = add(before, _mm256_shuffle_epi8(_mm256_permute2x128_si256(sum, sum, 0x11), last));
    }
#else
    Count before = 0;
    for (unsigned d = 0; d < kSize; ++d) {
      const Count here = count[d];
      count[d] = before;
      before = static_cast<Count>(before + here);
    }
#endif
  }

  template <unsigned kByte>
  void scatter(std::uint32_t* __restrict const count) {
    std::uint64_t* __restrict const from = keys_;
    std::uint64_t* __restrict const to = other_;
    const std::uint32_t size = size_;
    if (count[byte_of(from[0], kByte)] == size) return;
    counts_to_places<256>(count);
#pragma GCC unroll 4
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint64_t key = from[i];
      to[count[byte_of(key, kByte)]++] = key;
    }
    keys_ = to;
    other_ = from;
  }

  // The first place from `i` on where a key is smaller than the one before it, give or take a few places in order; or size_.
  [[nodiscard]] std::uint32_t next_descent(std::uint32_t i) const {
    const std::uint64_t* const keys = keys_;
#if defined(__AVX512F__)
    for (; i + 8 <= size_; i += 8)
      if (_mm512_cmplt_epu64_mask(_mm512_loadu_si512(keys + i), _mm512_loadu_si512(keys + i - 1)) != 0) break;
#elif defined(__AVX2__)
    const __m256i sign = _mm256_set1_epi64x(INT64_MIN); // comparisons are signed
    for (; i + 4 <= size_; i += 4) {
      const __m256i here = _mm256_xor_si256(sign, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(keys + i)));
      const __m256i before = _mm256_xor_si256(sign, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(keys + i - 1)));
      if (_mm256_movemask_epi8(_mm256_cmpgt_epi64(before, here)) != 0) break;
    }
#endif
    while (i < size_ && keys[i - 1] <= keys[i]) ++i;
    return i;
  }

  // Insertion sort of nearly sorted keys. False: that takes too many steps.
  bool settle() {
    std::uint64_t* const keys = keys_;
    std::uint32_t steps = 2 * size_;
    for (std::uint32_t i = next_descent(1); i < size_; i = next_descent(i + 1)) {
      const std::uint64_t key = keys[i];
      std::uint32_t to = i;
      for (; to > 0 && keys[to - 1] > key; --to) {
        if (steps-- == 0) {
          keys[to] = key;
          return false;
        }
        keys[to] = keys[to - 1];
      }
      keys[to] = key;
    }
    return true;
  }

  bool finish() {
    std::uint32_t* __restrict const order = job_.order + 2;
    const double* __restrict const distance = job_.distance;
    const std::uint64_t* __restrict const keys = keys_;
    const std::uint32_t size = size_;
    // Bits of distances compare as they do; a negative difference is an ascent.
    std::uint64_t ascents = 0;
    std::uint64_t before = bits_of(__builtin_inf());
#pragma GCC unroll 4
    for (std::uint32_t i = 0; i < size; ++i) {
      const auto index = static_cast<std::uint32_t>(keys[i] & kIndexMask);
      order[i] = index;
      const std::uint64_t here = bits_of(distance[index]);
      ascents |= before - here;
      before = here;
    }
    return fits_ && ascents >> 63U == 0;
  }

  const OrderJob& job_;
  std::uint64_t* keys_;
  std::uint64_t* other_;
  std::uint32_t size_;
  bool fits_ = true;
};

} // namespace
} // namespace scansion
