// Scan lines, runs and groups.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/model/scan_line.hpp"

namespace scansion {

void append_line(LineGroup& group, std::uint64_t index, const LineBuffer& line) {
  const auto first_point = static_cast<std::uint32_t>(group.points());
  group.lines.push_back(ScanLine{.index = index,
                                 .stamps = line.stamps,
                                 .plane = line.plane,
                                 .first_run = static_cast<std::uint32_t>(group.runs.size()),
                                 .run_count = static_cast<std::uint32_t>(line.runs.size()),
                                 .invalid_after = line.invalid_after});
  for (Run run : line.runs) {
    run.first += first_point;
    group.runs.push_back(run);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    group.xyz[axis].insert(group.xyz[axis].end(), line.xyz[axis].begin(), line.xyz[axis].end());
    group.ulp[axis].insert(group.ulp[axis].end(), line.ulp[axis].begin(), line.ulp[axis].end());
  }
}

} // namespace scansion
