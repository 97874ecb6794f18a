// Points by distance descending, depth, index: a radix sort by the leading bits of the distance, then whatever is left.
// Included by the units of each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/order_job.hpp"
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace scansion {
namespace {

// A key holds, from the top: a zero bit (so that signed comparisons do); the leading bits of the largest distance minus the
// point's; the depth; the index. Ascending keys are the order wanted, but for distances that differ in the bits cut off and for
// depths and indexes that do not fit.
constexpr unsigned kIndexBits = 22;
static_assert(kOrderPoints == std::size_t{1} << kIndexBits);
constexpr unsigned kDepthBits = 10;
constexpr unsigned kDistanceAt = kIndexBits + kDepthBits;
constexpr unsigned kDistanceBits = 63 - kDistanceAt;
constexpr std::uint32_t kMostDepth = (1U << kDepthBits) - 1;
constexpr std::uint64_t kIndexMask = (std::uint64_t{1} << kIndexBits) - 1;

inline std::uint64_t bits_of(double distance) {
  return __builtin_bit_cast(std::uint64_t, distance);
}

// How many bits of the distance the radix sort looks at, in how many passes: few points need few bits to differ, and tables as
// long as the run would cost as much as the run.
struct Digits {
  unsigned width, passes;
};
inline Digits digits_for(std::uint32_t n) {
  if (n < 400) return {8, 2};
  if (n < 2048) return {9, 2};
  if (n < 8192) return {10, 2};
  if (n < 65'536) return {11, 2};
  return {11, 3};
}

class RadixOrder {
public:
  explicit RadixOrder(const OrderJob& job) : job_(job), keys_(job.keys), other_(job.sorted), size_(job.n - 2) {}

  bool run() {
    fill_keys();
    const Digits digits = digits_for(job_.n);
    const unsigned wanted = digits.width * digits.passes;
    const unsigned looked_at = used_ < wanted ? used_ : wanted;
    const unsigned shift = kDistanceAt + used_ - looked_at;
    if (looked_at > 0) digits.passes == 2 ? pass<2>(shift, digits.width) : pass<3>(shift, digits.width);
    if (used_ > 0) exchange_neighbours();
    // Runs with few distances (flat ones, zigzags) have long ties.
    if (used_ == 0 || !settle()) {
      pass<1>(kIndexBits, kDepthBits);
      if (used_ > 0) pass<3>(kDistanceAt, 11);
    }
    return finish();
  }

private:
  void fill_keys() {
    const double* __restrict const distance = job_.distance + 1;
    const std::uint32_t* __restrict const depth = job_.depth + 1;
    std::uint64_t* __restrict const keys = keys_;
    const std::uint32_t size = size_;
    std::int64_t high = 0;
    std::int64_t low = INT64_MAX;
    for (std::uint32_t i = 0; i < size; ++i) {
      const auto b = static_cast<std::int64_t>(bits_of(distance[i]));
      const std::int64_t nonzero = b == 0 ? INT64_MAX : b; // zeros are equal whatever the leading bits are
      high = high < b ? b : high;
      low = nonzero < low ? nonzero : low;
    }
    const auto range = static_cast<std::uint64_t>(low < high ? high - low + 1 : 0);
    const bool zeros = low == INT64_MAX; // all of them
    const unsigned width = range == 0 || zeros ? 0 : 64U - static_cast<unsigned>(__builtin_clzll(range));
    const unsigned cut = width > kDistanceBits ? width - kDistanceBits : 0;
    used_ = width - cut;
    const std::int64_t last = (std::int64_t{1} << used_) - 1;
    std::uint32_t deepest = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::int64_t below = (high - static_cast<std::int64_t>(bits_of(distance[i]))) >> cut;
      const auto leading = static_cast<std::uint64_t>(below < last ? below : last);
      deepest |= depth[i];
      keys[i] = leading << kDistanceAt | std::uint64_t{depth[i] & kMostDepth} << kIndexBits | (i + 1);
    }
    fits_ = deepest <= kMostDepth && job_.n <= kOrderPoints;
  }

  // Stable, from the lowest digit on.
  template <unsigned kPasses>
  void pass(unsigned shift, unsigned width) {
    const std::uint32_t table = 1U << width;
    const std::uint64_t last = table - 1;
    const std::uint32_t size = size_;
    std::uint32_t* __restrict const counts = job_.counts;
    __builtin_memset(counts, 0, sizeof(std::uint32_t) * table * kPasses);
    const std::uint64_t* keys = keys_;
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint64_t digits = keys[i] >> shift;
      ++counts[digits & last];
      if constexpr (kPasses > 1) ++counts[table + (digits >> width & last)];
      if constexpr (kPasses > 2) ++counts[2 * table + (digits >> (2 * width) & last)];
    }
    for (unsigned p = 0; p < kPasses; ++p, shift += width) {
      std::uint32_t* __restrict const count = counts + p * table;
      std::uint64_t* __restrict const from = keys_;
      std::uint64_t* __restrict const to = other_;
      if (count[from[0] >> shift & last] == size) continue;
      std::uint32_t before = 0;
      for (std::uint32_t d = 0; d < table; ++d) {
        const std::uint32_t here = count[d];
        count[d] = before;
        before += here;
      }
      for (std::uint32_t i = 0; i < size; ++i) {
        const std::uint64_t key = from[i];
        to[count[key >> shift & last]++] = key;
      }
      keys_ = to;
      other_ = from;
    }
  }

  // One pass over each kind of pair: most ties are of two or three points, and this needs no prediction.
  void exchange_neighbours() {
    for (std::uint32_t round = 0; round < 3; ++round) {
      std::uint32_t i = round % 2;
#if defined(__AVX512F__)
      for (; i + 8 <= size_; i += 8) {
        const __m512i v = _mm512_loadu_si512(keys_ + i);
        const __m512i turned = _mm512_permutex_epi64(v, 0xB1);
        _mm512_storeu_si512(keys_ + i, _mm512_mask_blend_epi64(0xAA, _mm512_min_epi64(v, turned), _mm512_max_epi64(v, turned)));
      }
#elif defined(__AVX2__)
      for (; i + 4 <= size_; i += 4) {
        auto* const place = reinterpret_cast<__m256i*>(keys_ + i);
        const __m256i v = _mm256_loadu_si256(place);
        const __m256i turned = _mm256_permute4x64_epi64(v, 0xB1);
        // Both of a pair know whether they change places: the left one when it is larger, the right one when it is smaller.
        const __m256i greater = _mm256_cmpgt_epi64(v, turned);
        _mm256_storeu_si256(place, _mm256_blendv_epi8(v, turned, _mm256_permute4x64_epi64(greater, 0xA0)));
      }
#endif
      for (; i + 2 <= size_; i += 2) {
        const std::uint64_t left = keys_[i];
        const std::uint64_t right = keys_[i + 1];
        keys_[i] = left < right ? left : right;
        keys_[i + 1] = left < right ? right : left;
      }
    }
  }

  // Insertion sort of nearly sorted keys. False: that takes too many steps.
  bool settle() {
    std::uint64_t* const keys = keys_;
    const std::uint32_t size = size_;
    std::uint32_t steps = 2 * size;
    std::uint64_t before = keys[0];
    for (std::uint32_t i = 1; i < size; ++i) {
      const std::uint64_t key = keys[i];
      if (key > before) {
        before = key;
        continue;
      }
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
  unsigned used_ = 0; ///< bits of the distance in a key
  bool fits_ = true;
};

} // namespace
} // namespace scansion
