// Lengthwise tracks have steep stretches, crosswise tracks shallow ones; in between the lengthwise one goes first.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/union.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr double kSteep = 0.83909963;    // tan 40 degrees to the scan lines: a lengthwise track above this is trusted alone
constexpr double kShallow = 1.27994163;  // tan 52: a crosswise track above this is not
constexpr double kBeside = 1.3;          // pitches, spacings
constexpr double kShallowTurning = 10.0; // degrees: a lengthwise track below kSteep must turn more

} // namespace

void Union::gather(std::span<Track* const> tracks, Pass pass, double low, double high, Band& out) const {
  out.clear();
  for (Track* track : tracks) {
    if (track->pass != pass || track->points.empty()) continue;
    if (pass == Pass::lengthwise && (track->points.back().r < low || track->points.front().r > high)) continue;
    auto first = track->points.begin();
    auto last = track->points.end();
    if (pass == Pass::lengthwise) {
      first = std::lower_bound(first, last, low, [](const TrackPoint& p, double c) { return p.r < c; });
      last = std::upper_bound(first, last, high, [](double c, const TrackPoint& p) { return c < p.r; });
    }
    for (; first != last; ++first) {
      const double c = track->c_of(*first);
      if (c < low || c > high) continue;
      out.push_back({track->s_of(*first), c, track, &*first, static_cast<std::size_t>(first - track->points.begin())});
    }
  }
  std::sort(out.begin(), out.end(), [](const Near& a, const Near& b) {
    if (a.s != b.s) return a.s < b.s;
    return a.c != b.c ? a.c < b.c : a.track->id < b.track->id;
  });
}

// Whether a kept point of another track of the same polarity stands near.
bool Union::is_covered(const Band& band, const Near& place, double reach_s, double reach_c, By by) {
  auto it = std::lower_bound(band.begin(), band.end(), place.s - reach_s, [](const Near& n, double s) { return n.s < s; });
  for (; it != band.end() && it->s <= place.s + reach_s; ++it) {
    if (it->track == place.track || std::abs(it->c - place.c) > reach_c || it->point->verdict == Verdict::dropped) continue;
    if (it->track->convex() != place.track->convex()) continue;
    if (by == By::any) return true;
    if (by == By::shallow) {
      // A steep one will be dropped itself.
      if (!it->track->course_at(it->index).is_steeper(kShallow)) return true;
      continue;
    }
    const std::size_t other = it->track->size(), own = place.track->size();
    if (other > own || (other == own && it->track->id < place.track->id)) return true;
  }
  return false;
}

void Union::decide(std::span<Track* const> tracks, double settled, const Sampling& sampling) {
  const double reach = kBeside * sampling.coarse();
  // A track that was confirmed late brings points from before the last decision.
  double low = decided_;
  for (const Track* track : tracks)
    for (const TrackPoint& p : track->points)
      if (p.verdict == Verdict::open) low = std::min(low, track->c_of(p));
  low -= 2.0 * reach;
  const double high = settled + 2.0 * reach;
  gather(tracks, Pass::lengthwise, low, high, lengthwise_);
  gather(tracks, Pass::crosswise, low, high, crosswise_);
  for (const Near& n : lengthwise_) {
    if (n.point->verdict != Verdict::open || n.c > settled) continue;
    const bool steep = n.track->course_at(n.index).is_steeper(kSteep);
    const bool twin = is_covered(lengthwise_, n, kBeside * sampling.pitch, 0.5 * sampling.spacing, By::longer);
    // The section of a rounding is so long here that its polygon shows.
    const bool weak = std::abs(n.point->feature.tau) < kShallowTurning;
    const bool drop = twin || (!steep && (weak || is_covered(crosswise_, n, reach, reach, By::shallow)));
    n.point->verdict = drop ? Verdict::dropped : Verdict::kept;
  }
  for (const Near& n : crosswise_) {
    if (n.point->verdict != Verdict::open || n.c > settled) continue;
    const bool steep = n.track->course_at(n.index).is_steeper(kShallow);
    const bool twin = is_covered(crosswise_, n, kBeside * sampling.pitch, kBeside * sampling.spacing, By::longer);
    const bool drop = steep || twin || is_covered(lengthwise_, n, reach, reach, By::any);
    n.point->verdict = drop ? Verdict::dropped : Verdict::kept;
  }
  decided_ = std::max(decided_, settled);
}

} // namespace scansion
