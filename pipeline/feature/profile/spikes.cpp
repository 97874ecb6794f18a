// A spike is higher or lower than both neighbours, which agree with each other.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/spikes.hpp"

#include "pipeline/feature/profile/rises.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

double spike_limit(double noise) noexcept {
  constexpr double kSigmas = 7.0;
  constexpr double kLeast = 0.12; // mm
  return std::max(kSigmas * noise, kLeast);
}

void clean_spikes(Profile& profile, double noise, ProfileRanker* ranker) {
  const double limit = spike_limit(noise);
  double* const w = profile.w.data();
  std::uint32_t first = 0;
  for (const std::uint32_t last : profile.ends) {
    bool found = false;
    // On both sides of a spike the step is high; cleaning one makes no step higher.
    const std::span<const std::uint32_t> high = rises_of(profile.rises, first, last);
    for (std::size_t i = 1; i < high.size(); ++i) {
      const std::uint32_t k = high[i];
      if (high[i - 1] + 1 != k) continue;
      const double before = w[k] - w[k - 1], after = w[k] - w[k + 1];
      if (std::min(std::abs(before), std::abs(after)) <= limit) continue;
      if ((before > 0.0) != (after > 0.0) || std::abs(before - after) >= limit) continue;
      w[k] = 0.5 * (w[k - 1] + w[k + 1]);
      ++profile.spikes;
      found = true;
    }
    if (found && ranker != nullptr) ranker->rank(profile, first, last);
    first = last;
  }
}

} // namespace scansion
