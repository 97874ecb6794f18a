// Shares of an outline, and the sizes they are weighed against.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch_role.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scansion {

namespace {

constexpr double kMost = 0.75;      // of an outline
constexpr double kSome = 0.2;       // of an outline: a side of a flank
constexpr double kShut = 0.1;       // of an outline: so much of it may be open in a form that is closed
constexpr double kOpen = 0.4;       // and no more than this in one whose ends are open
constexpr double kLong = 3.2;       // length / width; floors are a little longer against their width than their slots
constexpr double kFull = 0.6;       // of the box that its spread tells: a patch that fills less is bent
constexpr double kManhattan = 0.85; // outlines are measured along rows and columns
constexpr double kSag = 0.05;       // of the width
constexpr double kContact = 0.15;   // of a flank's outline, to lead anywhere
constexpr double kDegrees = 180.0 / std::numbers::pi;

Role role_of(const PatchLook& look, const Sampling& sampling) {
  const Outline& o = look.outline;
  if (o.cut() <= 0.0 || o.open > kOpen * o.all()) return Role::face;
  const bool shut = o.open <= kShut * o.all();
  const bool ends = look.is_long() && o.open <= 3.0 * look.width + 8.0 * sampling.coarse();
  const double sag = std::max(kSag * look.width, 2.0 * sampling.noise);
  if (shut || ends) {
    if (o.high >= kMost * o.cut()) return o.sag > sag ? Role::trough : Role::top;
    if (o.low >= kMost * o.cut()) return o.sag < -sag ? Role::bulge : Role::floor;
  }
  return o.high >= kSome * o.cut() && o.low >= kSome * o.cut() ? Role::flank : Role::face;
}

} // namespace

double high_of(const Border& border) noexcept {
  return border.length[0] + (border.height > 0.0 ? border.length[2] : 0.0);
}

double low_of(const Border& border) noexcept {
  return border.length[1] + (border.height > 0.0 ? 0.0 : border.length[2]);
}

Outline outline_of(const PatchGraph& graph, std::uint32_t id) {
  const PatchNode& node = graph.node(id);
  Outline o;
  std::array<double, 3> rim{};
  const auto add = [&](const Border& border) {
    o.high += high_of(border);
    o.low += low_of(border);
    o.backed += border.backed;
    for (std::size_t k = 0; k < rim.size(); ++k) rim[k] += border.rim[k];
  };
  for (const auto& [other, border] : node.borders)
    if (other != id && border.total() > 0.0 && !node.encloses(graph.node(other))) add(border);
  add(node.past_outside);
  o.open = node.open;
  if (o.cut() > 0.0) {
    const PatchPlane plane = node.sums.plane();
    o.sag = rim[2] / o.cut() - plane.at(rim[0] / o.cut(), rim[1] / o.cut());
  }
  return o;
}

bool PatchLook::is_long() const noexcept {
  return length >= kLong * width;
}

PatchLook look_at(const PatchGraph& graph, std::uint32_t id, const Sampling& sampling) {
  const PatchNode& node = graph.node(id);
  PatchLook look;
  look.outline = outline_of(graph, id);
  look.plane = node.sums.plane();
  const auto [length, width] = node.sums.box();
  look.length = length;
  look.width = width;
  const double area = node.sums.count() * sampling.pitch * sampling.spacing;
  if (area < kFull * length * width) {
    const double half = 0.5 * kManhattan * look.outline.all();
    look.length = std::max(half, length);
    look.width = area / look.length;
  }
  look.width = std::max(look.width, sampling.coarse());
  look.role = role_of(look, sampling);
  return look;
}

double angle_between(const PatchPlane& a, const PatchPlane& b) noexcept {
  const double na = std::sqrt(1.0 + a.gs * a.gs + a.gc * a.gc), nb = std::sqrt(1.0 + b.gs * b.gs + b.gc * b.gc);
  return kDegrees * std::acos(std::clamp((1.0 + a.gs * b.gs + a.gc * b.gc) / (na * nb), -1.0, 1.0));
}

namespace {

class Climber {
public:
  Climber(const PatchGraph& graph, std::uint32_t from, const Sampling& sampling)
      : graph_(graph), from_(from), sampling_(sampling) {}

  std::vector<Level> levels() {
    for (const auto& [other, border] : graph_.node(from_).borders) {
      if (other == from_ || border.total() <= 0.0) continue;
      path_.clear();
      first_ = &border;
      follow(other, graph_.node(other).borders.at(from_));
    }
    return std::move(levels_);
  }

private:
  /// `back`: the border of `patch` with what leads to it.
  void follow(std::uint32_t patch, const Border& back) {
    constexpr std::size_t kMostFlanks = 2;
    const PatchLook look = look_at(graph_, patch, sampling_);
    if (look.role != Role::flank || path_.size() == kMostFlanks) {
      const double fall = first_->rim[2] / first_->total() - back.rim[2] / back.total();
      levels_.push_back({patch, path_, first_->total(), fall});
      return;
    }
    const double least = kContact * look.outline.all();
    if (back.total() < least) return;
    path_.push_back(patch);
    for (const auto& [beyond, border] : graph_.node(patch).borders) {
      if (beyond == from_ || border.total() < least || std::find(path_.begin(), path_.end(), beyond) != path_.end()) continue;
      follow(beyond, graph_.node(beyond).borders.at(patch));
    }
    path_.pop_back();
  }

  const PatchGraph& graph_;
  std::uint32_t from_;
  const Sampling& sampling_;
  const Border* first_ = nullptr;
  std::vector<std::uint32_t> path_;
  std::vector<Level> levels_;
};

} // namespace

std::vector<Level> levels_around(const PatchGraph& graph, std::uint32_t id, const Sampling& sampling) {
  return Climber(graph, id, sampling).levels();
}

} // namespace scansion
