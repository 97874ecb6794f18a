// The classes of triplets and angles.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/feature_point.hpp"
#include "pipeline/feature/fit/local_fit.hpp"

#include <cmath>
#include <cstdlib>

namespace scansion {

namespace {

constexpr double kFlat = 8.0;  // degrees
constexpr double kWall = 70.0; // degrees

using enum ShapeElement;

// Rows: slope before, columns: slope after, from wall down to wall up. Where either polarity is possible, the convex class
// stands here and concave() gives the other.
constexpr std::array<std::array<ShapeElement, 5>, 5> kShapes = {{
    {wall_bend_convex, step_bottom, step_bottom, step_bottom, slit},
    {step_top, slope_change_convex, foot_levelling, pit, step_bottom},
    {step_top, shoulder_falling, weak_bend_convex, foot_rising, step_bottom},
    {step_top, peak, shoulder_levelling, slope_change_convex, step_bottom},
    {blade, step_top, step_top, step_top, wall_bend_convex},
}};

constexpr ShapeElement concave(ShapeElement shape) noexcept {
  switch (shape) {
    case wall_bend_convex: return wall_bend_concave;
    case slope_change_convex: return slope_change_concave;
    case weak_bend_convex: return weak_bend_concave;
    default: return shape;
  }
}

} // namespace

int slope_state(double theta) noexcept {
  if (std::abs(theta) < kFlat) return 0;
  const int size = std::abs(theta) >= kWall ? 2 : 1;
  return theta < 0.0 ? -size : size;
}

ShapeElement classify(double theta_before, double theta_after, double least_turning) noexcept {
  const double tau = theta_after - theta_before;
  if (std::abs(tau) < least_turning) return straight;
  const int row = slope_state(theta_before) + 2, column = slope_state(theta_after) + 2;
  const ShapeElement shape = kShapes[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  return tau > 0.0 ? concave(shape) : shape;
}

AngleClass angle_class(double inner_angle) noexcept {
  if (inner_angle < 30.0) return AngleClass::needle;
  if (inner_angle < 75.0) return AngleClass::acute;
  if (inner_angle < 105.0) return AngleClass::right;
  return inner_angle < 150.0 ? AngleClass::obtuse : AngleClass::flat;
}

Leaning leaning(double orientation) noexcept {
  const double size = std::abs(orientation);
  const double gamma = std::abs(size - 90.0);
  if (gamma < 15.0) return Leaning::upright;
  const bool left = size > 90.0; // the bisector points towards negative s
  if (gamma < 45.0) return left ? Leaning::leaning_left : Leaning::leaning_right;
  return left ? Leaning::lying_left : Leaning::lying_right;
}

int shape_distance(const FeaturePoint& a, const FeaturePoint& b) noexcept {
  return std::abs(slope_state(a.theta_before) - slope_state(b.theta_before)) +
         std::abs(slope_state(a.theta_after) - slope_state(b.theta_after));
}

} // namespace scansion
