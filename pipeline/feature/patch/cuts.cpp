// From tracks to cut samples.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/cuts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace scansion {

namespace {

constexpr double kReach = 4.0;    // coarse steps: how far an end looks for another line, and how far it is made longer
constexpr double kAhead = 12.0;   // coarse steps: how far it looks straight on, as in the tip of a wedge
constexpr double kJoined = 2.0;   // how far beyond, once it found one
constexpr double kSideways = 1.6; // the cost of not going straight on

BorderKind kind_of(const FeaturePoint& f) {
  if (f.step) return BorderKind::step;
  return f.convex() ? BorderKind::convex : BorderKind::concave;
}

// A smooth crest lies inside a patch; of a step's edges, which coincide in plan, one is enough.
bool cuts(const TrackPoint& p) {
  return p.verdict == Verdict::kept && !p.feature.smooth && !(p.feature.step && !p.feature.convex());
}

// Cuts of one column in one number, in the order in which one of them is chosen: what feature lines back comes first, then by
// kind, so that it does not matter in which order lines were found.
constexpr std::int64_t kCodes = 8; // two bits of the kind, one for being backed

std::int64_t code_of(const CutSegment& g) noexcept {
  return (g.backed ? 0 : kCodes / 2) + static_cast<std::int64_t>(g.kind);
}

Cut cut_of(std::int64_t key, double pitch) noexcept {
  const std::int64_t column = key >> 3U, code = key & (kCodes - 1);
  return {static_cast<double>(column) * pitch, column, static_cast<BorderKind>(code & 3), code < kCodes / 2};
}

} // namespace

void Cuts::add(double s0, double c0, double s1, double c1, BorderKind kind, bool backed, std::uint64_t track) {
  if (c1 < c0) {
    std::swap(s0, s1);
    std::swap(c0, c1);
  }
  made_.push_back({{s0, c0, s1, c1, kind, backed}, track});
}

void Cuts::take_track(const Track& track, double settled) {
  const std::uint64_t id = track.id | (track.pass == Pass::crosswise ? Track::kCrosswiseBit : 0U);
  const std::size_t n = track.points.size();
  std::size_t first = 0;
  if (track.pass == Pass::lengthwise) { // points stand in order of c: what was taken before is behind
    const auto next = std::upper_bound(track.points.begin(), track.points.end(), taken_,
                                       [](double c, const TrackPoint& p) { return c < p.r; });
    first = static_cast<std::size_t>(next - track.points.begin());
    if (first > 0) --first;
  }
  for (std::size_t i = first; i < n; ++i) {
    const TrackPoint& p = track.points[i];
    if (!cuts(p)) continue;
    const double s = track.s_of(p), c = track.c_of(p);
    if (i + 1 < n && cuts(track.points[i + 1])) {
      const TrackPoint& q = track.points[i + 1];
      const double later = std::max(c, track.c_of(q));
      if (later > taken_ && later <= settled) add(s, c, track.s_of(q), track.c_of(q), kind_of(p.feature), true, id);
    }
    if (c <= taken_ || c > settled) continue;
    const auto push_end = [&](bool back) {
      const auto from = [&](std::size_t points) {
        const TrackPoint& inner = track.points[back ? i - std::min(i, points) : std::min(n - 1, i + points)];
        const double ds = s - track.s_of(inner), dc = c - track.c_of(inner), length = std::hypot(ds, dc);
        return length > 0.0 ? PlanDirection{ds / length, dc / length} : PlanDirection{};
      };
      const PlanDirection on = from(4);
      if (on.ds != 0.0 || on.dc != 0.0) ends_.push_back({s, c, on, from(16), kind_of(p.feature), id});
    };
    if (i == 0 || !cuts(track.points[i - 1])) push_end(false);
    if (i + 1 == n ? !track.growing : !cuts(track.points[i + 1])) push_end(true);
  }
}

// What may lie within `reach` of the ends.
void Cuts::find_targets(std::span<const End> ends, double reach) {
  targets_.clear();
  widest_ = 0.0;
  if (ends.empty()) return;
  const auto outer = std::minmax_element(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.c < b.c; });
  const double low_c = outer.first->c - reach, high_c = outer.second->c + reach;
  const auto look = [&](const Owned& owned) {
    const CutSegment& g = owned.segment;
    if (!g.backed || g.c1 < low_c || g.c0 > high_c) return;
    const double low = std::min(g.s0, g.s1);
    targets_.push_back({low, &owned});
    widest_ = std::max(widest_, std::max(g.s0, g.s1) - low);
  };
  for (std::size_t i = next_; i < coming_.size() && coming_[i].segment.c0 <= high_c; ++i) look(coming_[i]);
  for (const Owned& owned : passing_) look(owned);
  std::sort(targets_.begin(), targets_.end(), [](const Target& a, const Target& b) { return a.low_s < b.low_s; });
}

