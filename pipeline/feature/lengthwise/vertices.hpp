// The working set of a profile: points ranked above the noise, each with its neighbours at its own level of detail.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/profile.hpp"

#include <vector>

namespace scansion {

/// The triplet of a point (paper, section 5): neighbours are the nearest points ranked at least half as high.
struct Vertex {
  std::uint32_t k = 0;                 ///< sample
  std::uint32_t before = 0, after = 0; ///< samples
};

/// All points with D >= `least` that are no ends of a run, in order. `stack` is scratch.
void find_vertices(const Profile& profile, double least, std::vector<std::uint32_t>& scratch, std::vector<Vertex>& out);

} // namespace scansion
