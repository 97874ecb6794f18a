// A spike is higher or lower than both neighbours, which agree with each other.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/spikes.hpp"

#include "pipeline/feature/passes.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

void clean_spikes(Profile& profile, double noise, ProfileRanker* ranker, std::vector<std::uint32_t>& scratch) {
  constexpr double kSigmas = 7.0;
  constexpr double kLeast = 0.12; // mm
  const double limit = std::max(kSigmas * noise, kLeast);
  scratch.resize(profile.size());
  std::size_t first = 0;
  for (const std::uint32_t end : profile.ends) {
    const std::size_t last = end;
    double* const w = profile.w.data() + first;
    bool found = false;
    // On both sides of a spike the step is high; cleaning one makes no step higher.
    const std::size_t count = passes::apart(w + 1, w, limit, scratch.data(), last - first - 1);
    for (std::size_t i = 1; i < count; ++i) {
      const std::uint32_t k = scratch[i];
      if (scratch[i - 1] + 1 != k) continue;
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
