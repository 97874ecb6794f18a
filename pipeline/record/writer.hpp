// Appends encoded groups to a recording; every group, or a few of them, are one chunk and one write.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/payload.hpp"
#include "pipeline/feature/feature_line.hpp"
#include "pipeline/model/scan_line.hpp"
#include "pipeline/record/recording.hpp"

#include <memory>
#include <string>

namespace scansion {

/// What one chunk takes.
enum class ChunkRule : std::uint8_t {
  each_group, ///< a group: it is in the file when append returns. For recordings that must outlive a kill
  many_groups ///< up to 16 groups or about 1 MiB, held back until then. For files that get their name when complete
};

class RecordingWriter {
public:
  /// Creates `path` (fails with exists when it is there) and writes the head. The file is a valid unfinished recording from
  /// then on: it can be read, verified and finished at any moment, also after a kill.
  [[nodiscard]] static Result<RecordingWriter> create(const std::string& path, const RecordingFacts& facts,
                                                      ChunkRule rule = ChunkRule::each_group);
  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;
  /// Closes the descriptor; an unfinished file stays unfinished.
  ~RecordingWriter();

  /// One chunk with the group's payloads, its message indexes, in one write; with many_groups when there are enough of them.
  /// A failure is final then. Else: On failure the file is cut back to the last whole
  /// chunk, the writer stays usable and the group may be appended again.
  /// `runs` and `invalid` are counted into RecordingEnd.
  [[nodiscard]] Result<void> append(const EncodedGroup& group, std::uint64_t points, std::uint64_t runs, std::uint64_t invalid);
  /// A chunk with one message on the gaps channel.
  [[nodiscard]] Result<void> append(const Gap& gap, std::uint64_t log_time_ns);
  /// What was found out about the lines so far, moved out of `report`: a chunk for each message that it needs, none when it is
  /// empty. What cannot be written stays in the writer, which tries again with the next report and at finish().
  [[nodiscard]] Result<void> append(FeatureReport& report, std::uint64_t log_time_ns);
  /// fdatasync. After a failure the file must be sealed and another one started: a later success proves nothing.
  [[nodiscard]] Result<void> sync();
  /// Writes end metadata, data end, summary and footer, syncs. The writer cannot append afterwards.
  [[nodiscard]] Result<void> finish(std::optional<std::int64_t> ended_ns, double rounding_mm);

  [[nodiscard]] std::uint64_t bytes() const noexcept; ///< written so far
  [[nodiscard]] const RecordingEnd& totals() const noexcept;

private:
  struct Impl;
  explicit RecordingWriter(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

} // namespace scansion
