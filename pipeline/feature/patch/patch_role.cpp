// Shares of an outline, and the sizes they are weighed against.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/patch_role.hpp"

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
constexpr double kSlope = 0.14;     // of a flank: tan 8 degrees
constexpr double kLarger = 2.0;     // times: the face beside a strip
constexpr double kSide = 0.25;      // of an outline
constexpr double kContact = 0.15;   // of a flank's outline, to lead anywhere
constexpr double kDegrees = 180.0 / std::numbers::pi;

bool slopes(const PatchLook& look) {
  const Outline& o = look.outline;
  const double all = o.cut() + o.enclosed_high + o.enclosed_low;
  return o.high + o.enclosed_high >= kSome * all && o.low + o.enclosed_low >= kSome * all && o.drop >= kSlope * look.width;
}

Role role_of(const PatchLook& look, const Sampling& sampling) {
  const Outline& o = look.outline;
  if (o.cut() <= 0.0 || o.open > kOpen * o.all()) return Role::face;
  const bool shut = o.open <= kShut * o.all();
  const bool ends = look.is_long() && o.open <= 3.0 * look.width + 8.0 * sampling.coarse();
  const double sag = std::max(kSag * look.width, 2.0 * sampling.noise);
  if (shut || ends) {
    // A cone without its tip, bordered by its foot, is a flank of what it encloses.
    if (o.high >= kMost * o.cut()) return o.sag <= sag ? Role::top : slopes(look) ? Role::flank : Role::trough;
    if (o.low >= kMost * o.cut()) return o.sag >= -sag ? Role::floor : slopes(look) ? Role::flank : Role::bulge;
  }
  return slopes(look) ? Role::flank : Role::face;
}

/// A bevel or rounding meets a larger face in a crease on one side only.
bool is_strip(const PatchGraph& graph, std::uint32_t id, const PatchLook& look) {
  double beside = 0.0;
  for (const auto& [other, border] : graph.node(id).borders) {
    if (other == id || border.length[2] > border.length[0] + border.length[1]) continue;
    if (graph.node(other).sums.count() >= kLarger * graph.node(id).sums.count()) beside += border.total();
  }
  return beside >= kSide * look.outline.cut() && beside <= (1.0 - kSide) * look.outline.cut();
}

} // namespace

double high_of(const Border& border) noexcept {
  return border.length[0] + (border.height > 0.0 ? border.length[2] : 0.0);
}

double low_of(const Border& border) noexcept {
  return border.length[1] + (border.height > 0.0 ? 0.0 : border.length[2]);
}

bool PatchLook::is_long() const noexcept {
  return length >= kLong * width;
}

double angle_between(const PatchPlane& a, const PatchPlane& b) noexcept {
  const double na = std::sqrt(1.0 + a.gs * a.gs + a.gc * a.gc), nb = std::sqrt(1.0 + b.gs * b.gs + b.gc * b.gc);
  return kDegrees * std::acos(std::clamp((1.0 + a.gs * b.gs + a.gc * b.gc) / (na * nb), -1.0, 1.0));
}

namespace {

Outline outline_of(const PatchGraph& graph, std::uint32_t id) {
  const PatchNode& node = graph.node(id);
  Outline o;
  std::array<double, 3> rim{};
  std::array<double, 2> height{}, length{}; // of the rims where it is high and where it is low
  const auto note_rim = [&](const Border& border) {
    const std::size_t low = high_of(border) < low_of(border) ? 1 : 0;
    height[low] += border.rim[2];
    length[low] += border.total();
  };
  const auto add = [&](const Border& border) {
    o.high += high_of(border);
    o.low += low_of(border);
    o.backed += border.backed;
    for (std::size_t k = 0; k < rim.size(); ++k) rim[k] += border.rim[k];
    note_rim(border);
  };
  const auto add_enclosed = [&](const Border& border) {
    o.enclosed_high += high_of(border);
    o.enclosed_low += low_of(border);
    note_rim(border);
  };
  for (const auto& [other, border] : node.borders) {
    if (other == id || border.total() <= 0.0) continue;
    if (node.encloses(graph.node(other)))
      add_enclosed(border);
    else
      add(border);
  }
  add(node.past_outside);
  add_enclosed(node.past_inside);
  o.open = node.open;
  if (o.cut() > 0.0) {
    const PatchPlane plane = node.sums.plane();
    o.sag = rim[2] / o.cut() - plane.at(rim[0] / o.cut(), rim[1] / o.cut());
  }
  if (length[0] > 0.0 && length[1] > 0.0) o.drop = height[0] / length[0] - height[1] / length[1];
  return o;
}

PatchLook look_at(const PatchGraph& graph, std::uint32_t id, const Sampling& sampling) {
  const PatchNode& node = graph.node(id);
  PatchLook look;
  look.outline = outline_of(graph, id);
  look.plane = node.sums.plane();
  const auto [length, width] = node.sums.box();
  look.length = length;
  look.width = width;
  const double area = node.sums.count() * sampling.pitch * sampling.spacing + node.holes;
  if (area < kFull * length * width) {
    const double half = 0.5 * kManhattan * look.outline.all();
    look.length = std::max(half, length);
    look.width = area / look.length;
  }
  look.width = std::max(look.width, sampling.coarse());
  look.role = role_of(look, sampling);
  if ((look.role == Role::top || look.role == Role::floor) && look.is_long() && is_strip(graph, id, look))
    look.role = Role::strip;
  return look;
}

class Climber {
public:
  Climber(const PatchGraph& graph, std::uint32_t from, PatchLooks& looks) : graph_(graph), from_(from), looks_(looks) {}

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
    const PatchLook& look = looks_.of(patch);
    const bool leads_on = look.role == Role::flank || look.role == Role::strip;
    if (!leads_on || path_.size() == kMostFlanks) {
      levels_.push_back({patch, path_, first_->total(), fall_to(look.plane, back)});
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

  /// From rim to rim, less what the slope of both patches accounts for.
  [[nodiscard]] double fall_to(const PatchPlane& plane, const Border& back) const {
    std::array<double, 3> way{};
    for (std::size_t k = 0; k < way.size(); ++k) way[k] = first_->rim[k] / first_->total() - back.rim[k] / back.total();
    const PatchPlane own = graph_.node(from_).sums.plane();
    return way[2] - 0.5 * (own.gs + plane.gs) * way[0] - 0.5 * (own.gc + plane.gc) * way[1];
  }

  const PatchGraph& graph_;
  std::uint32_t from_;
  PatchLooks& looks_;
  const Border* first_ = nullptr;
  std::vector<std::uint32_t> path_;
  std::vector<Level> levels_;
};

} // namespace

const PatchLook& PatchLooks::of(std::uint32_t id) {
  const auto [at, is_new] = looks_.try_emplace(id);
  if (is_new) at->second = look_at(graph_, id, sampling_);
  return at->second;
}

const std::vector<Level>& PatchLooks::levels_around(std::uint32_t id) {
  const auto [at, is_new] = levels_.try_emplace(id);
  if (is_new) at->second = Climber(graph_, id, *this).levels();
  return at->second;
}

} // namespace scansion
