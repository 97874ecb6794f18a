// Steps first, then the ranked points that no step explains.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/lengthwise/detector.hpp"

#include "pipeline/feature/fit/line_sums.hpp"
#include "pipeline/feature/fit/make_point.hpp"
#include "pipeline/feature/profile/rises.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scansion {

namespace {

constexpr std::uint32_t kLineEnd = 3; // samples at the end of a run that show no feature

double angle(double ds, double dw) noexcept {
  return std::atan2(dw, ds) * 180.0 / std::numbers::pi;
}

// How a vertex turns against its neighbours.
Turning turning_of(const Profile& profile, const Vertex& vertex) noexcept {
  const auto direction = [&](std::uint32_t from, std::uint32_t to) {
    return Direction{profile.s[to] - profile.s[from], profile.w[to] - profile.w[from]};
  };
  return Turning::between(direction(vertex.before, vertex.k), direction(vertex.k, vertex.after));
}

// Whether a vertex that turns like this may be a corner at all: over its flanks one turns by the least angle, and against its
// neighbours, which stand on these flanks or beyond their ends, about as much.
bool may_be_corner(const Turning& turning, double least_tangent) noexcept {
  return std::abs(turning.sine) >= least_tangent * turning.cosine;
}

} // namespace

// An edge goes on as it was on the line before.
std::optional<Bend> Detector::find_bend_at(const Heights& heights, std::uint32_t k, const Reach& reach, bool clockwise,
                                           const Sampling& sampling, const FitScale& scale) {
  constexpr double kNear = 1.5; // u
  const double s = heights.s[k], near = kNear * sampling.coarse();
  while (next_ < edges_before_.size() && edges_before_[next_].s < s - near) ++next_;
  for (std::size_t i = next_; i < edges_before_.size() && edges_before_[i].s <= s + near; ++i) {
    const Precedent& before = edges_before_[i].precedent;
    if (!before.applies(clockwise)) continue;
    auto bend = find_sharp_bend(heights, k, reach, clockwise, scale);
    if (!bend) break;
    edges_.push_back({bend->s, before.next()});
    return bend;
  }
  auto bend = find_bend(heights, k, reach, scale);
  if (bend) edges_.push_back({bend->s, Precedent::of(*bend, scale)});
  return bend;
}

void Detector::add_vertex(const Profile& profile, const Vertex& vertex, std::uint32_t first, std::uint32_t last, bool clockwise,
                          const Sampling& sampling, const FitScale& scale, double least) {
  constexpr double kSlope = 0.2493280028432; // tangent of 14 degrees: each side of a smooth crest
  constexpr double kTotal = 42.0;            // degrees: both sides
  constexpr double kRound = 0.5;             // mm: a crest of this radius is smooth
  const Heights heights{profile.s, profile.w};
  const Reach reach{std::max(vertex.before, first), std::min(vertex.after, last), first, last};
  std::optional<Bend> bend = find_bend_at(heights, vertex.k, reach, clockwise, sampling, scale);
  bool smooth = false;
  if (!bend || bend->sharpness < 0.0 || bend->rounding > kRound) {
    const double before_s = profile.s[vertex.k] - profile.s[vertex.before],
                 before_w = profile.w[vertex.k] - profile.w[vertex.before];
    const double after_s = profile.s[vertex.after] - profile.s[vertex.k],
                 after_w = profile.w[vertex.after] - profile.w[vertex.k];
    const bool top =
        (before_w > 0.0) != (after_w > 0.0) && std::abs(before_w) >= kSlope * before_s && std::abs(after_w) >= kSlope * after_s;
    const double before = top ? angle(before_s, before_w) : 0.0, after = top ? angle(after_s, after_w) : 0.0;
    const bool crest = top && std::abs(after - before) >= kTotal;
    if (crest) {
      const double limit = std::max(2.0, 4.0 * sampling.coarse());
      if (auto vertex_bend = find_crest(heights, vertex.k, vertex.before, vertex.after, limit, scale)) {
        const double sharpness = bend ? bend->sharpness : 0.0;
        bend = vertex_bend;
        bend->theta_before = before;
        bend->theta_after = after;
        bend->tau = after - before;
        bend->sigma_tau = 1.0;
        bend->sharpness = std::max(0.0, sharpness);
        smooth = true;
      }
    }
  }
  if (!bend) return;
  if (bend->rounding > 0.0 && !smooth) {
    rounding_end_ = bend->flank_after;
    rounds_clockwise_ = bend->tau < 0.0;
  }
  FeaturePoint p = make_point(*bend, vertex.k, scale);
  p.width = std::log2(profile.distance[vertex.k] / least);
  if (smooth) {
    p.smooth = true;
    p.type = p.tau < 0.0 ? FeatureType::ridge : FeatureType::valley;
  }
  found_.push_back(p);
}

