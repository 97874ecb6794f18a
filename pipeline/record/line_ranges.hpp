// Which lines are missing, and of which of them a gap message tells.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/scan_line.hpp"
#include "pipeline/record/repair.hpp"

#include <vector>

namespace scansion {

/// A stretch of line indexes without a line, up to the line that ends it.
struct Hole {
  LineRange lines;
  std::uint64_t time = 0; ///< log time of the line behind it
};

/// The parts of `holes` (in order, apart) that no gap names. A gap of unknown count names everything up to the end of the hole
/// it starts in. Gaps may come in any order and overlap.
[[nodiscard]] std::vector<Hole> unexplained(const std::vector<Hole>& holes, std::vector<Gap> gaps);

} // namespace scansion
