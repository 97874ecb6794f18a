// Outlines of features in plan.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/footprint.hpp"

#include "sim/scene/portable_math.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {

Footprint::Footprint(Kind kind, double x, double y, double degrees, double a, double b, double radius) noexcept
    : kind_(kind), x_(x), y_(y), cos_(1.0), sin_(0.0), a_(a), b_(b), radius_(radius) {
  const SinCos turn = portable_sincos_degrees(degrees);
  cos_ = turn.cos;
  sin_ = turn.sin;
}

Footprint Footprint::half_plane(double x, double y, double degrees) noexcept {
  return {Kind::half_plane, x, y, degrees, 0.0, 0.0, 0.0};
}

Footprint Footprint::strip(double x, double y, double degrees, double half_width) noexcept {
  return {Kind::strip, x, y, degrees, 0.0, 0.0, half_width};
}

Footprint Footprint::round_box(double x, double y, double length, double width, double corner, double degrees) noexcept {
  return {Kind::round_box, x, y, degrees, length / 2.0 - corner, width / 2.0 - corner, corner};
}

Footprint Footprint::disc(double x, double y, double radius) noexcept {
  return {Kind::round_box, x, y, 0.0, 0.0, 0.0, radius};
}

double Footprint::distance(double x, double y) const noexcept {
  const double dx = x - x_;
  const double dy = y - y_;
  const double across = dy * cos_ - dx * sin_;
  if (kind_ == Kind::half_plane) return across;
  if (kind_ == Kind::strip) return std::fabs(across) - radius_;
  const double p = std::fabs(dx * cos_ + dy * sin_) - a_;
  const double q = std::fabs(across) - b_;
  if (p <= 0.0 || q <= 0.0) return std::max(p, q) - radius_;
  return std::sqrt(p * p + q * q) - radius_;
}

Box Footprint::box(double reach) const noexcept {
  constexpr double kAll = std::numeric_limits<double>::max();
  if (kind_ != Kind::round_box) return {-kAll, kAll, -kAll, kAll};
  const double half_x = std::fabs(a_ * cos_) + std::fabs(b_ * sin_) + radius_ + reach;
  const double half_y = std::fabs(a_ * sin_) + std::fabs(b_ * cos_) + radius_ + reach;
  return {x_ - half_x, x_ + half_x, y_ - half_y, y_ + half_y};
}

} // namespace scansion
