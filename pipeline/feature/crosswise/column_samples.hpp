// Heights of one scan line where columns cross it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/sampling.hpp"

#include <cstdint>

namespace scansion {

/// `left`: number of the first of these columns.
struct ColumnSpan {
  std::int64_t left = 0;
  std::size_t width = 0;
};

/// What columns see between the first and the last sample of each run: no height elsewhere, and where samples are missing.
/// `height` and `source` (sample of the scan line; the first one where none is near) have room for all columns, which hold all
/// that the profile reaches. It stands to them.
void sample_columns(const Profile& profile, const Sampling& sampling, const ColumnSpan& columns, float* height,
                    std::uint32_t* source);

} // namespace scansion
