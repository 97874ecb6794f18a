// From millimetres back to counts, and through the ranker.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/profile_ranker.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

void ProfileRanker::rank(Profile& profile, std::size_t first, std::size_t last) {
  const std::size_t n = last - first;
  constexpr double kFar = 2e9; // counts: what a lattice holds
  const double s0 = profile.s[first], w0 = profile.w[first];
  s_.resize(n);
  w_.resize(n);
  zero_.assign(n, 0);
  distance_.resize(n);
  depth_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double s = std::clamp((profile.s[first + k] - s0) / resolution_, -kFar, kFar);
    const double w = std::clamp((profile.w[first + k] - w0) / resolution_, -kFar, kFar);
    s_[k] = static_cast<std::int32_t>(std::lround(s));
    w_[k] = static_cast<std::int32_t>(std::lround(w));
  }
  ranker_.rank({s_, w_, zero_, {}}, distance_, depth_);
  std::copy(distance_.begin(), distance_.end(), profile.own_distances().begin() + static_cast<std::ptrdiff_t>(first));
}

} // namespace scansion
