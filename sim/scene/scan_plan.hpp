// How a scene is scanned: what the user asks for, and the geometry that follows from it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "sim/scene/portable_math.hpp"
#include "sim/scene/scene.hpp"

#include <cstdint>
#include <optional>

namespace scansion {

/// Everything that may be asked of a scan. Empty: the scene's own value. Shares are 0 to 1.
struct ScanPlan {
  std::optional<std::uint32_t> lines;  ///< scan lines, the missing ones counted too
  std::optional<std::uint32_t> points; ///< samples a line (their mean where lines differ), the missing ones counted too
  std::optional<double> pitch_mm;      ///< from sample to sample
  std::optional<double> spacing_mm;    ///< from line to line
  double direction_deg = 0.0;          ///< of the scan lines in plan, from the x axis
  double tilt_deg = 0.0;               ///< lean of the scan plane, towards the next line at positive heights; -45 to 45
  std::uint64_t seed = 1;
  std::optional<double> noise_um; ///< sigma along the scan plane's height direction
  double correlated_mm = 0.0;     ///< the noise's correlation falls to 1/e over this length along the line; 0: white
  double jitter = 0.0;            ///< samples leave their place by up to half this share of the pitch
  double outliers = 0.0;          ///< share of samples with a spike of 0.3 to 5 mm
  double dropouts = 0.0;          ///< share of samples that are missing: half of them singly, half in bursts of 2 to 20
  double missing_lines = 0.0;     ///< share of lines that are missing
  bool zigzag = false;            ///< odd lines are scanned backwards
  double backlash_um = 0.0; ///< of zigzag scans: the points of odd lines are told to lie so far along the line from their place
};

/// The scan in numbers. Lengths in micrometres, so that whole steps stay exact; the scan window is centred on the part.
struct ScanGeometry {
  std::uint32_t lines = 0;
  std::uint64_t samples = 0;             ///< in all lines
  std::uint64_t weight = 0;              ///< of all lines, see line_weight
  std::uint32_t points = 0;              ///< samples a line; the mean where lines follow the part's silhouette
  double pitch = 0.0, spacing = 0.0;     ///< um
  double window = 0.0;                   ///< length of the scan window, um
  double centre_x = 0.0, centre_y = 0.0; ///< um
  SinCos direction;
  SinCos tilt;
  double noise = 0.0; ///< um
};

/// Checks `plan` and derives the geometry; fails with usage, naming the option, its value and what is possible.
[[nodiscard]] Result<ScanGeometry> plan_scan(const Scene& scene, const ScanPlan& plan);

/// What part of all samples line `line` of `lines` gets: this weight over ScanGeometry::weight.
[[nodiscard]] std::uint64_t line_weight(const Scene& scene, std::uint32_t line, std::uint32_t lines) noexcept;

} // namespace scansion
