// Two by two, run by run.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/averaging.hpp"

#include <cmath>
#include <numbers>

namespace scansion {

bool wants_averaging(const Sampling& sampling) noexcept {
  constexpr double kDense = 0.15;  // noise against pitch
  constexpr double kWidest = 0.25; // mm: pairs further apart lose small features
  return sampling.noise > kDense * sampling.pitch && 2.0 * sampling.pitch <= kWidest;
}

FeatureSettings averaged(FeatureSettings settings) noexcept {
  if (settings.noise_mm) *settings.noise_mm /= std::numbers::sqrt2;
  return settings;
}

void average_pairs(const Profile& profile, const Sampling& sampling, ProfileRanker& ranker, Profile& out) {
  constexpr double kJump = 8.0, kHole = 1.5; // sigmas, pitches
  out.clear();
  out.line = profile.line;
  out.c = profile.c;
  out.turned = profile.turned;
  std::size_t begin = 0;
  for (const std::uint32_t end : profile.ends) {
    const std::size_t first = out.size();
    for (std::size_t k = begin; k < end;) {
      const bool pair = k + 1 < end && std::abs(profile.w[k + 1] - profile.w[k]) < kJump * sampling.noise &&
                        profile.s[k + 1] - profile.s[k] < kHole * sampling.pitch;
      const std::size_t other = pair ? k + 1 : k;
      out.s.push_back(0.5 * (profile.s[k] + profile.s[other]));
      out.w.push_back(0.5 * (profile.w[k] + profile.w[other]));
      out.source.push_back(profile.number(k));
      k = other + 1;
    }
    out.ends.push_back(static_cast<std::uint32_t>(out.size()));
    out.resize_distances(out.size());
    ranker.rank(out, first, out.size());
    begin = end;
  }
}

} // namespace scansion
