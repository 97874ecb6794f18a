// The curves of a footprint: its borders, their offset curves and its crests.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/footprint.hpp"
#include "sim/scene/portable_math.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scansion {
namespace {

constexpr double kEndless = 1e9;
constexpr double kDegrees = 57.295779513082320877;

/// Steps that cover `length`, none longer than `step`.
int steps_over(double length, double step) noexcept {
  return std::max(1, static_cast<int>(std::ceil(length / step - 1e-9)));
}

} // namespace

double Footprint::aspect() const noexcept {
  if (kind_ != Kind::round_box) return kEndless;
  const double longer = std::max(a_, b_) + radius_;
  return longer / (std::min(a_, b_) + radius_);
}

double Footprint::area() const noexcept {
  constexpr double kPi = 3.14159265358979323846;
  return 4.0 * (a_ * b_ + (a_ + b_) * radius_) + kPi * radius_ * radius_;
}

double Footprint::perimeter() const noexcept {
  constexpr double kTwoPi = 6.28318530717958647692;
  return 4.0 * (a_ + b_) + kTwoPi * radius_;
}

double Footprint::inmost() const noexcept {
  return kind_ == Kind::half_plane ? -kEndless : -radius_ - std::min(a_, b_); // a strip has no core: a = b = 0
}

/// (u, v) in the footprint's own axes, directions too.
OutlinePoint Footprint::in_plan(double u, double v, double distance, PlanVector out, PlanVector other) const noexcept {
  const auto turn = [&](PlanVector w) { return PlanVector{w.x * cos_ - w.y * sin_, w.x * sin_ + w.y * cos_}; };
  const PlanVector at = turn({u, v});
  return {x_ + at.x, y_ + at.y, distance, turn(out), turn(other)};
}

OutlineCurve Footprint::segment(PlanVector from, PlanVector to, double step, PlanVector out, PlanVector other) const {
  OutlineCurve curve;
  const int steps = steps_over(std::hypot(to.x - from.x, to.y - from.y), step);
  for (int k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) / steps;
    OutlinePoint point = in_plan(from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), 0.0, out, other);
    point.distance = distance(point.x, point.y);
    curve.points.push_back(point);
  }
  return curve;
}

OutlineCurve Footprint::endless(double v, double step, const Box& window, PlanVector out, PlanVector other) const {
  const double cx = 0.5 * (window.x_low + window.x_high);
  const double cy = 0.5 * (window.y_low + window.y_high);
  const double middle = (cx - x_) * cos_ + (cy - y_) * sin_;
  const double half = 0.5 * std::hypot(window.x_high - window.x_low, window.y_high - window.y_low);
  return segment({middle - half, v}, {middle + half, v}, step, out, other);
}

/// The core's sides and quarter circles of `radius` at its corners, one closed curve.
OutlineCurve Footprint::rounded(double radius, double step) const {
  OutlineCurve curve;
  curve.closed = true;
  const std::array<std::array<double, 2>, 4> corners{{{a_, b_}, {-a_, b_}, {-a_, -b_}, {a_, -b_}}};
  constexpr double kQuarter = 1.57079632679489661923;
  for (unsigned corner = 0; corner < corners.size(); ++corner) {
    const auto [u, v] = corners[corner];
    const int steps = steps_over(kQuarter * radius, step);
    for (int k = 0; k <= steps; ++k) {
      const SinCos turn = portable_sincos_degrees(90.0 * corner + kDegrees * kQuarter * k / steps);
      curve.points.push_back(in_plan(u + radius * turn.cos, v + radius * turn.sin, 0.0, {turn.cos, turn.sin}, {}));
    }
    // The straight side up to the next corner, without both its ends.
    const SinCos turn = portable_sincos_degrees(90.0 * corner + 90.0);
    const auto [u2, v2] = corners[(corner + 1) % 4];
    const int parts = steps_over(std::hypot(u2 - u, v2 - v), step);
    for (int k = 1; k < parts; ++k) {
      const double t = static_cast<double>(k) / parts;
      curve.points.push_back(
          in_plan(u + t * (u2 - u) + radius * turn.cos, v + t * (v2 - v) + radius * turn.sin, 0.0, {turn.cos, turn.sin}, {}));
    }
  }
  for (OutlinePoint& point : curve.points) point.distance = radius - radius_;
  // A side of no length makes the ends of its two quarters one place.
  const auto same = [](const OutlinePoint& p, const OutlinePoint& q) { return std::hypot(p.x - q.x, p.y - q.y) < 1e-9; };
  curve.points.erase(std::unique(curve.points.begin(), curve.points.end(), same), curve.points.end());
  if (curve.points.size() > 1 && same(curve.points.front(), curve.points.back())) curve.points.pop_back();
  return curve;
}

std::vector<OutlineCurve> Footprint::level_curves(double distance, double step, const Box& window) const {
  if (kind_ == Kind::half_plane) return {endless(distance, step, window, {0.0, 1.0}, {})};
  const double radius = radius_ + distance;
  if (kind_ == Kind::strip) {
    if (radius <= 1e-9) return {};
    return {endless(radius, step, window, {0.0, 1.0}, {}), endless(-radius, step, window, {0.0, -1.0}, {})};
  }
  if (radius > 1e-9) return {rounded(radius, step)};
  const double a = a_ + radius;
  const double b = b_ + radius;
  if (a <= 1e-9 || b <= 1e-9) return {};
  return {segment({a, -b}, {a, b}, step, {1.0, 0.0}, {}), segment({a, b}, {-a, b}, step, {0.0, 1.0}, {}),
          segment({-a, b}, {-a, -b}, step, {-1.0, 0.0}, {}), segment({-a, -b}, {a, -b}, step, {0.0, -1.0}, {})};
}

std::vector<OutlineCurve> Footprint::crests(double step, const Box& window) const {
  if (kind_ == Kind::half_plane) return {};
  if (kind_ == Kind::strip) return {endless(0.0, step, window, {0.0, 1.0}, {0.0, -1.0})};
  std::vector<OutlineCurve> curves;
  const double inner = std::min(a_, b_);
  const double a = a_ - inner;
  const double b = b_ - inner;
  if (a > 0.0) curves.push_back(segment({-a, 0.0}, {a, 0.0}, step, {0.0, 1.0}, {0.0, -1.0}));
  if (b > 0.0) curves.push_back(segment({0.0, -b}, {0.0, b}, step, {1.0, 0.0}, {-1.0, 0.0}));
  if (inner <= 0.0) return curves;
  for (const double u : {1.0, -1.0}) {
    for (const double v : {1.0, -1.0}) curves.push_back(segment({u * a_, v * b_}, {u * a, v * b}, step, {u, 0.0}, {0.0, v}));
  }
  return curves;
}

int Footprint::sector(double x, double y) const noexcept {
  const double u = (x - x_) * cos_ + (y - y_) * sin_;
  const double v = (y - y_) * cos_ - (x - x_) * sin_;
  if (kind_ == Kind::half_plane) return 0;
  if (kind_ == Kind::strip) return v >= 0.0 ? 0 : 1;
  // Rounded corners and round ends lead from one side to the next; only sharp ones part them.
  if (radius_ > 0.0 || std::fabs(u) > a_ || std::fabs(v) > b_) return 0;
  if (std::fabs(u) - a_ > std::fabs(v) - b_) return u >= 0.0 ? 1 : 2;
  return v >= 0.0 ? 3 : 4;
}

} // namespace scansion
