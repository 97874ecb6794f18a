// Isolated outliers: they would be ranked first, so they go before the line is looked at.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile_ranker.hpp"

namespace scansion {

/// Replaces the height of samples that stand out from both neighbours on one side. `noise` in mm. Runs that had any are ranked
/// again by `ranker`, if there is one.
void clean_spikes(Profile& profile, double noise, ProfileRanker* ranker, std::vector<std::uint32_t>& scratch);

} // namespace scansion
