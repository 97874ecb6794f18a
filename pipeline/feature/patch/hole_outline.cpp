// Slabs to the sides of their union, sides to loops, the outer loop to a smooth curve.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/hole_outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace scansion {

namespace {

using Corner = std::pair<double, double>; // s, c

/// A side of the union, its inside to the left.
struct Side {
  Corner from, to;
  const HoleSlab* slab = nullptr;
  [[nodiscard]] bool is_end() const noexcept { return from.first == to.first; } // of a slab; else between two scan lines
  [[nodiscard]] bool is_low() const noexcept { return from.second > to.second; }
};

class Sides {
public:
  explicit Sides(const std::vector<HoleSlab>& slabs) {
    for (const HoleSlab& t : slabs) {
      sides_.push_back({{t.s_low, t.c_high}, {t.s_low, t.c_low}, &t});
      sides_.push_back({{t.s_high, t.c_low}, {t.s_high, t.c_high}, &t});
    }
    auto before = slabs.begin(), row = slabs.begin(); // the row before, and where the next begins
    for (auto next = row; row != slabs.end(); before = row, row = next) {
      while (next != slabs.end() && next->row == row->row) ++next;
      add_between(before, row, next);
    }
    add_between(before, slabs.end(), slabs.end());
  }

  [[nodiscard]] std::vector<std::vector<Side>> loops() {
    std::multimap<Corner, std::size_t> starts;
    for (std::size_t k = 0; k < sides_.size(); ++k) starts.emplace(sides_[k].from, k);
    std::vector<std::vector<Side>> loops;
    while (!starts.empty()) {
      std::vector<Side>& loop = loops.emplace_back();
      for (auto at = starts.begin(); at != starts.end(); at = starts.find(loop.back().to)) {
        loop.push_back(sides_[at->second]);
        starts.erase(at);
      }
    }
    return loops;
  }

private:
  using Slabs = std::vector<HoleSlab>::const_iterator;
  struct Change {
    double s = 0.0;
    bool below = false, begins = false;
    const HoleSlab* slab = nullptr;
  };

  // What only one of two rows has lies along the level between them.
  void add_between(Slabs above, Slabs row, Slabs end) {
    changes_.clear();
    for (Slabs t = above; t != end; ++t) {
      changes_.push_back({t->s_low, t >= row, true, &*t});
      changes_.push_back({t->s_high, t >= row, false, &*t});
    }
    std::stable_sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) { return a.s < b.s; });
    const HoleSlab *upper = nullptr, *lower = nullptr;
    double from = 0.0;
    for (const Change& change : changes_) {
      if (change.s > from && (upper == nullptr) != (lower == nullptr)) {
        if (lower != nullptr)
          sides_.push_back({{from, lower->c_low}, {change.s, lower->c_low}, lower});
        else
          sides_.push_back({{change.s, upper->c_high}, {from, upper->c_high}, upper});
      }
      (change.below ? lower : upper) = change.begins ? change.slab : nullptr;
      from = change.s;
    }
  }

  std::vector<Side> sides_;
  std::vector<Change> changes_;
};

double area_of(const std::vector<Side>& loop) {
  double twice = 0.0;
  for (const Side& side : loop) twice += side.from.first * side.to.second - side.to.first * side.from.second;
  return 0.5 * twice;
}

// Along and across the scan lines.
double length_of(const std::vector<Side>& loop) {
  double sum = 0.0;
  for (const Side& side : loop) sum += std::abs(side.to.first - side.from.first) + std::abs(side.to.second - side.from.second);
  return sum;
}

double height_of(const std::vector<Side>& loop) {
  double sum = 0.0, length = 0.0;
  for (const Side& side : loop) {
    if (!side.is_end()) continue;
    const double part = std::abs(side.to.second - side.from.second);
    sum += part * (side.is_low() ? side.slab->w_low : side.slab->w_high);
    length += part;
  }
  return sum / length;
}

