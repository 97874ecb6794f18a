// Isolated outliers: they would be ranked first, so they go before the line is looked at.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile.hpp"
#include "pipeline/rank/rank.hpp"

namespace scansion {

/// Thread-bound.
class SpikeFilter {
public:
  explicit SpikeFilter(Rational resolution_mm) : resolution_(resolution_mm.value()), ranker_(resolution_mm) {}
  /// Replaces the height of samples that stand out from both neighbours on one side, and ranks their runs again. `noise` in mm.
  void clean(Profile& profile, double noise);

private:
  void rank_again(Profile& profile, std::size_t first, std::size_t last);

  double resolution_;
  Ranker ranker_;
  std::vector<std::int32_t> s_, w_, zero_;
  std::vector<double> distance_;
  std::vector<std::uint32_t> depth_;
};

} // namespace scansion