std::span<const Cuts::Target> Cuts::targets_near(double s, double reach) const {
  const auto first = std::lower_bound(targets_.begin(), targets_.end(), s - reach - widest_,
                                      [](const Target& t, double low) { return t.low_s < low; });
  const auto last =
      std::upper_bound(first, targets_.end(), s + reach, [](double high, const Target& t) { return high < t.low_s; });
  return {first, last};
}

// How far to go straight on: to the line that lies ahead, and a little beyond.
double Cuts::ahead_of(const End& end, double u) const {
  double nearest = kAhead * u;
  bool met = false;
  for (const Target& target : targets_near(end.s, nearest)) {
    const CutSegment& g = target.owned->segment;
    if (target.owned->track == end.track) continue;
    if (g.c1 < end.c - nearest || g.c0 > end.c + nearest) continue;
    const double ls = g.s1 - g.s0, lc = g.c1 - g.c0;
    const double across = end.on.ds * lc - end.on.dc * ls;
    if (std::abs(across) < 1e-12) continue;
    const double t = ((g.s0 - end.s) * lc - (g.c0 - end.c) * ls) / across;
    const double along = ((g.s0 - end.s) * end.on.dc - (g.c0 - end.c) * end.on.ds) / across;
    if (t <= 0.0 || t >= nearest || along < 0.0 || along > 1.0) continue;
    nearest = t;
    met = true;
  }
  return met ? nearest + 0.5 * u : kReach * u;
}

// Columns show nothing beside the first and the last scan line, nor lines beside their ends. What ends there goes on over the
// border, however flat it runs out; 0: it does not.
double Cuts::way_out(const End& end, const Sampling& sampling) const noexcept {
  constexpr double kBlind = 6.0; // spacings, or pitches
  constexpr double kMost = 20.0; // coarse steps
  const double most = kMost * sampling.coarse();
  const auto way = [&](double room, double step, double share) {
    if (share == 0.0 || room > kBlind * step) return 0.0;
    const double on = (std::max(0.0, room) + 0.5 * step) / std::abs(share);
    return on <= most ? on : 0.0;
  };
  if (lines_.empty()) return 0.0;
  const auto [ds, dc] = end.course;
  const double across = way(dc < 0.0 ? end.c - first_c_ : lines_.back().c - end.c, sampling.spacing, dc);
  const auto line =
      std::lower_bound(lines_.begin(), lines_.end() - 1, end.c, [](const LineExtent& l, double c) { return l.c < c; });
  const double along = way(ds < 0.0 ? end.s - line->low : line->high - end.s, sampling.pitch, ds);
  return across == 0.0 || along == 0.0 ? across + along : std::min(across, along);
}

void Cuts::extend(const End& end, const Sampling& sampling) {
  const double u = sampling.coarse(), reach = kReach * u;
  double best = std::numeric_limits<double>::infinity(), best_s = 0.0, best_c = 0.0;
  for (const Target& target : targets_near(end.s, reach)) {
    if (target.owned->track == end.track) continue;
    const CutSegment& g = target.owned->segment;
    if (g.c1 < end.c - reach || g.c0 > end.c + reach || std::max(g.s0, g.s1) < end.s - reach ||
        std::min(g.s0, g.s1) > end.s + reach)
      continue;
    // The nearest place of the segment.
    const double ls = g.s1 - g.s0, lc = g.c1 - g.c0;
    const double square = ls * ls + lc * lc;
    const double t = square > 0.0 ? std::clamp(((end.s - g.s0) * ls + (end.c - g.c0) * lc) / square, 0.0, 1.0) : 0.0;
    const double s = g.s0 + t * ls, c = g.c0 + t * lc;
    const double gap = std::sqrt((s - end.s) * (s - end.s) + (c - end.c) * (c - end.c));
    if (gap > reach) continue;
    const double ahead = (s - end.s) * end.on.ds + (c - end.c) * end.on.dc;
    if (gap > 0.5 * u && ahead < 0.0) continue;
    const double cost = gap * (ahead > 0.7 * gap ? 1.0 : kSideways);
    if (cost < best) {
      best = cost;
      best_s = s;
      best_c = c;
    }
  }
  const bool joined = best < std::numeric_limits<double>::infinity();
  if (joined) add(end.s, end.c, best_s, best_c, end.kind, false, end.track);
  const auto go = [&](const PlanDirection& way, double on) {
    add(end.s, end.c, end.s + on * way.ds, end.c + on * way.dc, end.kind, false, end.track);
  };
  go(end.on, joined ? kJoined * u : ahead_of(end, u));
  if (const double out = joined ? 0.0 : way_out(end, sampling); out > 0.0) go(end.course, out);
}

