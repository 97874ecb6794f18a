// Telling the truth about a recording, and bringing back what is left of a broken one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/recording.hpp"

#include <string>
#include <utility>
#include <vector>

namespace scansion {

struct Finding {
  std::uint64_t offset = 0; ///< bytes from the start of the file
  std::string what;         ///< for a person
};

/// Inclusive range of line indexes.
using LineRange = std::pair<std::uint64_t, std::uint64_t>;

struct VerifyReport {
  bool sound = false;                                        ///< finished and not a single finding
  bool finished = false;                                     ///< has its end, summary and footer
  std::uint64_t groups = 0, lines = 0, points = 0, gaps = 0; ///< of the whole groups
  std::uint64_t good_bytes = 0;                              ///< up to the end of the last whole chunk
  std::vector<Finding> findings;                             ///< damage, in file order (at most 100, then only counted)
  std::uint64_t finding_count = 0;
  std::vector<LineRange> lost; ///< line ranges that are missing or damaged, so far as the good groups tell
};

/// Checks every byte: framing, every checksum, every payload decodes, counts and indexes agree, nothing follows the end. An
/// Error only when the file cannot be read at all.
[[nodiscard]] Result<VerifyReport> verify(const std::string& path);

struct RecoverReport {
  std::uint64_t groups = 0, lines = 0, points = 0; ///< brought back
  std::uint64_t bytes_skipped = 0;                 ///< of the input, not understood
  std::vector<LineRange> lost; ///< known to be missing between and before groups that came back; the tail is unknowable
  bool tail_lost = false;      ///< bytes of an unfinished or damaged group stood at the end
  bool notes_lost = false;     ///< a message about feature lines or patches, or a gap, stood in a broken stretch
  [[nodiscard]] bool anything_lost() const noexcept { return !lost.empty() || tail_lost || notes_lost; }
};

/// Writes every whole group that can be found by its mark into a new finished recording at `output` (must not exist), with a
/// gap message for each lost range, and verifies the result. Payload bytes are copied unchanged. Streaming: memory follows the
/// group.
[[nodiscard]] Result<RecoverReport> recover(const std::string& input, const std::string& output);

/// Finishes an unfinished recording in place: cuts it after its last whole chunk, then writes end, summary and footer. A
/// finished recording is left alone. Returns the number of bytes cut off.
[[nodiscard]] Result<std::uint64_t> finish_in_place(const std::string& path);

/// Copies lod0 .. lod<level> of every group into a new recording without changing a payload byte.
[[nodiscard]] Result<void> cut_to_level(const std::string& input, std::uint32_t level, const std::string& output);

} // namespace scansion
