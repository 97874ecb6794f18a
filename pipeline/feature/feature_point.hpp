// A significant point of one profile: what the tracker links.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"
#include "pipeline/feature/settings.hpp"

#include <cstdint>

namespace scansion {

/// Angles in degrees, lengths in mm; s along the profile, w up.
struct FeaturePoint {
  double s = 0.0, w = 0.0; ///< refined place
  double sigma_s = 0.0;    ///< of s
  double theta_before = 0.0, theta_after = 0.0;
  double tau = 0.0, sigma_tau = 1.0; ///< turning: above 0 concave
  double sharpness = 0.0;            ///< Lambda
  double narrow_sharpness = 0.0;     ///< the same over the narrowest window, against an arc that is no feature; -4 to 4
  double width = 0.0;                ///< log2(D / least D)
  std::uint32_t k = 0;               ///< sample of the profile it was found at
  std::uint32_t sample = 0;          ///< the same, of the scan line
  std::uint64_t line = 0;            ///< scan line it was found on
  std::uint32_t window = 0;          ///< samples a side it was measured over; of a step: those that its rounding may reach
  std::int32_t partner = -1;         ///< the other edge of a step in the list of the profile
  FeatureType type = FeatureType::convex;
  ShapeElement element = ShapeElement::straight;
  bool step = false;   ///< from a wall between samples: its angles are nominal
  double drop = 0.0;   ///< of a step whose wall shows no sample: its height
  bool smooth = false; ///< a crest or trough
  bool guided = false;

  [[nodiscard]] bool convex() const noexcept { return tau < 0.0; }
  [[nodiscard]] double inner_angle() const noexcept { return 180.0 - (tau < 0.0 ? -tau : tau); } ///< delta
  [[nodiscard]] double orientation() const noexcept {                                            ///< beta
    return 0.5 * (theta_before + theta_after) + (tau > 0.0 ? 90.0 : -90.0);
  }
};

/// -2 wall down, -1 down, 0 flat, 1 up, 2 wall up.
[[nodiscard]] int slope_state(double theta) noexcept;
/// The primitive shape of a triplet (after Tab. 1 of the paper): total over all pairs of slope states.
[[nodiscard]] ShapeElement classify(double theta_before, double theta_after,
                                    double least_turning = FeatureLimits{}.least_turning) noexcept;

/// delta (after Tab. 2 of the paper).
enum class AngleClass : std::uint8_t { needle, acute, right, obtuse, flat };
[[nodiscard]] AngleClass angle_class(double inner_angle) noexcept;
/// beta (after Tab. 2 of the paper).
enum class Leaning : std::uint8_t { upright, leaning_left, leaning_right, lying_left, lying_right };
[[nodiscard]] Leaning leaning(double orientation) noexcept;

/// Distance of two shapes of one polarity: steps between their slope states.
[[nodiscard]] int shape_distance(const FeaturePoint& a, const FeaturePoint& b) noexcept;

} // namespace scansion