// What was made falls in with what is coming; most of it comes last.
void Cuts::keep() {
  if (made_.empty()) return;
  const auto is_before = [](const Owned& a, const Owned& b) { return a.segment.c0 < b.segment.c0; };
  std::sort(made_.begin(), made_.end(), is_before);
  const auto later =
      std::upper_bound(coming_.begin() + static_cast<std::ptrdiff_t>(next_), coming_.end(), made_.front(), is_before);
  merged_.clear();
  std::merge(later, coming_.end(), made_.begin(), made_.end(), std::back_inserter(merged_), is_before);
  coming_.erase(later, coming_.end());
  coming_.insert(coming_.end(), merged_.begin(), merged_.end());
  made_.clear();
}

void Cuts::take(std::span<Track* const> tracks, double settled, const Sampling& sampling) {
  for (const Track* track : tracks)
    if (!track->points.empty()) take_track(*track, settled);
  keep();
  taken_ = settled;
  const double reach = kAhead * sampling.coarse();
  const auto ready = std::stable_partition(ends_.begin(), ends_.end(), [&](const End& e) { return e.c > settled - reach; });
  find_targets({ready, ends_.end()}, reach);
  for (auto it = ready; it != ends_.end(); ++it) extend(*it, sampling);
  ends_.erase(ready, ends_.end());
  keep();
  while (lines_.size() > 1 && lines_.front().c < settled - 2.0 * reach) lines_.pop_front();
}

double Cuts::complete(double settled, const Sampling& sampling) const noexcept {
  return settled - 2.0 * kAhead * sampling.coarse() - sampling.spacing;
}

void Cuts::at(double last_c, double c, double pitch, std::vector<Cut>& in_line, std::vector<Cut>& across) {
  in_line.clear();
  across.clear();
  keys_.clear();
  for (; next_ < coming_.size() && coming_[next_].segment.c0 <= c; ++next_) passing_.push_back(coming_[next_]);
  if (2 * next_ > coming_.size()) {
    coming_.erase(coming_.begin(), coming_.begin() + static_cast<std::ptrdiff_t>(next_));
    next_ = 0;
  }
  for (const Owned& owned : passing_) {
    const CutSegment& g = owned.segment;
    if (g.c1 < last_c) continue;
    const double run = g.c1 - g.c0;
    const auto place = [&](double at) { return run > 0.0 ? g.s0 + (g.s1 - g.s0) * (at - g.c0) / run : g.s0; };
    if (g.c0 <= c && c < g.c1) in_line.push_back({place(c), 0, g.kind, g.backed});
    // The part between the lines, without its lower end.
    const double low = std::max(g.c0, last_c), high = std::min(g.c1, c);
    double from = run > 0.0 ? place(low) : g.s0, to = run > 0.0 ? place(high) : g.s1;
    if (run <= 0.0 && !(g.c0 > last_c && g.c0 <= c)) continue;
    if (to < from) std::swap(from, to);
    for (auto j = static_cast<std::int64_t>(std::ceil(from / pitch)); static_cast<double>(j) * pitch <= to; ++j)
      keys_.push_back(j * kCodes + code_of(g));
  }
  // Nothing is asked for below c again; ends still look a little behind them.
  std::erase_if(passing_, [&](const Owned& o) { return o.segment.c1 < last_c; });
  std::sort(in_line.begin(), in_line.end(), [](const Cut& a, const Cut& b) {
    if (a.s != b.s) return a.s < b.s;
    return a.backed != b.backed ? a.backed : a.kind < b.kind;
  });
  std::sort(keys_.begin(), keys_.end());
  for (const std::int64_t key : keys_)
    if (across.empty() || across.back().column != key >> 3U) across.push_back(cut_of(key, pitch));
}

} // namespace scansion
