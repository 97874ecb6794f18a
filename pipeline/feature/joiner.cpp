// Nearest ends first.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/joiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scansion {

namespace {

constexpr double kAround = 4.0;    // coarse steps: ends this near belong together in any direction that does not fold back
constexpr double kStraight = 10.0; // coarse steps: and this near when one continues the other
constexpr double kSettled = 10.0;  // coarse steps: nothing new begins further behind

struct Tip {
  double s = 0.0, w = 0.0, c = 0.0;
  double ds = 0.0, dc = 0.0; // outwards, unit length
};

Tip tip(const Curve& curve, bool back) {
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

// The cost of joining two tips in mm; negative: they do not belong together.
double join_cost(const Tip& a, const Tip& b, const Sampling& sampling) {
  constexpr double kNo = -1.0;
  const double u = sampling.coarse();
  const double ds = b.s - a.s, dc = b.c - a.c;
  const double gap = std::hypot(ds, dc);
  if (gap > kStraight * u || std::abs(b.w - a.w) > 1.5 * gap + 2.0 * u + 6.0 * sampling.noise) return kNo;
  const double turn = -(a.ds * b.ds + a.dc * b.dc); // cosine: 1 goes straight on
  if (gap <= kAround * u) return turn < -0.6 ? kNo : gap;
  const double ahead = (ds * a.ds + dc * a.dc) / gap;
  return turn > 0.82 && ahead > 0.82 ? gap : kNo;
}

} // namespace

void Joiner::take(Curve curve) {
  curve.order = next_++;
  held_.push_back(std::move(curve));
}

void Joiner::find_pairs(double settled, std::span<const LiveEnd> live, const Sampling& sampling) {
  const double u = sampling.coarse();
  ends_.clear();
  pairs_.clear();
  std::vector<Tip> tips;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    for (const bool back : {false, true}) {
      const Curve& curve = held_[i];
      const CurvePoint& p = back ? curve.points.back() : curve.points.front();
      if (curve.loop || p.c + kSettled * u > settled) continue;
      const bool waits = std::any_of(live.begin(), live.end(), [&](const LiveEnd& e) {
        return e.convex == curve.convex && std::hypot(e.s - p.s, e.c - p.c) <= kStraight * u;
      });
      if (waits) continue;
      ends_.push_back({i, back});
      tips.push_back(tip(curve, back));
    }
  }
  std::vector<std::size_t> order(ends_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return tips[a].c != tips[b].c ? tips[a].c < tips[b].c : a < b; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const std::size_t a = order[i], b = order[j];
      if (tips[b].c - tips[a].c > kStraight * u) break;
      if (held_[ends_[a].curve].convex != held_[ends_[b].curve].convex) continue;
      if (ends_[a].curve == ends_[b].curve && length_of(held_[ends_[a].curve]) < 8.0 * u) continue;
      const double cost = join_cost(tips[a], tips[b], sampling);
      if (cost >= 0.0) pairs_.push_back({cost, ends_[std::min(a, b)], ends_[std::max(a, b)]});
    }
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
  first.ends = second.ends;
  second.points.clear();
}

void Joiner::advance(double settled, std::span<const LiveEnd> live, const Sampling& sampling, std::vector<Curve>& out) {
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
  // find_pairs left the ends that are settled in ends_: a curve with both of them can go, unless another one waits beside it.
  std::vector<std::uint32_t> settled_ends(held_.size(), 0);
  for (const End& e : ends_) ++settled_ends[e.curve];
  const double u = sampling.coarse();
  std::vector<bool> done(held_.size(), false);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    done[i] = held_[i].loop || settled_ends[i] == 2;
    for (std::size_t j = 0; done[i] && j < held_.size(); ++j) {
      if (j == i || held_[j].loop || settled_ends[j] == 2 || held_[j].convex != held_[i].convex) continue;
      for (const CurvePoint* p : {&held_[i].points.front(), &held_[i].points.back()})
        for (const CurvePoint* q : {&held_[j].points.front(), &held_[j].points.back()})
          if (std::hypot(p->s - q->s, p->c - q->c) <= kStraight * u) done[i] = false;
    }
  }
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (done[i]) out.push_back(std::move(held_[i]));
  std::erase_if(held_, [](const Curve& c) { return c.points.empty(); });
}

} // namespace scansion
