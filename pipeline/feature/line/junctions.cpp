// Ends against straight pieces, in plan and height.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/junctions.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace scansion {

namespace {

constexpr double kReach = 4.0;  // coarse steps from an end to the line it runs into
constexpr double kAhead = 0.5;  // cosine: and it must lead there
constexpr double kBeside = 3.0; // coarse steps between the edges of a step, in plan
constexpr double kBorder = 4.0; // steps: nothing is found nearer to the ends of a line

bool is_step(const Curve& curve) {
  const auto steps = std::count_if(curve.points.begin(), curve.points.end(), [](const CurvePoint& p) {
    return p.feature.type == FeatureType::step_top || p.feature.type == FeatureType::step_bottom;
  });
  return 2 * static_cast<std::size_t>(steps) > curve.points.size();
}

struct Foot {
  double s = 0.0, w = 0.0, c = 0.0, gap = 0.0; // gap in plan
};

/// The place of a straight piece that is nearest in plan.
Foot foot_of(double s, double c, const std::array<double, 3>& from, const std::array<double, 3>& to) {
  const double ls = to[0] - from[0], lw = to[1] - from[1], lc = to[2] - from[2];
  const double square = ls * ls + lc * lc;
  const double t = square > 0.0 ? std::clamp(((s - from[0]) * ls + (c - from[2]) * lc) / square, 0.0, 1.0) : 0.0;
  Foot foot{from[0] + t * ls, from[1] + t * lw, from[2] + t * lc, 0.0};
  foot.gap = std::sqrt((foot.s - s) * (foot.s - s) + (foot.c - c) * (foot.c - c));
  return foot;
}

Box box_of(const std::array<double, 3>& from, const std::array<double, 3>& to) noexcept {
  Box box;
  box.add(from[0], from[2]);
  box.add(to[0], to[2]);
  return box;
}

/// How far an end is from a line that it runs into; below 0 when it does not.
double gap_to(const Tip& tip, const std::array<double, 3>& from, const std::array<double, 3>& to, const Sampling& sampling) {
  constexpr double kNo = -1.0;
  const double u = sampling.coarse(), reach = kReach * u;
  if (std::max(from[2], to[2]) < tip.c - reach || std::min(from[2], to[2]) > tip.c + reach ||
      std::max(from[0], to[0]) < tip.s - reach || std::min(from[0], to[0]) > tip.s + reach)
    return kNo;
  const Foot foot = foot_of(tip.s, tip.c, from, to);
  if (foot.gap > reach || std::abs(foot.w - tip.w) > 1.5 * foot.gap + 2.0 * u + 6.0 * sampling.noise) return kNo;
  const double ahead = (foot.s - tip.s) * tip.ds + (foot.c - tip.c) * tip.dc;
  return foot.gap > 0.5 * u && ahead < kAhead * foot.gap ? kNo : foot.gap;
}

} // namespace

void Junctions::add_row(const Profile& profile) {
  if (profile.size() == 0) return;
  if (rows_.empty()) first_c_ = profile.c;
  rows_.push_back({profile.c, profile.s.front(), profile.s.back()});
  if (rows_.size() > kRows) rows_.pop_front();
}

void Junctions::restart() {
  rows_.clear();
  segments_.clear();
  loose_.clear();
  room_ = 0;
}

// Points some coarse steps apart are enough for what is looked for.
void Junctions::make_segments(const Curve& curve, const Sampling& sampling) {
  own_.clear();
  const bool step = is_step(curve);
  const auto place = [](const CurvePoint& p) { return std::array<double, 3>{p.s, p.w, p.c}; };
  std::array<double, 3> last = place(curve.points.front());
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    const auto now = place(curve.points[k]);
    if (k + 1 < curve.points.size() && is_within(now[0] - last[0], now[2] - last[2], kReach * sampling.coarse())) continue;
    own_.push_back({last, now, box_of(last, now), curve.id, curve.convex, step});
    last = now;
  }
}

// What may matter to the curve, so that each of its points and ends looks at little.
void Junctions::gather(const Curve& curve, const Sampling& sampling) {
  near_.clear();
  beside_.clear();
  around_ = {};
  for (const CurvePoint& p : curve.points) around_.add(p.s, p.c);
  const bool step = !own_.empty() && own_.front().step;
  segments_.visit(around_, std::max(kReach, kBeside) * sampling.coarse(), [&](const Segment& g) {
    if (g.convex == curve.convex) {
      if (g.line != curve.id) near_.push_back(g);
    } else if (step && g.step) {
      beside_.push_back(g);
    }
  });
}

