// Tracks along the lines.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/crosswise/crosswise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr std::int64_t kReachColumns = 3;                  // K + 1
constexpr double kUnsure = kGateSteps + 0.5 * kGateSigmas; // spacings: gate of an end known to half a spacing
constexpr double kNever = std::numeric_limits<double>::infinity();

TrackPoint track_point(const ColumnPoint& p) {
  TrackPoint t;
  t.r = p.s;
  t.q = t.smooth_q = p.feature.s;
  t.w = t.smooth_w = p.feature.w;
  t.step = p.column;
  t.feature = p.feature;
  return t;
}

// The first point of a track at a column or beyond it.
TrackPoint* at_or_beyond(Track& track, std::int64_t column) {
  return std::lower_bound(track.points.begin(), track.points.end(), column,
                          [](const TrackPoint& p, std::int64_t c) { return p.step < c; });
}

std::size_t index_of(TrackEnd end) noexcept {
  return static_cast<std::size_t>(end);
}

} // namespace

const Axis& CrosswiseLinker::axis(std::uint32_t track, TrackEnd end) {
  Ends& ends = ends_[track];
  if (!ends.known[index_of(end)]) {
    ends.axes[index_of(end)] = axis_of(live_[track], end);
    ends.known[index_of(end)] = true;
  }
  return ends.axes[index_of(end)];
}

CrosswiseLinker::Choice CrosswiseLinker::best_end(const ColumnPoint& point, TrackEnd end, const Sampling& sampling) {
  Choice best;
  for (std::int64_t d = 1; d <= kReachColumns; ++d) {
    const auto look = [&](std::uint32_t t) {
      const Track& track = live_[t];
      if (track.convex() != point.feature.convex()) return;
      const TrackPoint& last = end == TrackEnd::back ? track.points.back() : track.points.front();
      const Expectation e = expect(axis(t, end), point.s, sampling.spacing, sampling.noise, last.feature.sigma_s);
      const auto cost = link_cost(track, last.feature, e, point.feature, point.feature.s, point.feature.w, linking_);
      if (!cost) return;
      // Nearer columns first: a track that already has a point there is the better one to continue.
      const double full = *cost + 0.2 * static_cast<double>(d - 1);
      if (!best.found || full < best.cost || (full == best.cost && track.id < live_[best.track].id)) best = {t, full, true};
    };
    if (end == TrackEnd::back)
      backs_.visit(point.column - d, look);
    else
      fronts_.visit(point.column + d, look);
  }
  return best;
}

// Rows come one after the other, so a point of a line aslant may come after those of the columns beside it.
CrosswiseLinker::Choice CrosswiseLinker::best_gap(const ColumnPoint& point, const Sampling& sampling) {
  Choice best;
  gaps_.visit(point.column, [&](std::uint32_t t) {
    Track& track = live_[t];
    if (track.convex() != point.feature.convex()) return;
    const TrackPoint* const behind = at_or_beyond(track, point.column);
    const TrackPoint& before = behind[-1];
    if (before.verdict != Verdict::open || behind->verdict != Verdict::open) return;
    const double dr = behind->r - before.r;
    const Axis way{before.q, before.w, before.r, (behind->q - before.q) / dr, (behind->w - before.w) / dr, 0.0};
    const double sigma = std::max(before.feature.sigma_s, behind->feature.sigma_s);
    const Expectation e = expect(way, point.s, sampling.spacing, sampling.noise, sigma);
    const auto cost = link_cost(track, before.feature, e, point.feature, point.feature.s, point.feature.w, linking_);
    if (!cost) return;
    if (!best.found || *cost < best.cost || (*cost == best.cost && track.id < live_[best.track].id)) best = {t, *cost, true};
  });
  return best;
}

void CrosswiseLinker::insert(std::uint32_t track, const ColumnPoint& point) {
  Track& t = live_[track];
  t.points.insert(at_or_beyond(t, point.column), track_point(point));
  t.means.follow(point.feature);
  ends_[track].known = {};
  gaps_.take(track, point.column);
}

// The axis at the other end looks at some of the same points while the track is short.
void CrosswiseLinker::note_growth(std::uint32_t track, TrackEnd end) {
  const Track& t = live_[track];
  Ends& ends = ends_[track];
  ends.known[index_of(end)] = false;
  if (t.points.size() <= kAxisPoints) ends.known = {};
  if (end == TrackEnd::front)
    fronts_.put(track, t.points.front().step);
  else
    backs_.put(track, t.points.back().step);
  latest_[track] = std::max(t.points.front().q, t.points.back().q);
}

