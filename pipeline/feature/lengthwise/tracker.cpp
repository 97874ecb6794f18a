// One scan line after the other: links by ascending cost, then what was expected but not found, then births and mergers.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/lengthwise/tracker.hpp"

#include "pipeline/feature/fit/make_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scansion {

namespace {

constexpr std::uint32_t kMissedLines = 2; // K: lines a track may miss
constexpr double kReach = 1.6;            // spacings beyond them

TrackPoint track_point(const Profile& profile, std::int64_t step, const FeaturePoint& f) {
  TrackPoint p;
  p.r = profile.c;
  p.q = p.smooth_q = f.s;
  p.w = p.smooth_w = f.w;
  p.step = step;
  p.feature = f;
  p.feature.line = profile.line;
  p.feature.sample = profile.number(f.k);
  return p;
}

void append(Track& track, const TrackPoint& point, double least_turning) {
  track.points.push_back(point);
  track.means.follow(point.feature);
  track.misses = 0;
  track.guided_in_row = point.feature.guided ? track.guided_in_row + 1 : 0;
  if (!track.confirmed) track.confirmed = is_confirmed(track, least_turning);
}

std::uint32_t nearest_sample(const Profile& profile, double s) {
  const auto it = std::lower_bound(profile.s.begin(), profile.s.end(), s);
  auto k = static_cast<std::size_t>(it - profile.s.begin());
  if (k == profile.size() || (k > 0 && s - profile.s[k - 1] < profile.s[k] - s)) --k;
  return static_cast<std::uint32_t>(k);
}

} // namespace

void Tracker::find_links(const Profile& profile, const std::vector<FeaturePoint>& points, const Sampling& sampling) {
  links_.clear();
  expected_.clear();
  for (std::uint32_t t = 0; t < live_.size(); ++t) {
    const Track& track = live_[t];
    const TrackPoint& last = track.points.back();
    const Axis axis = axis_of(track, TrackEnd::back);
    const Expectation e = expect(axis, profile.c, sampling.pitch, sampling.noise, last.feature.sigma_s);
    expected_.push_back(e);
    auto it =
        std::lower_bound(points.begin(), points.end(), e.q - e.gate_q, [](const FeaturePoint& p, double s) { return p.s < s; });
    for (; it != points.end() && it->s <= e.q + e.gate_q; ++it)
      if (const auto cost = link_cost(track, last.feature, e, *it, it->s, it->w, linking_))
        links_.push_back({*cost, t, static_cast<std::uint32_t>(it - points.begin())});
  }
  std::sort(links_.begin(), links_.end(), [](const Link& a, const Link& b) {
    if (a.cost != b.cost) return a.cost < b.cost;
    return a.track != b.track ? a.track < b.track : a.point < b.point;
  });
}

void Tracker::take_links(const Profile& profile, std::int64_t step, const std::vector<FeaturePoint>& points) {
  point_of_.assign(live_.size(), -1);
  taken_.assign(points.size(), false);
  for (const Link& link : links_) {
    if (point_of_[link.track] >= 0 || taken_[link.point]) continue;
    point_of_[link.track] = static_cast<std::int32_t>(link.point);
    taken_[link.point] = true;
    append(live_[link.track], track_point(profile, step, points[link.point]), least_turning_);
  }
}

// The bend at the expected place, measured with the window of the track.
bool Tracker::guide(Track& track, const Expectation& expected, const Profile& profile, std::int64_t step,
                    const Sampling& sampling) const {
  constexpr std::size_t kOldEnough = 4;
  constexpr std::uint32_t kMostInRow = 8;
  constexpr double kMostShift = 2.5, kWeakest = 0.5;
  if (track.points.size() < kOldEnough || track.guided_in_row >= kMostInRow || profile.size() < 8) return false;
  const FeaturePoint& last = track.points.back().feature;
  if (last.step || last.smooth || last.window == 0) return false;
  const FitScale scale = FitScale::of(sampling.noise, sampling.pitch, sampling.coarse(), sampling.limits);
  double s = expected.q;
  Bend bend;
  std::uint32_t k = 0;
  for (int round = 0; round < 2; ++round) {
    if (s <= profile.s.front() || s >= profile.s.back()) return false;
    const std::uint32_t nearest = nearest_sample(profile, s);
    if (round > 0 && nearest == k) break; // as before
    k = nearest;
    if (std::abs(profile.s[k] - s) > 3.5 * sampling.pitch) return false;
    const auto run = std::upper_bound(profile.ends.begin(), profile.ends.end(), k);
    const std::uint32_t begin = run == profile.ends.begin() ? 0 : *(run - 1);
    if (k < begin + 3 || k + 3 >= *run) return false;
    const std::uint32_t window = last.window;
    bend = fit_bend({profile.s, profile.w}, k, k - begin > window ? k - window : begin, std::min(*run - 1, k + window), window,
                    scale);
    s = bend.s;
  }
  if (!bend.fitted || (bend.tau < 0.0) != track.convex()) return false;
  if (std::abs(bend.s - expected.q) > kMostShift * sampling.pitch) return false;
  if (std::abs(bend.tau) < kWeakest * std::abs(track.means.tau) || bend.significance() < kLeastSignificance) return false;
  if (std::abs(bend.w - expected.w) > 6.0 * sampling.noise + 0.6 * sampling.pitch) return false;
  FeaturePoint point = make_point(bend, k, scale);
  point.width = last.width;
  point.guided = true;
  point.narrow_sharpness = 0.0; // was not asked
  append(track, track_point(profile, step, point), least_turning_);
  return true;
}

