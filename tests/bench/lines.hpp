// The scan lines that are measured: of synthetic scenes and of recorded scans.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"
#include "pipeline/model/scan_line.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace scansion::bench {

/// One polyline, in counts.
struct RunView {
  std::span<const std::int32_t> x, y, z;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
};

/// Runs of several lines as the pipeline holds them: the points of one after those of the other.
struct FlatRuns {
  std::array<std::vector<std::int32_t>, 3> xyz;
  std::vector<Run> runs;
};

struct LineSet {
  std::string name;
  std::string path; ///< empty for a scene
  Unit unit = Unit::mm;
  Lattice lattice;
  Rational resolution_mm;
  std::vector<LineBuffer> lines;
  std::size_t points = 0;

  /// All runs, in line order; they point into `lines`.
  [[nodiscard]] std::vector<RunView> runs() const;
  /// Those of lines first .. first + count - 1.
  [[nodiscard]] FlatRuns flat_runs(std::size_t first, std::size_t count) const;
};

[[nodiscard]] std::vector<RunView> runs_of(const LineBuffer& line);

/// `lines` and `points` (a line) as asked for, or the scene's own where 0; its default noise unless noise_um >= 0.
[[nodiscard]] Result<LineSet> scene_set(const std::string& scene, std::uint32_t lines, std::uint32_t points,
                                        double noise_um = -1.0);

/// A recorded scan, FILE or FILE:UNIT.
[[nodiscard]] Result<LineSet> file_set(const std::string& entry);

/// Keeps at most `lines` lines (0: all) and about `points` points (0: all), taken evenly over the set in stretches of `stretch`
/// lines.
void thin_out(LineSet& set, std::size_t lines, std::size_t points, std::size_t stretch = 1);

/// Groups of up to 64 lines, as the pipeline makes them.
[[nodiscard]] std::vector<LineGroup> groups_of(const LineSet& set);

} // namespace scansion::bench
