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
  std::int64_t first_column = 0;       ///< at this multiple of the pitch ...
  std::vector<std::uint32_t> standing; ///< ... and on: the sample that stands there, or kNoSample; empty: not looked for
  static constexpr std::uint32_t kNoSample = 0xffffffffU;

  /// Fills `standing`, once.
  void find_columns(double pitch);
  [[nodiscard]] std::uint32_t at(std::int64_t column) const noexcept {
    const auto j = static_cast<std::size_t>(column - first_column); // what lies before wraps to beyond the end
    return j < standing.size() ? standing[j] : kNoSample;
  }

  [[nodiscard]] std::int64_t end_column() const noexcept { return first_column + static_cast<std::int64_t>(standing.size()); }

  void take(const Profile& profile) {
    standing.clear();
    line = profile.line;
    c = profile.c;
    s.assign(profile.s.begin(), profile.s.end());
    w.assign(profile.w.begin(), profile.w.end());
    source.assign(profile.source.begin(), profile.source.end());
    ends.assign(profile.ends.begin(), profile.ends.end());
  }
};

} // namespace scansion
