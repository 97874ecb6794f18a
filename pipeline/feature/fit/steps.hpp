// Steps: walls that fall between samples, or over a few of them, with their upper and lower edge.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_point.hpp"
#include "pipeline/feature/fit/local_fit.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace scansion {

/// The samples of one wall: first..last, with what rounds its edges low..high.
struct WallRun {
  std::uint32_t first = 0, last = 0, low = 0, high = 0;
  bool step = false; ///< short enough to be a step
};

/// Which intervals between samples are walls; lengths in mm.
struct WallTest {
  static constexpr double kSlope = 2.7474774194546; ///< tan 70
  static constexpr double kLonely = 0.35;           ///< of its rise: a neighbour that rises less does not go on with a wall
  static constexpr std::uint32_t kBeside = 3;       ///< intervals on each side of a wall that are asked whether it goes on
  double strong, weak;                              ///< least rise of a wall: by its slope; by standing out from its neighbours
  double noise;                                     ///< four sigma
  WallTest(double sigma, double least_step) noexcept;
  explicit WallTest(const FitScale& scale) noexcept : WallTest(scale.noise, scale.least_step) {}

  /// What rises more is steep: slopes of 60 to 70 degrees are not for their noise.
  [[nodiscard]] double steep_rise(double ds) const noexcept {
    constexpr double kMargin = 0.5; // two sigma
    return std::max(strong, kSlope * ds + kMargin * noise);
  }
  /// Whether an interval is large enough to start a wall.
  [[nodiscard]] bool may_seed(double ds, double dw) const noexcept { return std::abs(dw) > least_rise(ds); }
  [[nodiscard]] double least_rise(double ds) const noexcept { return std::max(weak, 0.5 * ds); }
  /// Whether one that is large enough starts one by itself; `before`, `after`: height differences of its neighbours, not a
  /// number: none.
  [[nodiscard]] bool stands_out(double ds, double dw, double before, double after) const noexcept {
    const double size = std::abs(dw);
    if (size > steep_rise(ds)) return true;
    return !(std::abs(before) >= kLonely * size) && !(std::abs(after) >= kLonely * size);
  }
  /// Whether a wall is upright within this interval: its neighbours' differences show no slope that would go on.
  [[nodiscard]] bool is_upright(double ds, double dw, double before, double after) const noexcept {
    constexpr double kSteeper = 1.6, kTan75 = 3.7320508075689;
    const double size = std::abs(dw);
    return size > strong && size > kTan75 * ds && !(kSteeper * std::abs(before) >= size) &&
           !(kSteeper * std::abs(after) >= size);
  }
  /// Whether a short wall is but a piece of a slope that the noise has broken up. All are means of an interval: `ds`, `dw` of
  /// the wall, `before`, `after` of kBeside intervals on each side, not a number: none.
  [[nodiscard]] bool is_piece(double ds, double dw, double before, double after) const noexcept {
    constexpr double kLike = 0.4;
    const double sign = dw < 0.0 ? -1.0 : 1.0, least = kLike * std::abs(dw);
    return noise > 0.25 * kSlope * ds && (sign * before > least || sign * after > least);
  }
  /// Whether an interval belongs to a wall beside it.
  [[nodiscard]] bool grows(double ds, double dw, bool rising) const noexcept {
    const double size = rising ? dw : -dw;
    return size > 0.5 * kSlope * ds && size > noise;
  }
};
inline constexpr std::uint32_t kMostIntervals = 6; ///< of a step: a longer wall is sampled well enough to be ranked
inline constexpr std::uint32_t kMostRounded = 40;  ///< intervals of a step whose wall is upright between roundings

/// Adds all walls of the run of samples [begin, end), counted from the start of the profile, and tells which are steps.
void find_walls(const Heights& heights, std::uint32_t begin, std::uint32_t end, const FitScale& scale,
                std::vector<WallRun>& walls);

/// Adds both edges of step i of these walls of the run [begin, end), in order of s and tied to each other, and gives the wall
/// what rounds its edges.
void measure_step(const Heights& heights, std::uint32_t begin, std::uint32_t end, std::span<WallRun> walls, std::size_t i,
                  const FitScale& scale, std::vector<FeaturePoint>& out);

/// Whether what rounds the edges of step i may reach as far as s. Takes less than to measure it.
[[nodiscard]] bool may_round_to(const Heights& heights, std::uint32_t begin, std::uint32_t end, std::span<const WallRun> walls,
                                std::size_t i, const FitScale& scale, double s);

/// Both for all steps of a run: adds their edges and its walls. `rises`: the sample before each interval that may start a wall.
void find_steps(const Heights& heights, std::uint32_t begin, std::uint32_t end, std::span<const std::uint32_t> rises,
                const FitScale& scale, std::vector<FeaturePoint>& out, std::vector<WallRun>& walls);

} // namespace scansion
