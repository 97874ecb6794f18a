// Goes through the lines of a recording one after the other.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/reader.hpp"

namespace scansion::cli {

class LineCursor {
public:
  explicit LineCursor(RecordingReader& reader) : reader_(&reader) {}

  /// Moves to the next line with all stored levels; false at the end.
  [[nodiscard]] Result<bool> next() {
    ++at_;
    while (!begun_ || at_ >= decoded_.group.lines.size()) {
      if (next_group_ == reader_->groups().size()) return false;
      SCANSION_TRY(reader_->read_group(next_group_++, reader_->facts().stored_levels - 1, decoded_));
      begun_ = true;
      at_ = 0;
    }
    return true;
  }
  [[nodiscard]] const ScanLine& line() const noexcept { return decoded_.group.lines[at_]; }
  [[nodiscard]] const DecodedGroup& decoded() const noexcept { return decoded_; }

private:
  RecordingReader* reader_;
  DecodedGroup decoded_;
  std::size_t next_group_ = 0;
  std::size_t at_ = 0;
  bool begun_ = false;
};

} // namespace scansion::cli
