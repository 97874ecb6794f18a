// Pairs of samples in place of samples, for scans that are far denser than their noise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/profile_ranker.hpp"
#include "pipeline/feature/profile/sampling.hpp"

namespace scansion {

/// Whether the noise against the pitch is such that pairs show more than samples do.
[[nodiscard]] bool wants_averaging(const Sampling& sampling) noexcept;

/// What a stated noise is for pairs of samples.
[[nodiscard]] FeatureSettings averaged(FeatureSettings settings) noexcept;

/// Fills `out` with means of two successive samples each, ranked; samples on either side of a jump stay apart.
void average_pairs(const Profile& profile, const Sampling& sampling, ProfileRanker& ranker, Profile& out);

} // namespace scansion