void CrosswiseLinker::bear(const ColumnPoint& point) {
  std::uint32_t at = 0;
  if (vacant_.empty()) {
    at = static_cast<std::uint32_t>(live_.size());
    live_.emplace_back();
    ends_.emplace_back();
    latest_.push_back(kNever);
  } else {
    at = vacant_.back();
    vacant_.pop_back();
  }
  Track track;
  track.id = next_id_++;
  track.pass = Pass::crosswise;
  track.means.start(point.feature);
  track.points = std::move(live_[at].points); // for their room
  track.points.push_back(track_point(point));
  live_[at] = std::move(track);
  note_growth(at, TrackEnd::front);
  note_growth(at, TrackEnd::back);
}

void CrosswiseLinker::extend(std::uint32_t track, TrackEnd end, const ColumnPoint& point) {
  Track& t = live_[track];
  const std::int64_t last = end == TrackEnd::front ? t.points.front().step : t.points.back().step;
  for (std::int64_t c = std::min(last, point.column) + 1; c < std::max(last, point.column); ++c) gaps_.put(track, c);
  if (end == TrackEnd::front)
    t.points.push_front(track_point(point));
  else
    t.points.push_back(track_point(point));
  t.means.follow(point.feature);
  note_growth(track, end);
}

void CrosswiseLinker::join(std::uint32_t into, std::uint32_t from) {
  for (std::int64_t c = live_[into].points.back().step + 1; c < live_[from].points.front().step; ++c) gaps_.put(into, c);
  live_[into].points.append(live_[from].points);
  gaps_.hand_over(from, into);
  vacate(from);
  note_growth(into, TrackEnd::back);
}

void CrosswiseLinker::place(const ColumnPoint& point, const Sampling& sampling) {
  if (const Choice gap = best_gap(point, sampling); gap.found) return insert(gap.track, point);
  const Choice left = best_end(point, TrackEnd::back, sampling);
  const Choice right = best_end(point, TrackEnd::front, sampling);
  if (left.found && right.found && left.track != right.track) {
    extend(left.track, TrackEnd::back, point);
    join(left.track, right.track);
  } else if (left.found && (!right.found || left.cost <= right.cost)) {
    extend(left.track, TrackEnd::back, point);
  } else if (right.found) {
    extend(right.track, TrackEnd::front, point);
  } else {
    bear(point);
  }
}

void CrosswiseLinker::vacate(std::uint32_t track) {
  live_[track].points.clear();
  fronts_.take(track);
  backs_.take(track);
  gaps_.take_all(track);
  latest_[track] = kNever;
  vacant_.push_back(track);
}

// In the order in which they began.
void CrosswiseLinker::end(std::span<std::uint32_t> tracks, std::vector<Track>& ended) {
  std::sort(tracks.begin(), tracks.end(), [&](std::uint32_t a, std::uint32_t b) { return live_[a].id < live_[b].id; });
  for (const std::uint32_t t : tracks) {
    live_[t].confirmed = is_confirmed(live_[t], least_turning_);
    if (live_[t].confirmed) ended.push_back(std::move(live_[t]));
    vacate(t);
  }
}

// As far as either end expects a point in the last column of its reach, with the part of the gate that grows on the way.
double CrosswiseLinker::latest_of(std::uint32_t track, double pitch) {
  const double way = static_cast<double>(kReachColumns) * pitch;
  double latest = -kNever;
  for (const TrackEnd side : {TrackEnd::front, TrackEnd::back}) {
    const Axis& a = axis(track, side);
    const double turn = a.slope_q * (side == TrackEnd::back ? way : -way);
    latest = std::max(latest, a.q + std::max(0.0, turn) + way * a.widening);
  }
  return latest;
}

void CrosswiseLinker::retire(double settled, double pitch, const Sampling& sampling, std::vector<Track>& ended) {
  const double limit = settled - kUnsure * sampling.spacing;
  ending_.clear();
  for (std::uint32_t t = 0; t < latest_.size(); ++t) {
    if (latest_[t] >= limit) continue;
    latest_[t] = latest_of(t, pitch);
    if (latest_[t] < limit) ending_.push_back(t);
  }
  end(ending_, ended);
}

void CrosswiseLinker::add(const std::vector<ColumnPoint>& points, double pitch, double settled, const Sampling& sampling,
                          std::vector<Track>& ended) {
  for (const ColumnPoint& point : points) place(point, sampling);
  retire(settled, pitch, sampling, ended);
}

void CrosswiseLinker::finish(std::vector<Track>& ended) {
  ending_.clear();
  for (std::uint32_t t = 0; t < live_.size(); ++t)
    if (!live_[t].points.empty()) ending_.push_back(t);
  end(ending_, ended);
}

} // namespace scansion
