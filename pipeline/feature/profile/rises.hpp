// Where heights of a profile step from sample to sample: found once for all who look for spikes, walls and jumps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/profile.hpp"

#include <span>

namespace scansion {

/// Notes in a profile the intervals that rise or fall by more than `above`, mm.
void note_rises(Profile& profile, double above, std::vector<std::uint32_t>& scratch);

/// Those before the samples [begin, end) of a run, and none that leads out of it.
[[nodiscard]] std::span<const std::uint32_t> rises_of(std::span<const std::uint32_t> rises, std::uint32_t begin,
                                                      std::uint32_t end) noexcept;

} // namespace scansion
