// Scans of scenes through the feature stage, judged against their ground truth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/settings.hpp"
#include "pipeline/model/result.hpp"
#include "sim/scene/scan_plan.hpp"
#include "tests/score/score.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace scansion::bench {

struct FeatureCase {
  std::string scene;
  double pitch_mm = 0.1;
  double noise_um = 5.0;
  double direction_deg = 0.0;
  std::string fault = "clean";
  double backlash_um = 0.0; ///< other than 0: of a zigzag scan
};

struct FeatureOutcome {
  score::Score score;
  std::optional<Backlash> backlash;
  std::uint64_t points = 0, lines = 0, patches = 0;
  double stage_ns = 0.0; ///< processor time of the feature stage a point
};

[[nodiscard]] const std::vector<std::string>& small_parts();
/// What `fault` does to a scan; every name but "all". Fails with usage.
[[nodiscard]] Result<ScanPlan> plan_of(const FeatureCase& one);
[[nodiscard]] Result<FeatureOutcome> run_case(const FeatureCase& one, const FeatureSettings& settings);

} // namespace scansion::bench