void Tracker::end(Track& track, FeatureEnd reason, std::vector<Track>& ended) {
  track.cut_guided_end();
  track.ends = reason;
  track.growing = false;
  track.confirmed = track.shed > 0 || is_confirmed(track, least_turning_);
  if (track.confirmed)
    ended.push_back(std::exchange(track, {}));
  else
    track.points.clear();
}

void Tracker::miss(const Profile& profile, std::int64_t step, const Sampling& sampling, std::vector<Track>& ended) {
  const double low = profile.size() > 0 ? profile.s.front() : 0.0, high = profile.size() > 0 ? profile.s.back() : 0.0;
  for (std::size_t t = 0; t < point_of_.size(); ++t) {
    if (point_of_[t] >= 0) continue;
    Track& track = live_[t];
    if (linking_ == Linking::soft && guide(track, expected_[t], profile, step, sampling)) {
      point_of_[t] = 0;
      continue;
    }
    ++track.misses;
    const std::uint32_t limit = track.points.size() < 3 ? 1 : kMissedLines;
    const bool out_of_reach = profile.c - track.points.back().r > (kMissedLines + kReach) * sampling.spacing;
    if (track.misses <= limit && !out_of_reach) continue;
    const double place = expected_[t].q, edge = 4.0 * sampling.pitch;
    const bool at_border = profile.size() == 0 || place < low + edge || place > high - edge;
    end(track,
        out_of_reach && track.misses <= limit ? FeatureEnd::gap
        : at_border                           ? FeatureEnd::border
                                              : FeatureEnd::death,
        ended);
  }
}

void Tracker::bear(const Profile& profile, std::int64_t step, const std::vector<FeaturePoint>& points,
                   const Sampling& sampling) {
  constexpr double kTooNear = 2.0; // pitches
  // Places of tracks that were continued on this line, in order.
  const auto place = [&](std::uint32_t t) { return live_[t].points.back().q; };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (taken_[i]) continue;
    const double reach = kTooNear * sampling.pitch;
    auto it = std::lower_bound(order_.begin(), order_.end(), points[i].s - reach,
                               [&](std::uint32_t t, double s) { return place(t) < s; });
    bool near = false;
    for (; it != order_.end() && place(*it) <= points[i].s + reach; ++it)
      near = near || live_[*it].convex() == points[i].convex();
    if (near) continue;
    Track track;
    track.id = next_id_++;
    track.growing = true;
    track.points.push_back(track_point(profile, step, points[i]));
    track.means.start(points[i]);
    live_.push_back(std::move(track));
  }
}

void Tracker::merge(std::int64_t step, const Sampling& sampling, std::vector<Track>& ended) {
  constexpr double kBeside = 1.3; // pitches
  constexpr std::uint32_t kLines = 2;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    Track& a = live_[order_[i]];
    if (a.points.empty()) continue;
    for (std::size_t j = i + 1; j < order_.size(); ++j) {
      Track& b = live_[order_[j]];
      if (b.points.empty()) continue;
      if (b.points.back().q - a.points.back().q > kBeside * sampling.pitch) break;
      if (a.convex() != b.convex()) continue;
      const bool a_longer = a.size() != b.size() ? a.size() > b.size() : a.id < b.id;
      Track& shorter = a_longer ? b : a;
      const Track& longer = a_longer ? a : b;
      shorter.near_lines = shorter.near_id == longer.id ? shorter.near_lines + 1 : 1;
      shorter.near_id = longer.id;
      if (shorter.near_lines < kLines) continue;
      shorter.points.pop_back();
      if (!shorter.points.empty() && shorter.points.back().step + 1 == step) shorter.points.pop_back();
      if (shorter.points.empty()) continue;
      end(shorter, FeatureEnd::junction, ended);
      if (&shorter == &a) break;
    }
  }
}

void Tracker::add(const Profile& profile, std::int64_t step, const std::vector<FeaturePoint>& points, const Sampling& sampling,
                  std::vector<Track>& ended) {
  find_links(profile, points, sampling);
  take_links(profile, step, points);
  miss(profile, step, sampling, ended);
  order_.clear();
  for (std::uint32_t t = 0; t < live_.size(); ++t)
    if (!live_[t].points.empty() && live_[t].points.back().step == step) order_.push_back(t);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double qa = live_[a].points.back().q, qb = live_[b].points.back().q;
    return qa != qb ? qa < qb : a < b;
  });
  merge(step, sampling, ended);
  std::erase_if(order_, [&](std::uint32_t t) { return live_[t].points.empty(); });
  bear(profile, step, points, sampling);
  std::erase_if(live_, [](const Track& t) { return t.points.empty(); });
}

void Tracker::finish(FeatureEnd reason, std::vector<Track>& ended) {
  for (Track& track : live_) end(track, reason, ended);
  live_.clear();
}

} // namespace scansion
