// The online search for feature lines and patches: ranked scan lines in, settled findings out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"
#include "pipeline/feature/settings.hpp"
#include "pipeline/model/alpha_set.hpp"
#include "pipeline/model/lattice.hpp"
#include "pipeline/model/scan_line.hpp"

#include <memory>
#include <span>

namespace scansion {

/// Takes the groups of one recording in order; memory is bounded by the settings, not by the length of the scan. What comes out
/// is a function of the lines alone. Thread-bound.
class FeatureStage {
public:
  /// `lattice` must have a resolution in mm (see resolution_mm).
  FeatureStage(const Lattice& lattice, const FeatureSettings& settings);
  ~FeatureStage();
  FeatureStage(FeatureStage&&) noexcept;
  FeatureStage& operator=(FeatureStage&&) noexcept;

  /// `distance` is that of the Ranker, one value per point of the group. Adds to `report` what has been settled.
  void add(const LineGroup& group, std::span<const double> distance, FeatureReport& report);
  /// The alpha-set in force from the next group on: FeatureLine::level counts in it.
  void set_levels(const AlphaSet& alpha);
  /// Lines are missing between the group before and the next one.
  void skip(const Gap& gap);
  /// The scan ends: everything that is still open is settled.
  void finish(FeatureReport& report);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace scansion
