// The farthest point of one interval, one point after the other: right for every kernel, and what the vector searches fall back
// to.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/chord.hpp"
#include "pipeline/rank/middle.hpp"

namespace scansion {

template <class Kernel>
struct Farthest {
  std::size_t index = 0;
  exact::Squared<typename Kernel::Number, typename Kernel::Length> distance;
};

/// a + 1 < b. Ties by `rule`, then the smaller index.
template <class Kernel>
Farthest<Kernel> farthest(const Kernel& kernel, const MiddleRule& rule, std::size_t a, std::size_t b) {
  const auto chord = kernel.chord(a, b);
  // Best inside the ends and best beyond them are kept apart: within each the comparison is one integer.
  typename Kernel::Cross best_cross = 0;
  typename Kernel::Beyond best_beyond = 0;
  std::size_t inside = 0;
  std::size_t outside = 0;
  for (std::size_t k = a + 1; k < b; ++k) {
    typename Kernel::Cross cross;
    typename Kernel::Beyond beyond;
    if (kernel.measure(chord, k, cross, beyond)) {
      if (cross > best_cross || inside == 0 ||
          (cross == best_cross && rule.off_middle(k, a, b) < rule.off_middle(inside, a, b))) {
        best_cross = cross;
        inside = k;
      }
    } else if (beyond > best_beyond || outside == 0 ||
               (beyond == best_beyond && rule.off_middle(k, a, b) < rule.off_middle(outside, a, b))) {
      best_beyond = beyond;
      outside = k;
    }
  }
  Farthest<Kernel> in{inside, {Kernel::squared(best_cross), chord.length}};
  Farthest<Kernel> out{outside, {best_beyond, 1}};
  if (outside == 0) return in;
  if (inside == 0) return out;
  const int order = exact::compare(in.distance, out.distance, chord.length);
  if (order != 0) return order > 0 ? in : out;
  const std::int64_t in_off = rule.off_middle(inside, a, b);
  const std::int64_t out_off = rule.off_middle(outside, a, b);
  return in_off < out_off || (in_off == out_off && inside < outside) ? in : out;
}

} // namespace scansion
