// Counts from the first vertex on, ranked.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/thinning.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr double kMostSpan = 1073741824.0; // counts

double span_of(const std::vector<FeatureVertex>& vertices) {
  double span = 0.0;
  for (const FeatureVertex& v : vertices)
    for (std::size_t i = 0; i < 3; ++i) span = std::max(span, std::abs(v.position[i] - vertices.front().position[i]));
  return span;
}

} // namespace

std::uint32_t Thinner::thin(std::vector<FeatureVertex>& vertices, double tolerance) {
  constexpr std::uint32_t kFinest = 1'000'000;
  if (vertices.empty()) return 1;
  const double span = span_of(vertices);
  std::uint32_t per_mm = 1;
  while (per_mm < kFinest && per_mm * tolerance < 10.0 && 10.0 * per_mm * span < kMostSpan) per_mm *= 10;
  const bool fits = per_mm * span < kMostSpan;
  std::array<double, 3> first{};
  for (std::size_t i = 0; i < 3; ++i) {
    first[i] = std::nearbyint(vertices.front().position[i] * per_mm);
    counts_[i].clear();
  }
  for (FeatureVertex& v : vertices) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double count = std::nearbyint(v.position[i] * per_mm);
      v.position[i] = count / per_mm;
      if (fits) counts_[i].push_back(static_cast<std::int32_t>(count - first[i]));
    }
  }
  if (!fits || vertices.size() < 3) return per_mm;
  distance_.resize(vertices.size());
  depth_.resize(vertices.size());
  const double limit = tolerance * per_mm;
  ranker_.set_floor(limit); // what lies within is not told apart any further
  ranker_.rank({counts_[0], counts_[1], counts_[2], {}}, distance_, depth_);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    if (distance_[k] > limit) vertices[kept++] = vertices[k];
  vertices.resize(kept);
  return per_mm;
}

} // namespace scansion
