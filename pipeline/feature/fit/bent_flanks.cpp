// A parabola a side, as far as it is surer than the noise; Newton's rounds from where the straight lines meet.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/fit/bent_flanks.hpp"

#include "pipeline/feature/passes/fastest.hpp"

#include <cmath>

namespace scansion {

namespace {

double moved_body(const BentFlanks& flanks, double u) {
  const auto& [sums, before, after, variance, reach] = flanks;
  constexpr double kFewest = 5.0;    // samples
  constexpr double kOfNoise = 4.0;   // what is taken off the sum of squares, in variances: two sigma of the curvature
  constexpr double kLeast = 0.25;    // of the turning: flanks that meet at less than this meet anywhere
  constexpr double kFarthest = 0.35; // of the reach
  constexpr int kRounds = 3;
  const double slope_before = before.sine / before.cosine, turning = after.sine / after.cosine - slope_before;
  const auto flank = BasicParabola<Pair>::fit(sums);
  const Pair none{}, off = both(kOfNoise * variance);
  Pair share = flank.gain > off ? 1.0 - off / flank.gain : none;
  share = flank.curvature * turning > 0.0 ? none : share; // bent as the edge
  share = sums.n < kFewest ? none : share;
  if (share[0] == 0.0 && share[1] == 0.0) return 0.0;
  double moved = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const Pair at = both(u + moved);
    const double above = difference(share * flank.above_line(at));
    const double slope = turning + difference(share * flank.slope_above_line(at));
    if (slope * turning <= kLeast * turning * turning) return 0.0;
    moved -= (turning * moved + above) / slope;
  }
  return std::abs(moved) < kFarthest * reach ? moved : 0.0;
}

} // namespace

double BentFlanks::moved(double u) const noexcept {
  return passes::fastest<moved_body>(*this, u);
}

} // namespace scansion
