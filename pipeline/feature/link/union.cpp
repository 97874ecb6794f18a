// Lengthwise tracks have steep stretches, crosswise tracks shallow ones; in between the lengthwise one goes first.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/link/union.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

// Tangents of angles to the scan lines. A lengthwise track is trusted alone above 40 degrees, and then down to 37: else an edge
// at about 40 falls to pieces between both passes.
constexpr double kSteep = 0.83909963, kStillSteep = 0.75355405;
constexpr double kShallow = 1.27994163;  // tan 52: a crosswise track above this is not
constexpr double kBeside = 1.3;          // pitches, spacings
constexpr double kShallowTurning = 10.0; // degrees: a lengthwise track below kSteep must turn more

// Points of a track are looked at in order.
template <typename Point>
void look_at_course(const Track& track, Point point) {
  const Course course = track.course_at(static_cast<std::size_t>(point - track.points.begin()));
  const bool first = point == track.points.begin();
  point->steep = course.is_steeper(!first && (point - 1)->steep ? kStillSteep : kSteep);
}

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
      if (pass == Pass::lengthwise && first->verdict == Verdict::open) look_at_course(*track, first);
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

bool Union::Cover::covers(const Near& place) {
  while (first_ < band_.size() && band_[first_].s < place.s - reach_s_) ++first_;
  for (std::size_t i = first_; i < band_.size() && band_[i].s <= place.s + reach_s_; ++i) {
    const Near& other = band_[i];
    if (std::abs(other.c - place.c) > reach_c_ || other.track == place.track) continue;
    if (other.point->verdict == Verdict::dropped || other.track->convex() != place.track->convex()) continue;
    if (outdoes(other, place)) return true;
  }
  return false;
}

bool Union::Cover::outdoes(const Near& other, const Near& place) const {
  if (by_ == By::any) return true;
  // A steep one will be dropped itself.
  if (by_ == By::shallow) return !other.track->course_at(other.index).is_steeper(kShallow);
  const std::size_t size = other.track->size(), own = place.track->size();
  return size > own || (size == own && other.track->id < place.track->id);
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
  Cover twins(lengthwise_, kBeside * sampling.pitch, 0.5 * sampling.spacing, Cover::By::longer);
  Cover flatter(crosswise_, reach, reach, Cover::By::shallow);
  for (const Near& n : lengthwise_) {
    if (n.point->verdict != Verdict::open || n.c > settled) continue;
    // The section of a rounding is so long here that its polygon shows.
    const bool weak = std::abs(n.point->feature.tau) < kShallowTurning;
    const bool drop = twins.covers(n) || (!n.point->steep && (weak || flatter.covers(n)));
    n.point->verdict = drop ? Verdict::dropped : Verdict::kept;
  }
  Cover side_twins(crosswise_, kBeside * sampling.pitch, kBeside * sampling.spacing, Cover::By::longer);
  Cover found(lengthwise_, reach, reach, Cover::By::any);
  for (const Near& n : crosswise_) {
    if (n.point->verdict != Verdict::open || n.c > settled) continue;
    const bool drop = n.track->course_at(n.index).is_steeper(kShallow) || side_twins.covers(n) || found.covers(n);
    n.point->verdict = drop ? Verdict::dropped : Verdict::kept;
  }
  decided_ = std::max(decided_, settled);
}

} // namespace scansion
