// A top view of a recording: a relief of its heights or patches, kept points, feature lines, a key and a scale.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/picture/drawing.hpp"
#include "pipeline/picture/relief.hpp"

namespace scansion {

inline constexpr int kLeastPicture = 200, kLargestPicture = 3000; ///< pixels of the longer edge

/// What a top view shows.
struct ViewContent {
  Shade shade = Shade::height;
  std::optional<std::uint32_t> level; ///< mark the points of S_level
  std::optional<Findings> findings;   ///< empty: the recording was made without
  std::string caption;
};

/// Memory follows the picture, the largest group and the findings, not the points. `size`: pixels of the longer edge at most.
[[nodiscard]] Result<Drawing> draw_top_view(RecordingReader& reader, const ViewContent& content, int size,
                                            const Progress& progress);

} // namespace scansion