// Midway between a sample that is there and one that is missing beside it.
std::vector<RimPoint> points_of(const std::vector<Side>& loop, double pitch) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<RimPoint> points;
  for (const Side& side : loop) {
    const HoleSlab& t = *side.slab;
    if (side.is_end()) {
      points.push_back({side.from.first, side.is_low() ? t.w_low : t.w_high, t.c, t.line, side.is_low() ? t.first : t.last});
      continue;
    }
    const double length = side.to.first - side.from.first;
    const auto count = static_cast<int>(std::lround(std::abs(length) / pitch));
    for (int k = 0; k < count; ++k) {
      const double s = side.from.first + length * (k + 0.5) / count;
      const std::uint32_t nearest = s - t.s_low < t.s_high - s ? t.first : t.last;
      points.push_back({s, kUnknown, side.from.second, t.line, nearest});
    }
  }
  return points;
}

// Heights between those that are known, round the curve.
void fill_heights(std::vector<RimPoint>& points) {
  const auto known = [](const RimPoint& p) { return !std::isnan(p.w); };
  std::rotate(points.begin(), std::find_if(points.begin(), points.end(), known), points.end());
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin + 1;
    while (end < points.size() && !known(points[end])) ++end;
    const double from = points[begin].w, to = points[end % points.size()].w;
    for (std::size_t k = begin + 1; k < end; ++k)
      points[k].w = from + (to - from) * static_cast<double>(k - begin) / static_cast<double>(end - begin);
    begin = end;
  }
}

// Each point is known to half a step only.
void smooth(std::vector<RimPoint>& points) {
  const std::vector<RimPoint> raw = points;
  const std::size_t n = raw.size();
  for (std::size_t k = 0; k < n; ++k) {
    const RimPoint &before = raw[(k + n - 1) % n], &after = raw[(k + 1) % n];
    points[k].s = 0.25 * (before.s + 2.0 * raw[k].s + after.s);
    points[k].w = 0.25 * (before.w + 2.0 * raw[k].w + after.w);
    points[k].c = 0.25 * (before.c + 2.0 * raw[k].c + after.c);
  }
}

} // namespace

std::optional<HoleOutline> trace_hole(const std::vector<HoleSlab>& slabs, double pitch) {
  constexpr std::size_t kLeastPoints = 6;
  if (slabs.empty()) return std::nullopt;
  HoleOutline out;
  out.s_low = out.c_low = std::numeric_limits<double>::infinity();
  out.s_high = out.c_high = -out.s_low;
  for (const HoleSlab& t : slabs) {
    const double part = (t.s_high - t.s_low) * (t.c_high - t.c_low);
    out.area += part;
    out.s += part * 0.5 * (t.s_low + t.s_high);
    out.c += part * 0.5 * (t.c_low + t.c_high);
    out.s_low = std::min(out.s_low, t.s_low);
    out.s_high = std::max(out.s_high, t.s_high);
    out.c_low = std::min(out.c_low, t.c_low);
    out.c_high = std::max(out.c_high, t.c_high);
  }
  if (!(out.area > 0.0)) return std::nullopt;
  out.s /= out.area;
  out.c /= out.area;
  const auto loops = Sides(slabs).loops();
  const auto outer =
      std::max_element(loops.begin(), loops.end(), [](const auto& a, const auto& b) { return area_of(a) < area_of(b); });
  double inside = 0.0;
  out.w = height_of(*outer);
  for (auto loop = loops.begin(); loop != loops.end(); ++loop) {
    const double area = -area_of(*loop);
    if (loop == outer || area <= 0.0) continue;
    out.rise += area * (height_of(*loop) - out.w);
    out.inner_mm += length_of(*loop);
    inside += area;
  }
  if (inside > 0.0) out.rise /= inside;
  out.points = points_of(*outer, pitch);
  if (out.points.size() < kLeastPoints) return std::nullopt;
  fill_heights(out.points);
  smooth(out.points);
  return out;
}

} // namespace scansion
