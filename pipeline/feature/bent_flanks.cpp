// A parabola a side, as far as it is surer than the noise; Newton's rounds from where the straight lines meet.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/bent_flanks.hpp"

#include <cmath>

namespace scansion {

double BentFlanks::moved(double u) const noexcept {
  constexpr double kFewest = 5.0;    // samples
  constexpr double kOfNoise = 4.0;   // what is taken off the sum of squares, in variances: two sigma of the curvature
  constexpr double kLeast = 0.25;    // of the turning: flanks that meet at less than this meet anywhere
  constexpr double kFarthest = 0.35; // of the reach
  constexpr int kRounds = 3;
  const double slope_before = before.sine / before.cosine, turning = after.sine / after.cosine - slope_before;
  std::array<Parabola, 2> flank;
  std::array<double, 2> share{};
  for (std::size_t side = 0; side < 2; ++side) {
    if (sums[side].n < kFewest) continue;
    flank[side] = Parabola::fit(sums[side]);
    const bool as_the_edge = (flank[side].curvature > 0.0) == (turning > 0.0);
    if (!as_the_edge && flank[side].gain > kOfNoise * variance) share[side] = 1.0 - kOfNoise * variance / flank[side].gain;
  }
  if (share[0] == 0.0 && share[1] == 0.0) return 0.0;
  double moved = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const double at = u + moved;
    const double above = share[1] * flank[1].above_line(at) - share[0] * flank[0].above_line(at);
    const double slope = turning + share[1] * flank[1].slope_above_line(at) - share[0] * flank[0].slope_above_line(at);
    if (slope * turning <= kLeast * turning * turning) return 0.0;
    moved -= (turning * moved + above) / slope;
  }
  return std::abs(moved) < kFarthest * reach ? moved : 0.0;
}

} // namespace scansion
