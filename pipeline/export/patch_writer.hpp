// Points with their patches as files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/export/point_writer.hpp"
#include "pipeline/record/findings.hpp"

namespace scansion {

enum class PatchFormat : std::uint8_t { txt, csv, ply, json };

/// The format of a name; fails with usage.
[[nodiscard]] Result<PatchFormat> parse_patch_format(std::string_view name);
[[nodiscard]] bool needs_patching(PatchFormat format) noexcept;

/// `findings` must outlive the writer. A point on no patch has patch -1.
[[nodiscard]] std::unique_ptr<PointWriter> make_patch_writer(PatchFormat format, const ValueFormat& values,
                                                             const PointStyle& style, const Findings& findings);

/// The patch of each sample of a line, lines in ascending order. Thread-bound.
class PatchCursor {
public:
  explicit PatchCursor(const std::vector<PatchRun>& runs) : runs_(runs) {}
  /// -1: none. `index` counts the samples of the line over all its runs and must not fall within a line.
  [[nodiscard]] std::int64_t patch(std::uint64_t line, std::uint32_t index) noexcept;

private:
  const std::vector<PatchRun>& runs_; // by line and first sample
  std::size_t at_ = 0;
};

} // namespace scansion
