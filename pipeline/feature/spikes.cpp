// A spike is higher or lower than both neighbours, which agree with each other.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/spikes.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

void SpikeFilter::clean(Profile& profile, double noise) {
  constexpr double kSigmas = 7.0;
  constexpr double kLeast = 0.12; // mm
  const double limit = std::max(kSigmas * noise, kLeast);
  std::size_t first = 0;
  for (const std::uint32_t end : profile.ends) {
    const std::size_t last = end;
    bool found = false;
    for (std::size_t k = first + 1; k + 1 < last; ++k) {
      const double before = profile.w[k] - profile.w[k - 1], after = profile.w[k] - profile.w[k + 1];
      if (std::min(std::abs(before), std::abs(after)) <= limit) continue;
      if ((before > 0.0) != (after > 0.0) || std::abs(before - after) >= limit) continue;
      profile.w[k] = 0.5 * (profile.w[k - 1] + profile.w[k + 1]);
      ++profile.spikes;
      found = true;
    }
    if (found) rank_again(profile, first, last);
    first = last;
  }
}

void SpikeFilter::rank_again(Profile& profile, std::size_t first, std::size_t last) {
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
  std::copy(distance_.begin(), distance_.end(), profile.distance.begin() + static_cast<std::ptrdiff_t>(first));
}

} // namespace scansion
