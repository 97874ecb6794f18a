// Tracks to curves.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/curve.hpp"

#include "pipeline/feature/link/evidence.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

void Curve::reverse() {
  std::reverse(points.begin(), points.end());
  std::swap(front, back);
}

void cut_stretches(const Track& track, std::size_t count, std::size_t fewest, std::vector<Curve>& out) {
  const auto kept = [&](std::size_t i) { return track.points[i].verdict != Verdict::dropped; };
  const std::size_t size = track.points.size();
  for (std::size_t i = 0; i < count;) {
    if (!kept(i)) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < count && kept(end)) ++end;
    const bool follows = i == 0 && track.goes_on, leads = end == count && end < size && kept(end);
    if (end - i >= fewest || follows || leads) {
      Curve curve;
      curve.convex = track.convex();
      if (follows) curve.follows = track.id;
      if (i == 0 && track.shed == 0) curve.front.why = track.begins;
      if (end == size) curve.back.why = track.ends;
      if (leads) curve.back.awaits = track.id;
      curve.points.reserve(end - i);
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

bool is_enough(const Curve& curve) {
  constexpr std::size_t kStrong = 5, kFair = 8, kWeak = 14, kWeakest = 30;
  constexpr std::size_t kFewWeak = 6, kFewWeakest = 10; // of what no arc explains
  Evidence evidence;
  std::size_t guided = 0;
  for (const CurvePoint& p : curve.points) {
    evidence.add(p.feature);
    guided += p.feature.guided ? 1 : 0;
  }
  const auto n = curve.points.size();
  if (2 * guided > n) return false;
  if (evidence.is_arc()) return false;
  if (evidence.is_sure()) return true;
  const double turning = evidence.turning();
  if (evidence.is_edge()) return n >= (turning < 14.0 ? kFewWeakest : turning < 20.0 ? kFewWeak : kStrong);
  return n >= (turning < 14.0 ? kWeakest : turning < 20.0 ? kWeak : turning < 30.0 ? kFair : kStrong);
}

Tip tip_of(const Curve& curve, bool back) {
  constexpr std::size_t kReach = 5;
  const std::size_t n = curve.points.size();
  const CurvePoint& p = back ? curve.points[n - 1] : curve.points[0];
  const std::size_t inner = std::min(n - 1, kReach);
  const CurvePoint& q = back ? curve.points[n - 1 - inner] : curve.points[inner];
  Tip t{p.s, p.w, p.c, p.s - q.s, p.c - q.c};
  const double length = std::hypot(t.ds, t.dc);
  if (length > 0.0) {
    t.ds /= length;
    t.dc /= length;
  }
  return t;
}

bool is_shorter(const Curve& curve, double limit) noexcept {
  double length = 0.0;
  for (std::size_t i = 1; i < curve.points.size() && length < limit; ++i) {
    const CurvePoint &a = curve.points[i - 1], &b = curve.points[i];
    length += std::hypot(b.s - a.s, b.w - a.w, b.c - a.c);
  }
  return length < limit;
}

} // namespace scansion
