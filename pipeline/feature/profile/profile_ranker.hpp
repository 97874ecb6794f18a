// Ranks runs of a profile again, where it is no longer what the line was ranked as.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/profile.hpp"
#include "pipeline/rank/rank.hpp"

namespace scansion {

/// Thread-bound: holds scratch.
class ProfileRanker {
public:
  explicit ProfileRanker(Rational resolution_mm) : resolution_(resolution_mm.value()), ranker_(resolution_mm) {}
  /// Sets the distances of samples [first, last), which are one run. Places and heights are rounded to the resolution.
  void rank(Profile& profile, std::size_t first, std::size_t last);

private:
  double resolution_;
  Ranker ranker_;
  std::vector<std::int32_t> s_, w_, zero_;
  std::vector<double> distance_;
  std::vector<std::uint32_t> depth_;
};

} // namespace scansion
