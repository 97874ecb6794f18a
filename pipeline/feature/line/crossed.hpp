// Two scans of one part whose lines cross: each place of an edge from the scan that measures it better (docs/FEATURES.md,
// "Crossed scans").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"

#include <array>
#include <vector>

namespace scansion {

/// A stretch of a scan line with points: how far across the scan, and from where to where along it, mm in plan.
struct ScannedRun {
  double across = 0.0, from = 0.0, to = 0.0;
};

/// What one of the scans found: whole lines, as join_pieces() gives them.
struct FoundByScan {
  std::vector<FeatureLine> lines;
  std::array<double, 2> along{1.0, 0.0}; ///< of its scan lines in plan, a unit vector
  double step_mm = 0.0;                  ///< u: the larger of pitch and spacing
  std::vector<ScannedRun> scanned;       ///< by `across`

  /// Whether it looked there.
  [[nodiscard]] bool covers(double x, double y) const noexcept;
};

struct CrossedLines {
  std::vector<FeatureLine> lines;         ///< numbered anew from 1
  double common_mm = 0.0;                 ///< length of the lines of the first scan that the second one found too
  double first_mm = 0.0, second_mm = 0.0; ///< length of all lines of each
};

/// Both in one frame. The same for the same input; the scans may change places but for lines that both measure alike.
[[nodiscard]] CrossedLines merge_crossed(FoundByScan first, FoundByScan second);

} // namespace scansion
