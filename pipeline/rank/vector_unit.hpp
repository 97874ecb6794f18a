// The vector ranking as a whole. Included by the units of each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/planar_search.hpp"
#include "pipeline/rank/spatial_search.hpp"

namespace scansion {
namespace {

inline std::uint32_t span_of(const std::int32_t* axis, std::uint32_t n) {
  std::int32_t low = axis[0];
  std::int32_t high = axis[0];
  for (std::uint32_t i = 1; i < n; ++i) {
    low = axis[i] < low ? axis[i] : low;
    high = axis[i] > high ? axis[i] : high;
  }
  return static_cast<std::uint32_t>(high) - static_cast<std::uint32_t>(low);
}

inline bool rank_vector(VectorJob job) {
  std::uint32_t most = 0;
  unsigned constant = 3;
  for (unsigned k = 0; k < 3; ++k) {
    const std::uint32_t span = span_of(job.axes[k], job.n);
    most = larger(most, span);
    if (span == 0) constant = k;
  }
  if (most >= kNarrowSpan) return false;

  const std::int32_t** const seen[3] = {&job.u, &job.v, &job.w};
  unsigned next = 0;
  for (unsigned k = 0; k < 3; ++k) {
    if (k == constant) continue;
    std::int32_t* const copy = job.copies + next * (job.n + kVectorPad);
    __builtin_memcpy(copy, job.axes[k], job.n * sizeof(std::int32_t));
    for (std::size_t i = 0; i < kVectorPad; ++i) copy[job.n + i] = copy[job.n - 1];
    *seen[next++] = copy;
  }
  if (constant < 3) {
    PlanarSearch search(job, most);
    grow_tree(job, search);
  } else {
    SpatialSearch search(job, most);
    grow_tree(job, search);
  }
  return true;
}

} // namespace
} // namespace scansion
