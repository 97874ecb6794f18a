// Feature lines of two recordings of one part, merged.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/line/crossed.hpp"
#include "pipeline/record/reader.hpp"

namespace scansion {

/// Scan lines of `second` are counted on behind those of `first`. Fails with damaged, and with usage when a recording holds no
/// scan lines.
[[nodiscard]] Result<CrossedLines> merge_recordings(RecordingReader& first, RecordingReader& second);

} // namespace scansion
