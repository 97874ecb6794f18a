// Isolated outliers: they would be ranked first, so they go before the line is looked at.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/profile_ranker.hpp"

namespace scansion {

/// What stands out from its neighbours by less is no spike. `noise` and result in mm.
[[nodiscard]] double spike_limit(double noise) noexcept;

/// Replaces the height of samples that stand out from both neighbours on one side; rises must be noted. `noise` in mm. Runs
/// that had any are ranked again by `ranker`, if there is one.
void clean_spikes(Profile& profile, double noise, ProfileRanker* ranker);

} // namespace scansion
