// How sure the points of a track or curve are together (docs/FEATURES.md, "Lines").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_point.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace scansion {

/// Gathers points; all figures are means over them.
class Evidence {
public:
  void add(const FeaturePoint& point) noexcept {
    constexpr double kSharpest = 6.0, kSurest = 40.0;
    ++points_;
    turning_ += std::abs(point.tau);
    sharpness_ += std::min(point.sharpness, kSharpest);
    if (!point.step && !point.smooth) {
      ++bends_;
      narrow_ += point.narrow_sharpness;
    }
    if (!point.step) significance_ += std::min(kSurest, narrow_significance(point));
  }
  [[nodiscard]] double turning() const noexcept { return turning_ / static_cast<double>(points_); } ///< degrees
  [[nodiscard]] double sharpness() const noexcept { return sharpness_ / static_cast<double>(points_); }
  /// Whether an arc too wide to be a feature explains the points: each is asked over its narrowest window, since over wider
  /// ones a wave or a wide rounding looks more like a broken line than like a parabola.
  [[nodiscard]] bool is_arc() const noexcept {
    constexpr std::size_t kFewest = 8;
    constexpr double kLeast = 0.8;
    return bends_ >= kFewest && says(narrow_ < kLeast * static_cast<double>(bends_));
  }
  /// Whether the same question speaks for an edge.
  [[nodiscard]] bool is_edge() const noexcept {
    constexpr double kLeast = 1.0, kSharpness = 3.5;
    return says(narrow_ >= kLeast * static_cast<double>(bends_)) && sharpness() >= kSharpness;
  }
  /// Whether so few points suffice although they turn little: corners so sharp against the noise are seen in a handful of
  /// samples.
  [[nodiscard]] bool is_sure() const noexcept {
    constexpr std::size_t kFewest = 4, kFew = 5;
    constexpr double kTurning = 10.0, kSharpness = 4.5, kSignificance = 5.0;
    if (points_ < kFewest || turning() < kTurning || sharpness() < kSharpness) return false;
    return significance_ >= (points_ < kFew ? 2.0 : 1.0) * kSignificance * static_cast<double>(points_);
  }

private:
  // Only where most points were asked: steps and crests are not.
  [[nodiscard]] bool says(bool answer) const noexcept { return answer && 2 * bends_ > points_; }
  // The significance that the turning would have over the narrowest window. Over wide ones an arc is as significant as a
  // corner.
  static double narrow_significance(const FeaturePoint& point) noexcept {
    constexpr double kNarrow = 5.0; // samples
    const double share = std::min(1.0, kNarrow / std::max(1.0, static_cast<double>(point.window)));
    return std::abs(point.tau) / point.sigma_tau * share * std::sqrt(share);
  }

  std::size_t points_ = 0, bends_ = 0;
  double turning_ = 0.0, sharpness_ = 0.0, significance_ = 0.0, narrow_ = 0.0;
};

} // namespace scansion
