// All that a recording says about feature lines and patches, put together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/reader.hpp"

namespace scansion {

struct Findings {
  std::vector<FeatureLine> lines; ///< whole ones, by id
  std::vector<PatchRun> runs;     ///< by line and first sample; each patch is the one it was merged into at last
  std::vector<Patch> patches;     ///< those that are left, by id
  std::vector<Form> forms;
  std::optional<Backlash> backlash; ///< as it was told last
};

/// What to leave aside: a picture of feature lines needs no runs.
enum class FindingsPart : std::uint8_t { lines, patches, all };

/// Memory follows what was found, not the points. Fails with damaged.
[[nodiscard]] Result<Findings> read_findings(RecordingReader& reader, FindingsPart part = FindingsPart::all);

/// Puts pieces of lines together and follows merges.
[[nodiscard]] Findings assemble(FeatureReport report);

} // namespace scansion
