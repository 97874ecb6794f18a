// The vector ranking as a whole. Included by the units of each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/planar_search.hpp"
#include "pipeline/rank/spatial_search.hpp"

namespace scansion {
namespace {

struct Extent {
  std::int32_t low, high;
};
inline Extent extent_of(const std::int32_t* axis, std::uint32_t n) {
  Extent e{axis[0], axis[0]};
  for (std::uint32_t i = 1; i < n; ++i) {
    e.low = axis[i] < e.low ? axis[i] : e.low;
    e.high = axis[i] > e.high ? axis[i] : e.high;
  }
  return e;
}

inline void rank_vector(VectorJob job) {
  std::uint32_t most = 0;
  std::uint64_t area = 1; // the product of the spans of the axes along which runs move
  unsigned constant = 3;  // the last axis along which no run moves
  for (unsigned k = 0; k < 3; ++k) {
    Extent all{job.axes[k][0], job.axes[k][0]};
    bool moves = false;
    for (std::uint32_t r = 0; r < job.run_count; ++r) {
      const auto [a, b] = job.runs[r];
      const Extent e = extent_of(job.axes[k] + a, b - a + 1);
      all = {smaller(all.low, e.low), larger(all.high, e.high)};
      moves |= e.low != e.high;
    }
    const std::uint32_t span = static_cast<std::uint32_t>(all.high) - static_cast<std::uint32_t>(all.low);
    if (!moves)
      constant = k;
    else
      area = area < kCrossExact ? area * (span + std::uint64_t{1}) : area;
    most = larger(most, span);
  }
  job.wide = most >= kNarrowSpan;
  if (constant == 3 || job.wide) job.guarded = nullptr;
  // A planar run is seen along its two axes, unless they are too long for that; then the third comes last.
  const bool exact = constant < 3 && most < kPlanarExact;
  const bool planar = exact || (constant < 3 && !job.wide && area < kCrossExact);
  const std::int32_t** const seen[3] = {&job.u, &job.v, &job.w};
  unsigned next = 0;
  const auto see = [&](unsigned k) {
    std::int32_t* const copy = job.copies + next * (job.n + kVectorPad);
    __builtin_memcpy(copy, job.axes[k], job.n * sizeof(std::int32_t));
    for (std::size_t i = 0; i < kVectorPad; ++i) copy[job.n + i] = copy[job.n - 1];
    *seen[next++] = copy;
  };
  for (unsigned k = 0; k < 3; ++k)
    if (k != constant) see(k);
  if (constant < 3 && !planar) see(constant);

  if (exact) {
    PlanarSearch<false> search(job, most);
    grow_tree(job, search);
  } else if (planar) {
    PlanarSearch<true> search(job, most);
    grow_tree(job, search);
  } else if (most < SpatialSearch<false>::kWide) {
    SpatialSearch<false> search(job, most);
    grow_tree(job, search);
  } else {
    SpatialSearch<true> search(job, most);
    grow_tree(job, search);
  }
}

} // namespace
} // namespace scansion
