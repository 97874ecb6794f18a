// A spike is higher or lower than both neighbours, which agree with each other.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/spikes.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr std::size_t kBlock = 64; // samples

// Whether any step from samples [first, last) to the next one is higher than the limit.
bool has_steps(const double* w, std::size_t first, std::size_t last, double limit) {
  int seen = 0;
  for (std::size_t k = first; k < last; ++k) seen |= static_cast<int>(std::abs(w[k + 1] - w[k]) > limit);
  return seen != 0;
}

} // namespace

void clean_spikes(Profile& profile, double noise, ProfileRanker* ranker) {
  constexpr double kSigmas = 7.0;
  constexpr double kLeast = 0.12; // mm
  const double limit = std::max(kSigmas * noise, kLeast);
  std::size_t first = 0;
  for (const std::uint32_t end : profile.ends) {
    const std::size_t last = end;
    bool found = false;
    for (std::size_t block = first + 1; block + 1 < last; block += kBlock) {
      const std::size_t block_end = std::min(block + kBlock, last - 1);
      if (!has_steps(profile.w.data(), block, block_end, limit)) continue; // most blocks
      for (std::size_t k = block; k < block_end; ++k) {
        const double before = profile.w[k] - profile.w[k - 1], after = profile.w[k] - profile.w[k + 1];
        if (std::min(std::abs(before), std::abs(after)) <= limit) continue;
        if ((before > 0.0) != (after > 0.0) || std::abs(before - after) >= limit) continue;
        profile.w[k] = 0.5 * (profile.w[k - 1] + profile.w[k + 1]);
        ++profile.spikes;
        found = true;
      }
    }
    if (found && ranker != nullptr) ranker->rank(profile, first, last);
    first = last;
  }
}

} // namespace scansion