bool Junctions::is_at_border(const Tip& tip, const Sampling& sampling) const {
  if (tip.c < first_c_ + kBorder * sampling.spacing) return true;
  const auto row = std::lower_bound(rows_.begin(), rows_.end(), tip.c, [](const Row& r, double c) { return r.c < c; });
  if (row == rows_.end()) return false;
  const double edge = kBorder * sampling.pitch;
  return tip.s < row->low + edge || tip.s > row->high - edge;
}

void Junctions::meet_end(Curve& curve, bool back, const Sampling& sampling) {
  CurveEnd& end = back ? curve.back : curve.front;
  if (end.seam || end.why == FeatureEnd::open) return;
  const Tip tip = tip_of(curve, back);
  const Segment* best = nullptr;
  double least = 0.0;
  for (const Segment& g : near_) {
    const double gap = gap_to(tip, g.from, g.to, sampling);
    if (gap < 0.0 || (best != nullptr && gap >= least)) continue;
    best = &g;
    least = gap;
  }
  if (best != nullptr) {
    end.why = FeatureEnd::junction;
    if (std::find(curve.junctions.begin(), curve.junctions.end(), best->line) == curve.junctions.end())
      curve.junctions.push_back(best->line);
    return;
  }
  if (end.why == FeatureEnd::death && is_at_border(tip, sampling)) end.why = FeatureEnd::border;
  // The first piece of a line has both of its ends; a later one stands before or behind the others.
  loose_.add({tip, {tip.s, tip.s, tip.c, tip.c}, {curve.id, back}, curve.convex});
}

// The edges of a step stand above each other.
void Junctions::find_partner(Curve& curve, const Sampling& sampling) const {
  constexpr std::size_t kSamples = 32;
  if (beside_.empty()) return;
  const std::size_t stride = std::max<std::size_t>(1, curve.points.size() / kSamples);
  std::map<std::uint64_t, std::size_t> votes;
  std::size_t samples = 0;
  for (std::size_t k = 0; k < curve.points.size(); k += stride, ++samples) {
    const CurvePoint& p = curve.points[k];
    const Segment* best = nullptr;
    double least = kBeside * sampling.coarse();
    for (const Segment& g : beside_) {
      if (!g.box.is_near({p.s, p.s, p.c, p.c}, least)) continue;
      const Foot foot = foot_of(p.s, p.c, g.from, g.to);
      if (foot.gap > least || (foot.w < p.w) != curve.convex) continue; // the bottom below the top
      best = &g;
      least = foot.gap;
    }
    if (best != nullptr) ++votes[best->line];
  }
  for (const auto& [line, count] : votes)
    if (2 * count > samples) curve.partner = line;
}

void Junctions::meet(Curve& curve, const Sampling& sampling) {
  make_segments(curve, sampling);
  gather(curve, sampling);
  if (curve.loop && !curve.front.seam && !curve.back.seam) {
    curve.front.why = curve.back.why = FeatureEnd::cap;
  } else {
    meet_end(curve, false, sampling);
    meet_end(curve, true, sampling);
  }
  loose_.erase_near(around_, kReach * sampling.coarse(), [&](const Loose& loose) {
    if (loose.end.line == curve.id || loose.convex != curve.convex) return false;
    const bool meets = std::any_of(own_.begin(), own_.end(),
                                   [&](const Segment& g) { return gap_to(loose.tip, g.from, g.to, sampling) >= 0.0; });
    if (meets) curve.met_by.push_back(loose.end);
    return meets;
  });
  find_partner(curve, sampling);
  for (const Segment& g : own_) segments_.add(g);
  forget();
}

void Junctions::forget() {
  // What lies before the horizon is near to nothing that comes: it only takes room.
  constexpr std::size_t kRoom = 1024;
  if (segments_.size() + loose_.size() < room_) return;
  const double horizon = rows_.empty() ? -1e300 : rows_.front().c;
  segments_.forget(horizon, kSegments);
  loose_.forget(horizon, kLoose);
  room_ = segments_.size() + loose_.size() + kRoom;
}

} // namespace scansion
