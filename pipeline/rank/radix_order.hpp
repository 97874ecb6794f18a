// Points by distance descending, depth, index: a radix sort by depth and the leading bits of the distance, then whatever is
// left. Included by the units of each instruction set. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/order_job.hpp"
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace scansion {
namespace {

// A key holds, from the top: the leading 32 bits of the largest distance minus the point's; 8 bits of depth; the index.
// Ascending keys are the order wanted, but for distances that differ in the bits cut off and for depths and indexes that do not
// fit. Digits are bytes, so taking one costs nothing.
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
    fill_keys();
    // Equal distances are common (parts of an interval have its distance at most, small ones have few values), so depths come
    // first: every pass keeps the order of the one before. Few points need few bits to differ; settling does the rest.
    if (job_.n < 2048)
      sort<3, 6, 7>();
    else if (job_.n < 262'144)
      sort<3, 5, 6, 7>();
    else
      sort<3, 4, 5, 6, 7>();
    if (!settle()) sort<0, 1, 2, 3, 4, 5, 6, 7>();
    return finish();
  }

private:
  void fill_keys() {
    const double* __restrict const distance = job_.distance + 1;
    const std::uint32_t* __restrict const depth = job_.depth + 1;
    std::uint64_t* __restrict const keys = keys_;
    const std::uint32_t size = size_;
    // Zeros are equal whatever the leading bits are, so the least of the others sets the range.
    double most = 0;
    double least = __builtin_inf();
    for (std::uint32_t i = 0; i < size; ++i) {
      const double d = distance[i];
      const double positive = d > 0 ? d : __builtin_inf();
      most = most < d ? d : most;
      least = positive < least ? positive : least;
    }
    const auto high = static_cast<std::int64_t>(bits_of(most));
    const auto range = static_cast<std::uint64_t>(most > 0 ? high - static_cast<std::int64_t>(bits_of(least)) + 1 : 0);
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

  static unsigned byte_of(std::uint64_t key, unsigned byte) { return static_cast<unsigned>(key >> (8 * byte)) & 0xFFU; }

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
  static void counts_to_places(std::uint32_t* const count) {
#if defined(__AVX2__)
    __m256i before = _mm256_setzero_si256();
    for (unsigned d = 0; d < 256; d += 8) {
      auto* const place = reinterpret_cast<__m256i*>(count + d);
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
    std::uint32_t before = 0;
    for (unsigned d = 0; d < 256; ++d) {
      const std::uint32_t here = count[d];
      count[d] = before;
      before += here;
    }
#endif
  }

  template <unsigned kByte>
  void scatter(std::uint32_t* __restrict const count) {
    std::uint64_t* __restrict const from = keys_;
    std::uint64_t* __restrict const to = other_;
    const std::uint32_t size = size_;
    if (count[byte_of(from[0], kByte)] == size) return;
    counts_to_places(count);
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
    bool sorted = fits_;
    double before = __builtin_inf();
    std::uint32_t* __restrict const order = job_.order + 2;
    const double* __restrict const distance = job_.distance;
    const std::uint64_t* __restrict const keys = keys_;
    const std::uint32_t size = size_;
#pragma GCC unroll 4
    for (std::uint32_t i = 0; i < size; ++i) {
      const auto index = static_cast<std::uint32_t>(keys[i] & kIndexMask);
      order[i] = index;
      const double here = distance[index];
      sorted = sorted & (here <= before);
      before = here;
    }
    return sorted;
  }

  const OrderJob& job_;
  std::uint64_t* keys_;
  std::uint64_t* other_;
  std::uint32_t size_;
  bool fits_ = true;
};

} // namespace
} // namespace scansion
