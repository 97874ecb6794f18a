// Outlines of features in plan: exact signed distances to half planes, strips and round-cornered boxes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace scansion {

struct PlanVector {
  double x = 0.0, y = 0.0;
};

/// A place on a curve in plan. Across a border the surface changes along `out`; on a crest (where the distances to two borders
/// are equal) `out` and `other` point to these.
struct OutlinePoint {
  double x = 0.0, y = 0.0;
  double distance = 0.0; ///< from the footprint's border there
  PlanVector out, other; ///< unit vectors, away from the region's middle
};

struct OutlineCurve {
  bool closed = false; ///< the first point follows the last
  std::vector<OutlinePoint> points;
};

/// A rectangle along the axes, mm.
struct Box {
  double x_low = 0.0, x_high = 0.0, y_low = 0.0, y_high = 0.0;

  [[nodiscard]] bool holds(double x, double y) const noexcept { return x >= x_low && x <= x_high && y >= y_low && y <= y_high; }
  friend bool operator==(const Box&, const Box&) = default;
};

/// A region of the plane with the exact distance to its border, negative inside. Level curves of the distance are the
/// region's offset curves, so every border of a feature is known in closed form. Lengths in mm, angles in degrees.
class Footprint {
public:
  /// The side of the line through (x, y) to which (-sin, cos) of `degrees` points is outside.
  [[nodiscard]] static Footprint half_plane(double x, double y, double degrees) noexcept;
  /// Everything within `half_width` of the line through (x, y) in direction `degrees`.
  [[nodiscard]] static Footprint strip(double x, double y, double degrees, double half_width) noexcept;
  /// A box of full size `length` by `width` with its length in direction `degrees` and corners of radius `corner`, at most half
  /// the smaller side. With corner = width / 2 it is a slot with round ends.
  [[nodiscard]] static Footprint round_box(double x, double y, double length, double width, double corner,
                                           double degrees = 0.0) noexcept;
  [[nodiscard]] static Footprint disc(double x, double y, double radius) noexcept;

  [[nodiscard]] double distance(double x, double y) const noexcept;
  /// Holds every point whose distance is at most `reach`.
  [[nodiscard]] Box box(double reach) const noexcept;

  enum class Kind : std::uint8_t { half_plane, strip, round_box };
  [[nodiscard]] Kind kind() const noexcept { return kind_; }
  /// Of its sides, the longer to the shorter; huge where it has no end.
  [[nodiscard]] double aspect() const noexcept;

  /// Of a box.
  [[nodiscard]] PlanVector middle() const noexcept { return {x_, y_}; }
  [[nodiscard]] double area() const noexcept;
  [[nodiscard]] double perimeter() const noexcept;

  /// The least distance of any place, 0 or below; huge and negative for a half plane.
  [[nodiscard]] double inmost() const noexcept;

  /// Every place at `distance` from the border, a point each `step` mm; smooth curves, so a sharp corner begins a new one.
  /// Endless lines run as far as `window` reaches.
  [[nodiscard]] std::vector<OutlineCurve> level_curves(double distance, double step, const Box& window) const;
  /// The places where the nearest place of the border changes from one side to another: the middle line of a strip, the roof
  /// lines of a box. Rounded corners end them.
  [[nodiscard]] std::vector<OutlineCurve> crests(double step, const Box& window) const;
  /// Which side's border is nearest: numbers that differ on both sides of a crest.
  [[nodiscard]] int sector(double x, double y) const noexcept;

private:
  Footprint(Kind kind, double x, double y, double degrees, double a, double b, double radius) noexcept;

  [[nodiscard]] OutlinePoint in_plan(double u, double v, double distance, PlanVector out, PlanVector other) const noexcept;
  [[nodiscard]] OutlineCurve segment(PlanVector from, PlanVector to, double step, PlanVector out, PlanVector other) const;
  [[nodiscard]] OutlineCurve endless(double v, double step, const Box& window, PlanVector out, PlanVector other) const;
  [[nodiscard]] OutlineCurve rounded(double radius, double step) const;

  Kind kind_;
  double x_, y_;          // centre, or a point of the line
  double cos_, sin_;      // direction of the local first axis
  double a_, b_, radius_; // half sizes of the core that the radius is added to
};

} // namespace scansion
