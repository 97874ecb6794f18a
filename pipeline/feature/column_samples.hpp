// Heights of one scan line where columns cross it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/sampling.hpp"

#include <cstdint>

namespace scansion {

/// Columns stand at whole multiples of the pitch.
struct ColumnGrid {
  double pitch = 1.0;    ///< mm
  std::int64_t left = 0; ///< number of the first one
  double base = 0.0;     ///< mm: heights are relative to it
};

/// Fills in what columns see between the first and the last sample of each run, but no height where samples are missing; other
/// columns stay as they are. `height` and `source` (sample of the scan line) begin at the first column and hold all that the
/// profile reaches.
void sample_columns(const Profile& profile, const Sampling& sampling, const ColumnGrid& grid, float* height,
                    std::uint32_t* source);

} // namespace scansion
