// Nearest ends first; pieces of long curves, and what bounds their number.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/joiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scansion {

namespace {

constexpr double kAround = 4.0;    // coarse steps: ends this near belong together in any direction that does not fold back
constexpr double kStraight = 10.0; // coarse steps: and this near when one continues the other
constexpr double kSettled = 10.0;  // coarse steps: nothing new begins further behind
constexpr std::size_t kRest = 64;  // points of a long curve that stay at an end where something may still join

// The cost of joining two tips in mm; negative: they do not belong together.
double join_cost(const Tip& a, const Tip& b, const Sampling& sampling) {
  constexpr double kNo = -1.0;
  const double u = sampling.coarse();
  const double ds = b.s - a.s, dc = b.c - a.c;
  if (!is_within(ds, dc, kStraight * u)) return kNo;
  const double gap = std::sqrt(ds * ds + dc * dc);
  if (std::abs(b.w - a.w) > 1.5 * gap + 2.0 * u + 6.0 * sampling.noise) return kNo;
  const double turn = -(a.ds * b.ds + a.dc * b.dc); // cosine: 1 goes straight on
  if (gap <= kAround * u) return turn < -0.6 ? kNo : gap;
  const double ahead = (ds * a.ds + dc * a.dc) / gap;
  return turn > 0.82 && ahead > 0.82 ? gap : kNo;
}

const CurveEnd& end_of(const Curve& curve, bool back) noexcept {
  return back ? curve.back : curve.front;
}

// The rest of a curve at one end of a line that has gone out hangs on it there.
Curve rest_of(const Curve& curve, std::size_t first, std::size_t last) {
  Curve rest;
  rest.convex = curve.convex;
  rest.order = curve.order;
  const auto begin = curve.points.begin();
  rest.points.assign(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last) + 1);
  return rest;
}

// Pieces go on from the last piece at the end of a line, or stand before the first at its beginning: turns the curve so.
bool must_turn(const Curve& curve) noexcept {
  if (!curve.front.seam && !curve.back.seam) return false;
  const bool goes_on = curve.front.seam && curve.front.seam->at.last;
  const bool stands_before = curve.back.seam && !curve.back.seam->at.last;
  return !goes_on && !stands_before;
}

} // namespace

void Joiner::take(Curve curve) {
  if (curve.follows != 0) {
    for (Curve& held : held_) {
      if (held.front.awaits == curve.follows) held.reverse();
      if (held.back.awaits != curve.follows) continue;
      held.points.insert(held.points.end(), curve.points.begin(), curve.points.end());
      held.back = curve.back;
      return;
    }
  }
  curve.order = next_order_++;
  held_.push_back(std::move(curve));
}

std::size_t Joiner::held_points() const noexcept {
  std::size_t points = 0;
  for (const Curve& curve : held_) points += curve.points.size();
  return points;
}

bool Joiner::is_live_near(std::span<const LiveEnd> live, const CurvePoint& p, bool convex, double reach) const {
  return live_places_.any(p.s, p.c, convex,
                          [&](std::uint32_t e) { return is_within(live[e].s - p.s, live[e].c - p.c, reach); });
}

