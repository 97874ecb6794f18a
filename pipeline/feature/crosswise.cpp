// Tracks along the lines.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/crosswise.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr std::int64_t kReachColumns = 3; // K + 1

TrackPoint track_point(const ColumnPoint& p) {
  TrackPoint t;
  t.r = p.s;
  t.q = t.smooth_q = p.feature.s;
  t.w = t.smooth_w = p.feature.w;
  t.step = p.column;
  t.feature = p.feature;
  return t;
}

} // namespace

void CrosswiseLinker::index(std::size_t track, TrackEnd end) {
  const Track& t = live_[track];
  if (end == TrackEnd::front)
    fronts_[t.points.front().step].push_back(track);
  else
    backs_[t.points.back().step].push_back(track);
}

void CrosswiseLinker::rebuild_index() {
  for (auto* map : {&fronts_, &backs_})
    for (auto& [column, tracks] : *map) tracks.clear();
  for (std::size_t t = 0; t < live_.size(); ++t) {
    index(t, TrackEnd::front);
    index(t, TrackEnd::back);
  }
}

CrosswiseLinker::Choice CrosswiseLinker::best_end(const ColumnPoint& point, TrackEnd end, const Sampling& sampling) {
  Choice best;
  for (std::int64_t d = 1; d <= kReachColumns; ++d) {
    auto& map = end == TrackEnd::back ? backs_ : fronts_;
    const std::int64_t column = end == TrackEnd::back ? point.column - d : point.column + d;
    const auto found = map.find(column);
    if (found == map.end()) continue;
    for (const std::size_t t : found->second) {
      const Track& track = live_[t];
      if (track.points.empty()) continue;
      const TrackPoint& last = end == TrackEnd::back ? track.points.back() : track.points.front();
      if (last.step != column) continue;
      const Expectation e = expect(axis_of(track, end), point.s, sampling.spacing, sampling.noise, last.feature.sigma_s);
      const auto cost = link_cost(track, last.feature, e, point.feature, point.feature.s, point.feature.w, linking_);
      if (!cost) continue;
      // Nearer columns first: a track that already has a point there is the better one to continue.
      const double full = *cost + 0.2 * static_cast<double>(d - 1);
      if (!best.found || full < best.cost || (full == best.cost && track.id < live_[best.track].id)) best = {t, full, true};
    }
  }
  return best;
}

void CrosswiseLinker::join(std::size_t into, std::size_t from) {
  Track& a = live_[into];
  Track& b = live_[from];
  for (const TrackPoint& p : b.points) a.points.push_back(p);
  b.points.clear();
  index(into, TrackEnd::back);
}

void CrosswiseLinker::place(const ColumnPoint& point, const Sampling& sampling) {
  const Choice left = best_end(point, TrackEnd::back, sampling);
  const Choice right = best_end(point, TrackEnd::front, sampling);
  if (left.found && right.found && left.track != right.track) {
    live_[left.track].points.push_back(track_point(point));
    live_[left.track].means.follow(point.feature);
    join(left.track, right.track);
  } else if (left.found && (!right.found || left.cost <= right.cost)) {
    live_[left.track].points.push_back(track_point(point));
    live_[left.track].means.follow(point.feature);
    index(left.track, TrackEnd::back);
  } else if (right.found) {
    live_[right.track].points.push_front(track_point(point));
    live_[right.track].means.follow(point.feature);
    index(right.track, TrackEnd::front);
  } else {
    Track track;
    track.id = next_id_++;
    track.pass = Pass::crosswise;
    track.points.push_back(track_point(point));
    track.means.start(point.feature);
    live_.push_back(std::move(track));
    index(live_.size() - 1, TrackEnd::front);
    index(live_.size() - 1, TrackEnd::back);
  }
}

void CrosswiseLinker::end(Track& track, std::vector<Track>& ended) {
  track.confirmed = is_confirmed(track);
  if (track.confirmed) ended.push_back(std::move(track));
  track.points.clear();
}

void CrosswiseLinker::retire(double settled, double pitch, const Sampling& sampling, std::vector<Track>& ended) {
  bool any = false;
  for (Track& track : live_) {
    if (track.points.empty()) continue;
    double latest = track.points.front().q;
    for (const TrackEnd side : {TrackEnd::front, TrackEnd::back}) {
      const Axis axis = axis_of(track, side);
      const double r = axis.r + (side == TrackEnd::back ? 1.0 : -1.0) * static_cast<double>(kReachColumns) * pitch;
      const Expectation e = expect(axis, r, sampling.spacing, sampling.noise, 0.5 * sampling.spacing);
      latest = std::max({latest, e.q + e.gate_q, axis.q + e.gate_q});
    }
    if (latest >= settled) continue;
    end(track, ended);
    any = true;
  }
  if (!any) return;
  // The index passes over tracks that ended; it is made anew when they are many.
  constexpr std::ptrdiff_t kMany = 32;
  const auto ended_ones = std::count_if(live_.begin(), live_.end(), [](const Track& t) { return t.points.empty(); });
  if (ended_ones < kMany && 4 * ended_ones < static_cast<std::ptrdiff_t>(live_.size())) return;
  std::erase_if(live_, [](const Track& t) { return t.points.empty(); });
  rebuild_index();
}

void CrosswiseLinker::add(const std::vector<ColumnPoint>& points, double pitch, double settled, const Sampling& sampling,
                          std::vector<Track>& ended) {
  for (const ColumnPoint& point : points) place(point, sampling);
  retire(settled, pitch, sampling, ended);
}

void CrosswiseLinker::finish(std::vector<Track>& ended) {
  for (Track& track : live_)
    if (!track.points.empty()) end(track, ended);
  live_.clear();
  fronts_.clear();
  backs_.clear();
}

} // namespace scansion
