// A feature line while it grows, lengthwise (from scan line to scan line) or crosswise (from column to column).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_point.hpp"
#include "pipeline/feature/link/double_ended.hpp"

#include <cmath>
#include <cstddef>

namespace scansion {

/// Which way a track runs.
enum class Pass : std::uint8_t {
  lengthwise, ///< r is c, q is s: found on scan lines
  crosswise   ///< r is s, q is c: found on columns
};

/// Whether a point stays when both passes are brought together.
enum class Verdict : std::uint8_t { open, kept, dropped };

/// A point of a track, in the coordinates of its pass: r the way it runs, q the place, w the height; mm.
struct TrackPoint {
  double r = 0.0, q = 0.0, w = 0.0;
  double smooth_q = 0.0, smooth_w = 0.0; ///< published place: after smoothing
  std::int64_t step = 0;                 ///< number of the scan line, or of the column
  FeaturePoint feature;
  Verdict verdict = Verdict::open;
  bool steep = false; ///< lengthwise: stands so steeply to the scan lines that no crosswise track is asked
};

/// What the next point is compared with: means over the track with a gain for the newest.
struct TrackMeans {
  double tau = 0.0, beta = 0.0, width = 0.0;
  void start(const FeaturePoint& point) noexcept;
  void follow(const FeaturePoint& point) noexcept;
};

/// How far something goes along the scan lines and across them, mm, neither below 0.
struct Course {
  double along = 0.0, across = 0.0;
  /// Does it stand at more than the angle of this tangent to the scan lines?
  [[nodiscard]] bool is_steeper(double tangent) const noexcept { return across > tangent * along; }
  /// Of its angle to them.
  [[nodiscard]] double cosine() const noexcept { return across > 0.0 ? along / std::hypot(along, across) : 1.0; }
};

struct Track {
  static constexpr std::uint64_t kCrosswiseBit = std::uint64_t{1} << 63U; ///< ids of both passes stay apart
  std::uint64_t id = 0;
  Pass pass = Pass::lengthwise;
  DoubleEnded<TrackPoint> points;
  TrackMeans means;
  FeatureEnd begins = FeatureEnd::death, ends = FeatureEnd::death;
  std::uint32_t misses = 0; ///< in a row
  std::uint32_t guided_in_row = 0;
  std::uint64_t near_id = 0;    ///< a longer track that runs beside it ...
  std::uint32_t near_lines = 0; ///< ... for so many lines in a row
  bool confirmed = false;
  bool growing = false; ///< lengthwise: its last point may get a successor
  std::size_t shed = 0; ///< points that stood before these and went ahead as curves
  bool goes_on = false; ///< the last of them was kept: the stretch at the front goes on from it

  [[nodiscard]] bool convex() const noexcept { return points.front().feature.convex(); }
  [[nodiscard]] double s_of(const TrackPoint& p) const noexcept { return pass == Pass::lengthwise ? p.smooth_q : p.r; }
  [[nodiscard]] double c_of(const TrackPoint& p) const noexcept { return pass == Pass::lengthwise ? p.r : p.smooth_q; }
  /// Points so far.
  [[nodiscard]] std::size_t size() const noexcept { return shed + points.size(); }
  /// Which way the track runs at point i.
  [[nodiscard]] Course course_at(std::size_t i) const noexcept;
  void cut_guided_end();
};

/// The way a track runs at one end.
struct Axis {
  double q = 0.0, w = 0.0, r = 0.0; ///< apex: its last point
  double slope_q = 0.0, slope_w = 0.0;
  double widening = 0.0; ///< tangent of half the opening of the cone of influence
};
enum class TrackEnd : std::uint8_t { front, back };
inline constexpr std::size_t kAxisPoints = 6;
/// Least squares over the last kAxisPoints points; less for a young track (paper, section 5: the cone's axis follows the line).
[[nodiscard]] Axis axis_of(const Track& track, TrackEnd end);

/// Confirmed: long, strong and sharp enough to be published.
[[nodiscard]] bool is_confirmed(const Track& track, double least_turning);

} // namespace scansion