void Joiner::find_pairs(double settled, std::span<const LiveEnd> live, const Sampling& sampling) {
  const double u = sampling.coarse(), reach = kStraight * u;
  ends_.clear();
  pairs_.clear();
  tips_.clear();
  tip_places_.restart(reach);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    for (const bool back : {false, true}) {
      const Curve& curve = held_[i];
      const CurvePoint& p = back ? curve.points.back() : curve.points.front();
      const CurveEnd& end = end_of(curve, back);
      if (curve.loop || end.seam || end.awaits != 0 || p.c + kSettled * u > settled) continue;
      if (is_live_near(live, p, curve.convex, reach)) continue;
      const Tip tip = tip_of(curve, back);
      tip_places_.add(tip.s, tip.c, curve.convex, static_cast<std::uint32_t>(tips_.size()));
      ends_.push_back({i, back});
      tips_.push_back(tip);
    }
  }
  tip_places_.close();
  for (std::uint32_t a = 0; a < tips_.size(); ++a) {
    const Tip& from = tips_[a];
    (void)tip_places_.any(from.s, from.c, held_[ends_[a].curve].convex, [&](std::uint32_t b) {
      // Each two once, from the lower c.
      if (b == a || tips_[b].c < from.c || (tips_[b].c == from.c && b < a) || tips_[b].c - from.c > reach) return false;
      if (ends_[a].curve == ends_[b].curve && is_shorter(held_[ends_[a].curve], 8.0 * u)) return false;
      const double cost = join_cost(from, tips_[b], sampling);
      if (cost >= 0.0) pairs_.push_back({cost, ends_[std::min(a, b)], ends_[std::max(a, b)]});
      return false;
    });
  }
  std::sort(pairs_.begin(), pairs_.end(), [&](const Pair& x, const Pair& y) {
    if (x.cost != y.cost) return x.cost < y.cost;
    const auto key = [&](const Pair& p) {
      return std::array<std::uint64_t, 4>{held_[p.a.curve].order, held_[p.b.curve].order, p.a.back ? 1U : 0U,
                                          p.b.back ? 1U : 0U};
    };
    return key(x) < key(y);
  });
}

void Joiner::join(const End& a, const End& b) {
  Curve& first = held_[a.curve];
  if (a.curve == b.curve) {
    first.loop = true;
    first.points.push_back(first.points.front());
    return;
  }
  Curve& second = held_[b.curve];
  if (!a.back) first.reverse();
  if (b.back) second.reverse();
  first.points.insert(first.points.end(), second.points.begin(), second.points.end());
  first.back = second.back;
  second.points.clear();
}

void Joiner::advance(double settled, std::span<const LiveEnd> live, const Sampling& sampling, std::vector<Curve>& out) {
  live_places_.restart(kStraight * sampling.coarse());
  for (std::uint32_t e = 0; e < live.size(); ++e) live_places_.add(live[e].s, live[e].c, live[e].convex, e);
  live_places_.close();
  // One join a round and end: after a join the ends of both curves are other ones.
  for (bool again = true; again;) {
    again = false;
    find_pairs(settled, live, sampling);
    std::vector<bool> touched(held_.size(), false);
    for (const Pair& pair : pairs_) {
      if (touched[pair.a.curve] || touched[pair.b.curve]) continue;
      touched[pair.a.curve] = touched[pair.b.curve] = true;
      join(pair.a, pair.b);
      again = true;
    }
    std::erase_if(held_, [](const Curve& c) { return c.points.empty(); });
  }
  release_finished(sampling, out);
  release_pieces(out);
  release_oldest(out);
  std::erase_if(held_, [](const Curve& c) { return c.points.empty(); });
}

// A curve with both ends settled can go, unless another one waits beside it.
void Joiner::release_finished(const Sampling& sampling, std::vector<Curve>& out) {
  // find_pairs left the ends that are settled in ends_; seams are.
  std::vector<std::uint32_t> settled_ends(held_.size(), 0);
  for (const End& e : ends_) ++settled_ends[e.curve];
  for (std::size_t i = 0; i < held_.size(); ++i)
    settled_ends[i] += (held_[i].front.seam ? 1U : 0U) + (held_[i].back.seam ? 1U : 0U);
  const double reach = kStraight * sampling.coarse();
  const auto is_done = [&](std::size_t i) { return held_[i].loop || settled_ends[i] == 2; };
  tip_places_.restart(reach); // of curves that wait
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (is_done(i)) continue;
    for (const CurvePoint* p : {&held_[i].points.front(), &held_[i].points.back()})
      tip_places_.add(p->s, p->c, held_[i].convex, static_cast<std::uint32_t>(i));
  }
  tip_places_.close();
  const auto waits_near = [&](const CurvePoint& p, bool convex) {
    return tip_places_.any(p.s, p.c, convex, [&](std::uint32_t j) {
      const CurvePoint &front = held_[j].points.front(), &back = held_[j].points.back();
      return is_within(p.s - front.s, p.c - front.c, reach) || is_within(p.s - back.s, p.c - back.c, reach);
    });
  };
  std::vector<bool> done(held_.size(), false);
  for (std::size_t i = 0; i < held_.size(); ++i)
    done[i] = is_done(i) && !waits_near(held_[i].points.front(), held_[i].convex) &&
              !waits_near(held_[i].points.back(), held_[i].convex);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (!done[i]) continue;
    (void)release(std::move(held_[i]), out);
    held_[i].points.clear();
  }
}

