// Where the flanks of an edge meet when they are bent themselves, as the wall of a dome or of a round groove.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/fit/pair.hpp"
#include "pipeline/feature/fit/parabola.hpp"

namespace scansion {

/// Both sides of an edge, from the sample that the sums are about; `before` and `after` are the straight lines through them.
struct BentFlanks {
  BasicPowerSums<Pair> sums;
  Direction before, after;
  double variance = 0.0; ///< mm2, of the noise
  double reach = 0.0;    ///< mm, of the shorter side

  /// How far from `u`, where the straight lines meet, the bent flanks do; 0 where noise may have bent them, and where they bend
  /// as the edge turns: that is its rounding, and the flanks lie beyond.
  [[nodiscard]] double moved(double u) const noexcept;
};

} // namespace scansion
