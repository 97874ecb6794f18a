// Curves to feature lines: positions in the recording's frame, and what is said about each line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/line/curve.hpp"
#include "pipeline/feature/line/thinning.hpp"
#include "pipeline/feature/patch/hole_outline.hpp"
#include "pipeline/feature/profile/sampling.hpp"
#include "pipeline/model/alpha_set.hpp"

#include <vector>

namespace scansion {

/// Thread-bound: holds scratch.
class Publisher {
public:
  /// `origin` in mm.
  explicit Publisher(const Vector3& origin) : origin_(origin) {}
  [[nodiscard]] FeatureLine publish(const Curve& curve, const Frame& frame, const Sampling& sampling, const AlphaSet& alpha);
  /// The rim of a hole. Nothing was measured below it, so that its angles are unknown: 0.
  [[nodiscard]] FeatureLine publish(const HoleOutline& hole, std::uint64_t id, const Frame& frame, const Sampling& sampling);
  /// In the recording's frame.
  [[nodiscard]] Vector3 position(const Frame& frame, double s, double w, double c) const;

private:
  Vector3 origin_;
  Thinner thinner_;
  std::vector<std::uint64_t> rows_;
  std::vector<double> widths_;
};

} // namespace scansion
