// Groups of made-up scan lines through the real ranking and codec.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/codec.hpp"
#include "pipeline/record/recording.hpp"

#include <string>
#include <vector>

namespace scansion::synthetic {

struct RealGroup {
  LineGroup lines;
  EncodedGroup encoded;
  std::uint64_t runs = 0;
  std::uint64_t invalid = 0;
};

/// `count` groups of `lines` lines, with noise, jumps, several runs, invalid samples, stamps, and lines without a point.
[[nodiscard]] std::vector<RealGroup> real_groups(const RecordingFacts& facts, std::uint32_t count, std::uint32_t lines,
                                                 std::uint32_t points_per_line);

/// Writes them as a recording with one gap message; false when anything failed.
[[nodiscard]] bool write_real(const std::string& path, const RecordingFacts& facts, const std::vector<RealGroup>& groups,
                              bool finish);

} // namespace scansion::synthetic
