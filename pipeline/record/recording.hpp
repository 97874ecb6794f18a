// What a recording says about itself (docs/FORMAT.md, "Metadata").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/alpha_set.hpp"
#include "pipeline/model/lattice.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace scansion {

/// Written once, before the first group; never changes while a recording grows.
struct RecordingFacts {
  std::string device = "file"; ///< channel names are scan/<device>/...; letters, digits, '-', '_', '.'
  std::uint32_t stream = 0;    ///< ties groups to their recording; chosen by the writer's caller
  Lattice lattice;
  LevelSpec levels;                       ///< as asked for
  std::uint32_t level_count = 3;          ///< n: lod channels per group
  std::uint32_t stored_levels = 4;        ///< channels really present of the n + 1 (fewer after `export --level K`)
  std::optional<double> gap_mm;           ///< steps longer than this split a line
  std::optional<std::int64_t> started_ns; ///< realtime; empty offline, so that equal input gives equal bytes
  bool features = false;                  ///< has channels for feature lines and patches
  double rounding_mm = 0.0;               ///< largest rounding error bound promised on entry (half a count), 0 when lossless

  friend bool operator==(const RecordingFacts&, const RecordingFacts&) = default;
};

/// Written once at the end.
struct RecordingEnd {
  std::uint64_t lines = 0, points = 0, runs = 0, invalid = 0, gaps = 0, groups = 0;
  std::optional<std::int64_t> ended_ns; ///< realtime
  double rounding_mm = 0.0;             ///< largest rounding error met on entry

  friend bool operator==(const RecordingEnd&, const RecordingEnd&) = default;
};

} // namespace scansion
