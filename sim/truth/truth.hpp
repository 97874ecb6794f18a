// What is truly there in a synthetic scan: feature curves, patches and forms, known in closed form.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scansion {

struct TrueCurve {
  FeatureType type = FeatureType::convex;
  bool closed = false;   ///< the first point follows the last
  bool optional = false; ///< there, but a scan need not show it: finding it is neither right nor wrong
  std::uint32_t feature = 0;
  double radius_mm = 0.0;                    ///< of the arc that rounds the edge; the curve runs where the flanks meet
  double wall_mm = 0.0;                      ///< height of the wall at a step; 0 elsewhere
  std::vector<std::array<double, 3>> points; ///< mm
};

struct TruePatch {
  FormKind kind = FormKind::face;
  std::uint64_t samples = 0;

  friend bool operator==(const TruePatch&, const TruePatch&) = default;
};

/// Place and size of a hole; its outline is the curve of the same feature.
struct TrueHole {
  std::array<double, 3> middle{}; ///< mm; on the surface around it
  double area_mm2 = 0.0;          ///< in plan

  friend bool operator==(const TrueHole&, const TrueHole&) = default;
};

struct TrueForm {
  FormKind kind = FormKind::face;
  std::uint32_t feature = 0;
  std::vector<std::uint32_t> patches; ///< of a hole: the one it lies in
  std::optional<TrueHole> hole{};

  friend bool operator==(const TrueForm&, const TrueForm&) = default;
};

/// `count` samples of one line that lie on one patch.
struct TrueRun {
  std::uint32_t count = 0, patch = 0;

  friend bool operator==(const TrueRun&, const TrueRun&) = default;
};

struct Truth {
  std::string scene, command;
  double pitch_mm = 0.0, spacing_mm = 0.0, noise_um = 0.0, direction_deg = 0.0, tilt_deg = 0.0;
  double area_mm2 = 0.0; ///< of the scan window
  std::vector<TrueCurve> curves;
  std::vector<TruePatch> patches;
  std::vector<TrueForm> forms;
  std::vector<std::vector<TrueRun>> lines; ///< the scan lines as written: those with a point, each in the order of its points
};

} // namespace scansion
