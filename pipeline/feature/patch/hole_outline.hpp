// The outline of a region without samples: its slabs, one and more a scan line, traced round (docs/FEATURES.md, "Holes").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace scansion {

/// Where samples are missing on one scan line, mm.
struct HoleSlab {
  std::int64_t row = 0;
  std::uint64_t line = 0;
  double c = 0.0, c_low = 0.0, c_high = 0.0; ///< of the line, and midway to the lines before and after
  double s_low = 0.0, s_high = 0.0;          ///< half a pitch from the samples on both sides
  double w_low = 0.0, w_high = 0.0;          ///< their heights
  std::uint32_t first = 0, last = 0;         ///< their indices in the line
  double off = 0.0;                          ///< by how much the far side misses what the surface leads to
};

struct RimPoint {
  double s = 0.0, w = 0.0, c = 0.0; ///< mm
  std::uint64_t line = 0;
  std::uint32_t sample = 0;
};

/// Lengths in mm, in plan.
struct HoleOutline {
  std::vector<RimPoint> points; ///< a closed curve: the first follows the last
  double s = 0.0, c = 0.0;      ///< middle of the area
  double w = 0.0;               ///< mean height of the rim
  double area = 0.0;
  double s_low = 0.0, s_high = 0.0, c_low = 0.0, c_high = 0.0;
  double inner_mm = 0.0; ///< length of the borders of what stands inside, along and across the lines
  double rise = 0.0;     ///< of it above the rim, mean
};

/// Of slabs that hang together, in the order of rows and places. Empty when they leave no curve.
[[nodiscard]] std::optional<HoleOutline> trace_hole(const std::vector<HoleSlab>& slabs, double pitch);

} // namespace scansion
