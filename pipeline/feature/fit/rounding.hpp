// The edge of a rounding: where the straight flanks beyond it would meet.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/fit/line_sums.hpp"
#include "pipeline/feature/fit/local_fit.hpp"

namespace scansion {

struct RoundedEdge {
  double s = 0.0, w = 0.0; ///< mm
  Direction before, after; ///< of the flanks
  Turning turning;
  double radius = 0.0;           ///< mm
  std::uint32_t flank_after = 0; ///< its first sample
  double sharpness = 0.0;        ///< of an edge against one arc over both flanks
  std::uint32_t window = 0;      ///< samples a side that it took
};

enum class RoundingSearch : std::uint8_t {
  none,     ///< no rounding between straight flanks
  edge,     ///< found
  too_wide, ///< it rounds so widely that there is no edge
};

/// The rounding around sample k, where a corner that turns like this was fitted at place `s`. It hides the neighbours that the
/// ranking gave, so only the samples `first` to `last` bound the search.
[[nodiscard]] RoundingSearch find_rounding(const Heights& heights, std::uint32_t k, std::uint32_t first, std::uint32_t last,
                                           std::uint32_t window, double s, const Turning& corner, const FitScale& scale,
                                           RoundedEdge& edge);

} // namespace scansion
