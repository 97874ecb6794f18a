// Curves to feature lines: positions in the recording's frame, and what is said about each line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/curve.hpp"
#include "pipeline/feature/sampling.hpp"
#include "pipeline/feature/thinning.hpp"
#include "pipeline/model/alpha_set.hpp"

#include <vector>

namespace scansion {

/// Thread-bound: holds scratch.
class Publisher {
public:
  /// `origin` in mm.
  explicit Publisher(const Vector3& origin) : origin_(origin) {}
  [[nodiscard]] FeatureLine publish(const Curve& curve, const Frame& frame, const Sampling& sampling, const AlphaSet& alpha);

private:
  Vector3 origin_;
  Thinner thinner_;
  std::vector<std::uint64_t> rows_;
  std::vector<double> widths_;
};

} // namespace scansion