// A weaker bend within the window of a coarser one of its polarity is part of that one.
void Detector::drop_parts(const Sampling& sampling) {
  constexpr double kBeside = 2.0; // pitches: one edge, found twice
  constexpr double kAlike = 1e-6;
  dropped_.assign(found_.size(), false);
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const FeaturePoint& coarse = found_[i];
    if (coarse.window == 0) continue;
    const double reach = coarse.window * sampling.pitch;
    const auto check = [&](std::size_t j) {
      const FeaturePoint& fine = found_[j];
      if (fine.step || fine.convex() != coarse.convex()) return;
      // Two points that see the same edge from both sides measure it alike but for the last digits: the first one stays.
      const double limit = std::abs(coarse.tau) * (j > i ? 1.0 + kAlike : 1.0 - kAlike);
      const bool beside = std::abs(fine.s - coarse.s) <= kBeside * sampling.pitch && std::abs(fine.tau) < limit;
      if ((beside && !coarse.step) || is_part(fine.tau, fine.window, coarse)) dropped_[j] = true;
    };
    for (std::size_t j = i; j-- > 0 && coarse.s - found_[j].s <= reach;) check(j);
    for (std::size_t j = i + 1; j < found_.size() && found_[j].s - coarse.s <= reach; ++j) check(j);
  }
}

void Detector::sort(std::vector<FeaturePoint>& out) {
  order_.resize(found_.size());
  place_.assign(found_.size(), 0);
  for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
  std::sort(order_.begin(), order_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return found_[a].s != found_[b].s ? found_[a].s < found_[b].s : a < b; });
  for (std::uint32_t i = 0; i < order_.size(); ++i) place_[order_[i]] = i;
  out.clear();
  for (const std::uint32_t i : order_) {
    FeaturePoint p = found_[i];
    if (p.partner >= 0) p.partner = static_cast<std::int32_t>(place_[static_cast<std::size_t>(p.partner)]);
    out.push_back(p);
  }
}

void Detector::detect(const Profile& profile, const Sampling& sampling, std::vector<FeaturePoint>& out) {
  found_.clear();
  walls_.clear();
  const FitScale scale = FitScale::of(sampling.noise, sampling.pitch, sampling.coarse(), sampling.limits);
  const double least = least_distance(sampling.noise);
  const Heights heights{profile.s, profile.w};
  std::uint32_t begin = 0;
  for (const std::uint32_t end : profile.ends) {
    find_steps(heights, begin, end, rises_of(profile.rises, begin, end), scale, found_, walls_);
    begin = end;
  }
  for (FeaturePoint& p : found_) {
    const FeaturePoint& other = found_[static_cast<std::size_t>(p.partner)];
    p.width = std::log2(std::max(1.0, 0.5 * std::abs(p.w - other.w) / least));
  }
  find_vertices(profile, least, stack_, vertices_);
  std::size_t wall = 0, run = 0;
  begin = 0;
  rounding_end_ = 0;
  std::swap(edges_, edges_before_);
  edges_.clear();
  next_ = 0;
  // (Both follow from few samples: a margin.)
  const double least_tangent = std::tan(6.0 / 7.0 * scale.least_turning * std::numbers::pi / 180.0);
  for (const Vertex& vertex : vertices_) {
    while (vertex.k >= profile.ends[run]) begin = profile.ends[run++];
    if (vertex.k < begin + kLineEnd || vertex.k + kLineEnd >= profile.ends[run]) continue;
    const Turning turning = turning_of(profile, vertex);
    if (!may_be_corner(turning, least_tangent)) continue;
    // The vertices of one rounding see the same edge.
    if (vertex.k < rounding_end_ && turning.clockwise() == rounds_clockwise_) continue;
    while (wall < walls_.size() && walls_[wall].high + 1 < vertex.k) ++wall;
    if (wall < walls_.size() && walls_[wall].step && vertex.k + 1 >= walls_[wall].low) continue;
    // No fit reaches beyond a step.
    std::uint32_t first = begin, last = profile.ends[run] - 1;
    if (wall > 0 && walls_[wall - 1].step && walls_[wall - 1].last < vertex.k) first = std::max(first, walls_[wall - 1].last);
    if (wall < walls_.size() && walls_[wall].step && walls_[wall].first > vertex.k) last = std::min(last, walls_[wall].first);
    add_vertex(profile, vertex, first, last, turning.clockwise(), sampling, scale, least);
  }
  sort(out);
  std::swap(found_, out);
  drop_parts(sampling);
  // What stays keeps its order; partners are steps, which are never dropped.
  place_.assign(found_.size(), 0);
  out.clear();
  for (std::uint32_t i = 0; i < found_.size(); ++i) {
    place_[i] = static_cast<std::uint32_t>(out.size());
    if (!dropped_[i]) out.push_back(found_[i]);
  }
  for (FeaturePoint& p : out)
    if (p.partner >= 0) p.partner = static_cast<std::int32_t>(place_[static_cast<std::size_t>(p.partner)]);
}

} // namespace scansion
