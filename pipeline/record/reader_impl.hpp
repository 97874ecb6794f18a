// What a RecordingReader holds; shared by the files that implement it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/file.hpp"
#include "pipeline/record/reader.hpp"

namespace scansion {

struct RecordingReader::Impl {
  explicit Impl(File opened) : file(std::move(opened)) {}

  File file;
  std::uint64_t size = 0;
  RecordingFacts facts;
  bool complete = false;
  std::optional<RecordingEnd> end;
  std::vector<GroupEntry> groups;
  std::vector<Gap> gaps;
  std::vector<NoteEntry> notes;
  GroupDecoder decoder;
  Bytes payload; ///< scratch
};

} // namespace scansion
