// The one place where the benchmarks time the project's feature stage.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_stage.hpp"
#include "pipeline/pipeline.hpp"
#include "tests/bench/lines.hpp"

namespace scansion::bench {

/// A set, grouped and ranked before the clock runs. Thread-bound.
class OurFeatures {
public:
  OurFeatures(const LineSet& set, const LevelSpec& levels);

  /// The whole scan through a stage of its own, to the end: feature lines, patches and forms.
  void run();

private:
  Lattice lattice_;
  std::vector<LineGroup> groups_;
  std::vector<GroupRanks> ranks_;
  std::vector<AlphaSet> alphas_;
  FeatureReport report_;
};

} // namespace scansion::bench
