// Tracks to curves.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/curve.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

void Curve::reverse() {
  std::reverse(points.begin(), points.end());
  std::swap(begins, ends);
}

void cut_stretches(const Track& track, std::size_t fewest, std::vector<Curve>& out) {
  const std::size_t n = track.points.size();
  for (std::size_t i = 0; i < n;) {
    if (track.points[i].verdict == Verdict::dropped) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < n && track.points[end].verdict != Verdict::dropped) ++end;
    if (end - i >= fewest) {
      Curve curve;
      curve.convex = track.convex();
      curve.begins = i == 0 ? track.begins : FeatureEnd::death;
      curve.ends = end == n ? track.ends : FeatureEnd::death;
      for (std::size_t k = i; k < end; ++k) {
        const TrackPoint& p = track.points[k];
        curve.points.push_back(
            {track.s_of(p), p.smooth_w, track.c_of(p), p.feature, track.pass == Pass::lengthwise ? p.step : std::int64_t{-1}});
      }
      out.push_back(std::move(curve));
    }
    i = end;
  }
}

double length_of(const Curve& curve) noexcept {
  double length = 0.0;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const CurvePoint &a = curve.points[i - 1], &b = curve.points[i];
    length += std::hypot(b.s - a.s, b.w - a.w, b.c - a.c);
  }
  return length;
}

} // namespace scansion
