// A scan line on its way into patches.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile.hpp"

#include <cstdint>
#include <vector>

namespace scansion {

/// What patches need of a profile; buffers are used again.
struct PatchRow {
  std::uint64_t line = 0;
  double c = 0.0;           ///< mm
  std::vector<double> s, w; ///< mm
  std::vector<std::uint32_t> source, ends;

  void take(const Profile& profile) {
    line = profile.line;
    c = profile.c;
    s.assign(profile.s.begin(), profile.s.end());
    w.assign(profile.w.begin(), profile.w.end());
    source.assign(profile.source.begin(), profile.source.end());
    ends.assign(profile.ends.begin(), profile.ends.end());
  }
};

} // namespace scansion
