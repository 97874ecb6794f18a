// PLY files: range grids, and point lists with a line number.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/ply_header.hpp"
#include "pipeline/import/sample.hpp"

#include <memory>

namespace scansion {

/// With an element `range_grid` each column (with `grid_rows`: row) of the grid is a scan line; without, each stretch of
/// vertices with the same integer property `line`. Fails for a PLY file with neither. `notes` outlives the call only.
[[nodiscard]] Result<std::unique_ptr<SampleReader>> open_ply(ByteWindow window, bool grid_rows, Notes& notes);

} // namespace scansion
