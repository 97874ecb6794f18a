// The one place where the benchmarks time the project's feature stage.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/our_features.hpp"

namespace scansion::bench {

OurFeatures::OurFeatures(const LineSet& set, const LevelSpec& levels) : lattice_(set.lattice), groups_(groups_of(set)) {
  Ranker ranker(set.resolution_mm);
  Calibrator calibrator(levels);
  for (const LineGroup& group : groups_) {
    GroupRanks& ranks = ranks_.emplace_back();
    rank_group(ranker, group, ranks);
    alphas_.push_back(calibrator.next(group, ranks, set.resolution_mm));
  }
}

void OurFeatures::run() {
  FeatureStage stage(lattice_, {});
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    report_.clear();
    stage.set_levels(alphas_[g]);
    stage.add(groups_[g], ranks_[g].distance, report_);
  }
  report_.clear();
  stage.finish(report_);
}

} // namespace scansion::bench
