// The least of three limits.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/rises.hpp"

#include "pipeline/feature/jumps.hpp"
#include "pipeline/feature/passes.hpp"
#include "pipeline/feature/spikes.hpp"
#include "pipeline/feature/steps.hpp"

namespace scansion {

void note_rises(Profile& profile, const Sampling& sampling, std::vector<std::uint32_t>& scratch) {
  constexpr double kMargin = 0.9; // noise and pitch are estimated anew before jumps are looked for
  const double jump = kMargin * Jumps::least_rise(sampling, PatchRow::least_even_step(sampling.pitch));
  const std::size_t n = profile.size();
  profile.rises_above = std::min({spike_limit(sampling.noise), WallTest(sampling.noise).weak, jump});
  scratch.resize(n);
  const double* const w = profile.w.data();
  const std::size_t found = n == 0 ? 0 : passes::apart(w + 1, w, profile.rises_above, scratch.data(), n - 1);
  profile.rises.assign(scratch.begin(), scratch.begin() + static_cast<std::ptrdiff_t>(found));
}

std::span<const std::uint32_t> rises_of(std::span<const std::uint32_t> rises, std::uint32_t begin, std::uint32_t end) noexcept {
  if (rises.empty() || (rises.front() >= begin && rises.back() + 1 < end)) return rises;
  const auto first = std::lower_bound(rises.begin(), rises.end(), begin);
  return {first, std::lower_bound(first, rises.end(), end - 1)};
}

} // namespace scansion
