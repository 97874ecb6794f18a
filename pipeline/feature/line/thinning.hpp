// The vertices of a feature line that matter.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"
#include "pipeline/rank/rank.hpp"

#include <vector>

namespace scansion {

/// Douglas-Peucker over a line in space. Thread-bound: holds scratch.
class Thinner {
public:
  Thinner() : ranker_(Rational{1, 1}) {}
  /// Rounds positions to whole counts, a power of ten of them per mm, and drops the vertices that lie within `tolerance` mm of
  /// what is left. A count is a tenth of the tolerance or less, but never so small that the line spans 2^30 of them. Returns
  /// counts per mm.
  [[nodiscard]] std::uint32_t thin(std::vector<FeatureVertex>& vertices, double tolerance);

private:
  Ranker ranker_;
  std::array<std::vector<std::int32_t>, 3> counts_;
  std::vector<double> distance_;
  std::vector<std::uint32_t> depth_;
};

} // namespace scansion
