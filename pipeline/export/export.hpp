// Points and rearrangements of a recording to files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/export/point_writer.hpp"

#include <functional>

namespace scansion {

struct ExportReport {
  std::uint64_t lines = 0;  ///< of the recording, or of the chosen range
  std::uint64_t points = 0; ///< that these lines have
  std::uint64_t kept = 0;
  /// mm: exact largest distance of a point left out to the polyline of those kept; empty when a range of lines was cut out of
  /// groups whose error is known as a whole only.
  std::optional<double> error_mm;
};

/// Called between groups with (done, total). May be empty.
using Progress = std::function<void(std::uint64_t, std::uint64_t)>;

/// Writes the selected points through `writer`; memory follows the group.
[[nodiscard]] Result<ExportReport> export_points(RecordingReader& reader, const Selection& selection, PointWriter& writer,
                                                 OutputFile& file, const Progress& progress);

/// Writes the rearrangement text form: per run `# line I run R n+1 COUNT`, then its points in rank order as `j d`, d in mm with
/// 9 significant digits, 0 for end points (paper, section 3). Of `selection` only the line range counts.
[[nodiscard]] Result<ExportReport> export_rearrangement(RecordingReader& reader, const Selection& selection, OutputFile& file,
                                                        const Progress& progress);

} // namespace scansion
