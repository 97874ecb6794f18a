// Farthest points of short planar intervals in 16 bit halves, eight intervals of one length at once. Included by the units of
// each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/eight.hpp"

namespace scansion {
namespace {

// The inner points of an interval, those closest to its middle first, the lower one of two: the order in which ties are
// decided.
template <unsigned kInner>
struct MiddleFirst {
  std::uint8_t at[kInner];
  constexpr MiddleFirst() : at{} {
    unsigned next = 0;
    for (unsigned off = 0; off <= kInner; ++off)
      for (unsigned k = 1; k <= kInner; ++k)
        if ((2 * k > kInner + 1 ? 2 * k - (kInner + 1) : kInner + 1 - 2 * k) == off) at[next++] = static_cast<std::uint8_t>(k);
  }
};

// The squared distance of b to the chord from a to c.
inline Eight::Real lone_distance(Eight::V a, Eight::V b, Eight::V c) {
  using E = Eight;
  const E::V along = E::sub16(c, a);
  const E::V d = E::sub16(b, a);
  const E::V length = E::madd(along, along);
  const E::V dot = E::madd(d, along);
  const E::Real cross = E::real(E::madd(d, E::across(along)));
  const E::S ahead_of_start = E::greater(dot, E::zero());
  const E::S inside = E::both(ahead_of_start, E::greater(length, dot));
  E::Real squared = E::mul(cross, cross);
  E::Real over = E::real(length);
  if (E::bits(inside) != E::kAll) {
    // Beyond an end of the chord the distance to that end counts. It stays below 2^15 counts on each axis, as the reach does.
    const E::V f = E::pick(ahead_of_start, E::sub16(b, c), d);
    squared = E::pick(inside, squared, E::real(E::madd(f, f)));
    over = E::pick(inside, over, E::real(E::set1(1)));
  }
  return E::div(squared, over);
}

/// Intervals of one inner point: parts.right has them.
inline void split_eight_ones(const std::uint32_t* pairs, const Waiting* w, Parts& parts) {
  using E = Eight;
  E::V p[4];
  E::four(pairs, w, p);
  const E::Open open = E::open(w);
  E::put(open, 1, E::set1(1), E::min(lone_distance(p[0], p[1], p[2]), open.bound), parts.right);
}

/// The squared distances of the farthest inner points and their places, for kInner of them.
template <unsigned kInner>
struct FarthestEight {
  Eight::Real squared;
  Eight::V at;
  Eight::S inside; ///< whether no point lies beyond an end of the chord; else there is no answer

  explicit FarthestEight(const Eight::V* p) {
    using E = Eight;
    constexpr MiddleFirst<kInner> kOrder;
    const E::V along = E::sub16(p[kInner + 1], p[0]);
    const E::V across = E::across(along);
    const E::V length = E::madd(along, along);
    E::V cross[kInner + 1];
    E::V nearest = length;
    E::V farthest = E::zero();
#pragma GCC unroll 16
    for (unsigned k = 1; k <= kInner; ++k) {
      const E::V d = E::sub16(p[k], p[0]);
      const E::V dot = E::madd(d, along);
      cross[k] = E::abs32(E::madd(d, across));
      nearest = E::min32(nearest, dot);
      farthest = E::max32(farthest, dot);
    }
    E::V top = cross[kOrder.at[0]];
    at = E::set1(kOrder.at[0]);
#pragma GCC unroll 16
    for (unsigned i = 1; i < kInner; ++i) {
      const E::V here = cross[kOrder.at[i]];
      at = E::pick(E::greater(here, top), E::set1(kOrder.at[i]), at);
      top = E::max32(top, here);
    }
    inside = E::both(E::greater(nearest, E::zero()), E::greater(length, farthest));
    const E::Real c = E::real(top);
    squared = E::div(E::mul(c, c), E::real(length));
  }
};

template <unsigned kInner>
inline Unsplit unsplit(const FarthestEight<kInner>& far, double floor) {
  const std::uint32_t apart = ~Eight::bits(far.inside) & Eight::kAll;
  return {apart, ~Eight::above(far.squared, floor) & Eight::kAll};
}

/// Intervals of two inner points: parts.right has the ones that split them, parts.left the others.
inline Unsplit split_eight_twos(const std::uint32_t* pairs, const Waiting* w, double floor, Parts& parts) {
  using E = Eight;
  E::V p[4];
  E::four(pairs, w, p);
  const FarthestEight<2> far(p);
  const E::Open open = E::open(w);
  const E::Real q = E::min(far.squared, open.bound);
  const E::S second = E::equal(far.at, E::set1(2));
  const E::Real rest = lone_distance(E::pick(second, p[0], p[1]), E::pick(second, p[1], p[2]), E::pick(second, p[2], p[3]));
  E::put(open, 1, far.at, q, parts.right);
  E::put(open, 2, E::pick(second, E::set1(1), E::set1(2)), E::min(rest, q), parts.left);
  return unsplit(far, floor);
}

/// Splits intervals of kInner inner points.
template <unsigned kInner>
inline Unsplit split_eight(const std::uint32_t* pairs, const Waiting* w, double floor, Parts& parts) {
  using E = Eight;
  constexpr std::size_t kFours = (kInner + 2 + 3) / 4;
  E::V p[4 * kFours];
#pragma GCC unroll 4
  for (std::size_t f = 0; f < kFours; ++f) E::four(pairs + 4 * f, w, p + 4 * f);
  const FarthestEight<kInner> far(p);
  const E::Open open = E::open(w);
  const E::Real q = E::min(far.squared, open.bound);
  E::store(parts.at, far.at);
  E::put(open, 1, E::zero(), q, parts.left);
  E::put(open, 1, far.at, q, parts.right);
  return unsplit(far, floor);
}

} // namespace
} // namespace scansion
