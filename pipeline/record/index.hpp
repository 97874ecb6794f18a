// Finds where the payloads of a recording stand, from framing alone: no payload byte is read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/find_facts.hpp"
#include "pipeline/record/layout.hpp"
#include "pipeline/record/reader.hpp"
#include "pipeline/record/window.hpp"

namespace scansion {

struct RecordingIndex {
  bool complete = false;
  std::size_t chunks = 0; ///< of an unfinished recording, or one whose summary is not to be trusted
  std::optional<RecordingEnd> end;
  std::vector<GroupEntry> groups;
  std::vector<Gap> gaps;
  std::vector<NoteEntry> notes;
};

/// Through the summary when its checksum is right, else from chunk to chunk as far as they are whole.
[[nodiscard]] Result<RecordingIndex> build_index(Window& window, const Head& head);

} // namespace scansion
