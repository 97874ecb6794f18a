// Two straight lines fitted beside a place of a profile: how much it bends there, where exactly, and how sharply.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/sampling.hpp"

#include <cstdint>
#include <span>

namespace scansion {

/// A run of heights over places; also a column of heights over lines.
struct Heights {
  std::span<const double> s, w; ///< mm, s ascending
  [[nodiscard]] std::size_t size() const noexcept { return s.size(); }
};

inline constexpr double kNarrowSharpest = 4.0; ///< what speaks for a corner no more than this, or against it

/// Angles in degrees, lengths in mm.
struct Bend {
  double s = 0.0, w = 0.0; ///< where the two lines meet, or the sample itself
  double theta_before = 0.0, theta_after = 0.0;
  double tau = 0.0, sigma_tau = 1.0;         ///< turning and its standard deviation
  double sharpness = 0.0;                    ///< Lambda: log likelihood of a corner over that of an arc
  double narrow_sharpness = kNarrowSharpest; ///< Lambda over the narrowest window, against an arc that is no feature
  double misfit = 0.0;                       ///< variance about the broken line over that of the noise
  std::uint32_t window = 0;                  ///< samples a side that were asked for
  bool fitted = false;                       ///< both sides had enough samples
  double rounding = 0.0;                     ///< radius of what rounds the edge, when its flanks were found beyond
  std::uint32_t flank_after = 0;             ///< and the first sample of the one behind it

  [[nodiscard]] double significance() const noexcept;
};

inline constexpr double kLeastTurning = FeatureLimits{}.least_turning, kLeastStep = FeatureLimits{}.least_step;

/// Windows and limits that follow from the sampling.
struct FitScale {
  double noise = 0.0, pitch = 0.0;      ///< mm
  std::uint32_t least_window = 5;       ///< N0: samples a side for a slope within 1.5 degrees
  double arc_radius = 3.0;              ///< r_arc: an arc of a larger radius is no feature
  double least_turning = kLeastTurning; ///< degrees: less is straight
  double least_step = kLeastStep;       ///< mm: height of a step
  std::uint32_t widest_gap = 0;         ///< samples from an edge to the flank beyond the widest rounding
  std::uint32_t telling_flank = 0;      ///< samples of a straight stretch that is no part of such a rounding

  /// Of a height, mm2: that of the noise and of half a micrometre, by which counts are rounded.
  [[nodiscard]] double variance() const noexcept { return noise * noise + 2.5e-7; }
  /// Samples a side for a slope within 1.5 degrees, or less where edges may turn less than by default; at most 24.
  static std::uint32_t wanted_window(double noise, double pitch, double least_turning) noexcept;
  /// Of a height, mm: that of the noise and of rounding to counts.
  [[nodiscard]] double sigma() const noexcept { return noise + 0.0005; }
  static FitScale of(double noise, double pitch, double coarse, const FeatureLimits& limits = {}) noexcept;
};

/// Fits `window` samples a side of sample k, not beyond `before` and `after`.
[[nodiscard]] Bend fit_bend(const Heights& heights, std::uint32_t k, std::uint32_t before, std::uint32_t after,
                            std::uint32_t window, const FitScale& scale);

/// Samples that a fit may use: up to the neighbours of its triplet, and for what lies beyond a rounding all of the run.
struct Reach {
  std::uint32_t before = 0, after = 0, first = 0, last = 0;
};

/// Tries windows of 1, 2, 4 and 8 times the least one and takes the first that shows a clear corner, else the sharpest. Empty:
/// what is there is an arc or too weak.
[[nodiscard]] std::optional<Bend> find_bend(const Heights& heights, std::uint32_t k, const Reach& reach, const FitScale& scale);

/// A sharp edge beside: the least window showed it best, and nothing rounded it. An edge is taken for as sharp as the one
/// before three times in a row; the fourth time everything is tried.
struct Precedent {
  bool sharp = false, clockwise = false;
  std::uint8_t followed = 0; ///< times in a row

  [[nodiscard]] static Precedent of(const Bend& bend, const FitScale& scale) noexcept;
  [[nodiscard]] bool applies(bool to_clockwise) const noexcept {
    return sharp && clockwise == to_clockwise && followed < kMostFollowed;
  }
  [[nodiscard]] Precedent next() const noexcept { return {sharp, clockwise, static_cast<std::uint8_t>(followed + 1)}; }

private:
  static constexpr std::uint8_t kMostFollowed = 3;
};

/// What find_bend() would find if there is a sharp edge as before. Empty: find_bend() is to be asked. No sample beyond
/// `reach.before` and `reach.after` is looked at.
[[nodiscard]] std::optional<Bend> find_sharp_bend(const Heights& heights, std::uint32_t k, const Reach& reach, bool clockwise,
                                                  const FitScale& scale);

/// The smooth crest or trough around sample k: vertex of a parabola over +-`reach` mm. Empty: none with a radius up to
/// `radius_limit`.
[[nodiscard]] std::optional<Bend> find_crest(const Heights& heights, std::uint32_t k, std::uint32_t before, std::uint32_t after,
                                             double radius_limit, const FitScale& scale);

inline constexpr double kLeastSignificance = 3.5; ///< sigmas

} // namespace scansion
