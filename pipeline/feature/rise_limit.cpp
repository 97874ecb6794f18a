// The least of three limits.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/rise_limit.hpp"

#include "pipeline/feature/fit/steps.hpp"
#include "pipeline/feature/patch/jumps.hpp"
#include "pipeline/feature/profile/spikes.hpp"

namespace scansion {

double least_rise(const Sampling& sampling) noexcept {
  constexpr double kMargin = 0.9; // noise and pitch are estimated anew before jumps are looked for
  const double jump = kMargin * Jumps::least_rise(sampling, PatchRow::least_even_step(sampling.pitch));
  return std::min({spike_limit(sampling.noise), WallTest(sampling.noise, sampling.limits.least_step).weak, jump});
}

} // namespace scansion