void Joiner::release_pieces(std::vector<Curve>& out) {
  const std::size_t count = held_.size(); // rests come behind
  for (std::size_t i = 0; i < count; ++i) {
    if (held_[i].points.size() <= kPiece) continue;
    const auto stays = [&](bool back) {
      return !end_of(held_[i], back).seam &&
             std::none_of(ends_.begin(), ends_.end(), [&](const End& e) { return e.curve == i && e.back == back; });
    };
    release_middle(i, stays(false), stays(true), out);
  }
}

void Joiner::release_oldest(std::vector<Curve>& out) {
  for (std::size_t points = held_points(); points > kMostHeld; points = held_points()) {
    std::size_t oldest = held_.size();
    for (std::size_t i = 0; i < held_.size(); ++i) {
      const Curve& curve = held_[i];
      const std::size_t stay = (curve.front.awaits != 0 ? kRest : 0) + (curve.back.awaits != 0 ? kRest : 0);
      if (curve.points.size() <= stay + (stay > 0 ? 1 : 0)) continue;
      if (oldest == held_.size() || curve.order < held_[oldest].order) oldest = i;
    }
    if (oldest == held_.size()) return;
    release_middle(oldest, held_[oldest].front.awaits != 0, held_[oldest].back.awaits != 0, out);
  }
}

// All but what must stay at the ends goes out; the rests hang on it.
void Joiner::release_middle(std::size_t curve, bool front_stays, bool back_stays, std::vector<Curve>& out) {
  const Curve whole = std::move(held_[curve]);
  held_[curve] = {};
  const std::size_t n = whole.points.size();
  const std::size_t first = front_stays ? kRest : 0, last = n - 1 - (back_stays ? kRest : 0);
  Curve middle = rest_of(whole, first, last);
  if (!front_stays) middle.front = whole.front;
  if (!back_stays) middle.back = whole.back;
  // Where the line goes on: the side that the middle itself hung on, or both sides of a new line.
  const std::optional<Seam> seam = middle.front.seam ? middle.front.seam : middle.back.seam;
  const auto next = [&](bool at_last) {
    if (seam) return Seam{seam->at, seam->piece + (seam->at.last ? 1 : -1)};
    return Seam{{next_id_ - 1, at_last}, at_last ? 1 : -1};
  };
  if (front_stays) middle.front.why = FeatureEnd::open;
  if (back_stays) middle.back.why = FeatureEnd::open;
  const bool published = release(std::move(middle), out);
  if (front_stays) {
    Curve rest = rest_of(whole, 0, first);
    rest.front = whole.front;
    rest.back.why = FeatureEnd::open;
    if (published) rest.back.seam = next(false);
    held_.push_back(std::move(rest));
  }
  if (back_stays) {
    Curve rest = rest_of(whole, last, n - 1);
    rest.back = whole.back;
    rest.front.why = FeatureEnd::open;
    if (published) rest.front.seam = next(true);
    held_.push_back(std::move(rest));
  }
}

// False when it has too few points to be a feature line.
bool Joiner::release(Curve curve, std::vector<Curve>& out) {
  if (!curve.front.seam && !curve.back.seam) {
    if (!is_enough(curve)) return false;
    curve.id = next_id_++;
    out.push_back(std::move(curve));
    return true;
  }
  if (must_turn(curve)) curve.reverse();
  const bool goes_on = curve.front.seam && curve.front.seam->at.last;
  const Seam own = goes_on ? *curve.front.seam : *curve.back.seam;
  const std::optional<Seam> other = goes_on ? curve.back.seam : curve.front.seam;
  curve.id = own.at.line;
  curve.piece = own.piece;
  if (other && other->at.line == own.at.line)
    curve.loop = true;
  else if (other)
    (goes_on ? curve.ends_at : curve.begins_at) = other->at;
  out.push_back(std::move(curve));
  return true;
}

} // namespace scansion
