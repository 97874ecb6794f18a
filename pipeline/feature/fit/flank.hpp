// The straight flank beside an edge, found beyond whatever rounds the edge.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/fit/local_fit.hpp"

namespace scansion {

/// A gap of fewer samples tells nothing about a rounding, and moves no edge by more than they do.
inline constexpr std::uint32_t kLeastGap = 3;

struct Flank {
  double s = 0.0, w = 0.0; ///< a place of it: the middle of its samples
  double slope = 0.0;      ///< dw / ds
  double length = 0.0;     ///< mm along s
  std::uint32_t samples = 0;
  std::uint32_t gap = 0; ///< samples between the edge and the flank
  bool straight = false; ///< within the noise
  bool rounded = false;  ///< the gap is a rounding
  [[nodiscard]] double at(double place) const noexcept { return w + slope * (place - s); }
};

/// The first straight stretch of `window` samples or more from sample `from` outwards, up to sample `to` (included; below
/// `from`: to the left), at most `most_gap` samples away; long enough to be no part of an arc, or the first of a few samples
/// when there is none, or the straightest one. Without a gap: the `window` samples beside `from`.
[[nodiscard]] Flank find_flank(const Heights& heights, std::uint32_t from, std::uint32_t to, std::uint32_t window,
                               std::uint32_t most_gap, const FitScale& scale);

/// Whether what lies between the edge and a flank found from sample `from` towards `to` is straight itself.
[[nodiscard]] bool is_chamfered(const Heights& heights, std::uint32_t from, std::uint32_t to, const Flank& flank,
                                const FitScale& scale);

} // namespace scansion
