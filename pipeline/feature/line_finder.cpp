// The order of work on each line.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line_finder.hpp"

#include "pipeline/feature/link/smoothing.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr std::uint32_t kSettleEvery = 16; // lines
constexpr std::size_t kFewestPoints = 3;   // of a stretch
constexpr std::size_t kSmoothLag = 4;      // points behind the newest whose place no longer changes
constexpr std::size_t kLeastShed = 256;    // points that a growing track hands over at once
constexpr std::size_t kKept = 64;          // and that it keeps at least: cones, fits and angles look back less
constexpr std::size_t kDecidedKept = 8;    // of these, decided ones: angles of the first open point look back four

} // namespace

void LineFinder::add(const Profile& profile, const Sampling& sampling, std::vector<Curve>& out) {
  if (!columns_) columns_.emplace(sampling, profile.scale);
  detector_.detect(profile, sampling, points_);
  const std::size_t first = ended_.size();
  tracker_.add(profile, static_cast<std::int64_t>(profile.line), points_, sampling, ended_);
  for (Track& track : tracker_.live()) {
    const std::size_t n = track.points.size();
    if (n > kSmoothLag) smooth(track, n - kSmoothLag - 1, n - kSmoothLag);
  }
  column_points_.clear();
  columns_->add(profile, sampling, column_points_);
  rows_.push_back(profile.c);
  if (profile.size() > 0) cuts_.see(profile.c, profile.s.front(), profile.s.back());
  if (rows_.size() > columns_->lag() + 1) rows_.erase(rows_.begin());
  const double harvested = rows_.size() > columns_->lag() ? rows_.front() : -std::numeric_limits<double>::infinity();
  crosswise_.add(column_points_, columns_->pitch(), harvested - 2.0 * sampling.spacing, sampling, ended_);
  smooth_ended(first);
  if (++since_settled_ < kSettleEvery) return;
  since_settled_ = 0;
  settle(harvested - 10.0 * sampling.coarse(), sampling, out);
}

// A leaning sheet does not see the foot of a wall that hides it: what it meets next is the edge of the shadow, and no feature.
void LineFinder::drop_hidden_feet(Track& track, std::size_t first, std::size_t last, const Sampling& sampling) const {
  for (std::size_t i = first; i < last; ++i) {
    TrackPoint& p = track.points[i];
    if (p.feature.drop <= 0.0 || p.feature.convex()) continue;
    if (p.feature.drop * lean_ * track.course_at(i).cosine() > 0.6 * sampling.coarse()) p.verdict = Verdict::dropped;
  }
}

// The points of a growing track that nothing will change any more go ahead as curves: an endless edge holds bounded memory.
void LineFinder::shed(Track& track, const Sampling& sampling) {
  const std::size_t size = track.points.size();
  if (size < kLeastShed + kKept) return;
  if (!track.confirmed) { // and may never be
    track.points.pop_front(size - kKept);
    return;
  }
  const auto open =
      std::find_if(track.points.begin(), track.points.end(), [](const TrackPoint& p) { return p.verdict == Verdict::open; });
  const auto decided = static_cast<std::size_t>(open - track.points.begin());
  if (decided < kLeastShed + kDecidedKept) return;
  const std::size_t count = std::min(decided - kDecidedKept, size - kKept);
  const bool worth = track.shed > 0 || is_confirmed(track, settings_.limits.least_turning);
  if (worth) {
    if (lean_ > 0.0) drop_hidden_feet(track, track.shed > 0 ? kDecidedKept : 0, count + kDecidedKept, sampling);
    cut_stretches(track, count, kFewestPoints, stretches_);
    track.shed += count;
    track.goes_on = track.points[count - 1].verdict == Verdict::kept && track.points[count].verdict == Verdict::kept;
  }
  track.points.pop_front(count);
}

void LineFinder::smooth_ended(std::size_t first) {
  constexpr std::size_t kReach = 3; // of smoothing; points whose forerunners were shed are smooth already
  for (std::size_t i = first; i < ended_.size(); ++i) {
    Track& track = ended_[i];
    const std::size_t n = track.points.size();
    // Lengthwise tracks are smoothed while they grow.
    const bool grew = track.pass == Pass::lengthwise && n > kSmoothLag;
    smooth(track, grew ? n - kSmoothLag : track.shed > 0 ? kReach : 0, n);
  }
}

void LineFinder::settle(double settled, const Sampling& sampling, std::vector<Curve>& out) {
  deciding_.clear();
  live_ends_.clear();
  for (Track& track : tracker_.live()) {
    if (!track.confirmed) continue;
    deciding_.push_back(&track);
    if (!track.goes_on)
      live_ends_.push_back({track.s_of(track.points.front()), track.c_of(track.points.front()), track.convex()});
  }
  for (Track& track : crosswise_.live()) {
    if (!is_confirmed(track, settings_.limits.least_turning)) continue;
    deciding_.push_back(&track);
    for (const TrackPoint* p : {&track.points.front(), &track.points.back()})
      live_ends_.push_back({track.s_of(*p), track.c_of(*p), track.convex()});
  }
  for (Track& track : ended_) deciding_.push_back(&track);
  union_.decide(deciding_, settled, sampling);
  cuts_.take(deciding_, settled, sampling);
  cuts_complete_ = cuts_.complete(settled, sampling);
  stretches_.clear();
  for (Track& track : tracker_.live()) shed(track, sampling);
  for (Track& track : ended_) {
    const bool decided =
        std::none_of(track.points.begin(), track.points.end(), [](const TrackPoint& p) { return p.verdict == Verdict::open; });
    if (!decided) {
      for (const TrackPoint* p : {&track.points.front(), &track.points.back()})
        live_ends_.push_back({track.s_of(*p), track.c_of(*p), track.convex()});
      continue;
    }
    if (lean_ > 0.0) drop_hidden_feet(track, track.shed > 0 ? kDecidedKept : 0, track.points.size(), sampling);
    cut_stretches(track, track.points.size(), kFewestPoints, stretches_);
    track.points.clear();
  }
  std::erase_if(ended_, [](const Track& t) { return t.points.empty(); });
  for (Curve& curve : stretches_) joiner_.take(std::move(curve));
  joiner_.advance(settled, live_ends_, sampling, out);
}

void LineFinder::finish(const Sampling& sampling, FeatureEnd reason, std::vector<Curve>& out) {
  const std::size_t first = ended_.size();
  tracker_.finish(reason, ended_);
  if (columns_) {
    column_points_.clear();
    columns_->finish(sampling, column_points_);
    crosswise_.add(column_points_, columns_->pitch(), -std::numeric_limits<double>::infinity(), sampling, ended_);
  }
  crosswise_.finish(ended_);
  smooth_ended(first);
  settle(std::numeric_limits<double>::infinity(), sampling, out);
  columns_.reset();
  rows_.clear();
  detector_ = Detector();
  tracker_ = Tracker(settings_);
  crosswise_ = CrosswiseLinker(settings_);
  union_ = Union();
  since_settled_ = 0;
}

} // namespace scansion
