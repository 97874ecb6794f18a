// A spike is higher or lower than both neighbours, which agree with each other.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/spikes.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

void clean_spikes(Profile& profile, double noise, ProfileRanker* ranker) {
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
    if (found && ranker != nullptr) ranker->rank(profile, first, last);
    first = last;
  }
}

} // namespace scansion
