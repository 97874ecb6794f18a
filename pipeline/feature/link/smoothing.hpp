// The published place of a track's points: a local curve through the raw ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/link/track.hpp"

namespace scansion {

/// Weighted quadratics over three points a side, with one robust second round. Needs no more than that on either side, so it
/// runs three points behind a growing track. Sets smooth_q and smooth_w of points [first, last).
void smooth(Track& track, std::size_t first, std::size_t last);

} // namespace scansion
