// A finished stretch of a track, or several joined end to end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/frame.hpp"
#include "pipeline/feature/track.hpp"

#include <vector>

namespace scansion {

/// In the frame of the scan, mm.
struct CurvePoint {
  double s = 0.0, w = 0.0, c = 0.0;
  FeaturePoint feature;
  std::int64_t row = -1; ///< scan line, as counted by the stage; -1: found between lines
};

struct Curve {
  std::vector<CurvePoint> points;
  bool convex = true;
  bool loop = false;
  FeatureEnd begins = FeatureEnd::death, ends = FeatureEnd::death;
  std::uint64_t order = 0; ///< when it was made: ties go by it

  void reverse();
};

/// The stretches of a track that were kept, at least `fewest` points each.
void cut_stretches(const Track& track, std::size_t fewest, std::vector<Curve>& out);

/// Plan length, mm.
[[nodiscard]] double length_of(const Curve& curve) noexcept;

} // namespace scansion
