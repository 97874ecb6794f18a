// What can be set about feature lines and patches. Lengths in millimetres, angles in degrees.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace scansion {

/// Which rules link a point to a feature line.
enum class Linking : std::uint8_t {
  soft, ///< costs that add up
  paper ///< the three similarities as equalities (paper, section 5)
};

/// What becomes of the backlash of scans whose lines run to and fro.
enum class BacklashUse : std::uint8_t {
  report,
  correct ///< taken off where features are looked for, as soon as it is sure
};

/// What counts as a feature at all.
struct FeatureLimits {
  double least_turning = 7.0; ///< degrees: an edge that turns less is none (tau_min)
  double least_step = 0.09;   ///< mm: a lower step is none, and never one lower than 8 sigma of the noise
  double largest_arc = 3.0;   ///< mm: an arc of a larger radius is a smooth surface (r_arc); at least 6 u
  double shortest_line = 0.0; ///< mm: shorter lines part patches, but are not told of

  friend bool operator==(const FeatureLimits&, const FeatureLimits&) = default;
};

struct FeatureSettings {
  Linking linking = Linking::soft;
  BacklashUse backlash = BacklashUse::report;
  std::optional<double> noise_mm; ///< sigma of the height, found once on a flat target; empty: estimated line by line
  double noise_correlation = 1.0; ///< the estimate is multiplied by this; 3 for laser triangulation
  FeatureLimits limits;

  friend bool operator==(const FeatureSettings&, const FeatureSettings&) = default;
};

} // namespace scansion
