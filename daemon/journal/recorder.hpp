// Records one device run: groups in, one recording file after the other out, through full disks and failed syncs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/clock/clock.hpp"
#include "daemon/journal/directory.hpp"
#include "daemon/journal/sink.hpp"
#include "pipeline/feature/feature_stage.hpp"
#include "pipeline/pipeline.hpp"

#include <algorithm>
#include <deque>
#include <optional>

namespace scansion {

struct RecorderSettings {
  SteadyNs sync_interval = 100 * kMillisecond;
  std::uint64_t rotate_bytes = 256ULL << 20U;
  SteadyNs rotate_age = 3600 * kSecond;
  std::uint64_t min_free_bytes = 1024ULL << 20U;
  std::uint64_t pending_bytes = 64ULL << 20U; ///< closed groups kept while the disk takes none
  SteadyNs retry = kSecond;                   ///< between attempts on a disk that refuses
  std::optional<FeatureSettings> features;    ///< empty: none are looked for
};

/// The outside world of recorders, shared by all devices. Its functions are thread-safe.
struct JournalPorts {
  const JournalDirectory& directory;
  SinkFactory open = file_sinks();
  std::function<Result<std::uint64_t>()> free_bytes; ///< empty: that of the directory
};

/// Counters run over all files of the run.
struct RecorderStatus {
  std::uint64_t groups_written = 0, lines_written = 0;
  std::uint64_t lost_lines = 0; ///< the run ended while the disk refused them
  std::uint64_t pending_groups = 0;
  std::string path; ///< being written; empty: none
  std::uint64_t bytes = 0;
  std::string last_path; ///< newest finished file
  std::string blocked;   ///< why nothing can be written; empty: it can
};

/// Thread-bound. Encodes at the moment of writing, because stream id and group number belong to the file. A file is created
/// when its first group is there, so no recording is empty.
///
/// Start and end of a file are the times of its first and last line where lines have stamps. So the same lines give the same
/// bytes, whether they come from a device or from its raw transcript.
///
/// A group that cannot be written stays in memory and is tried again each second; up to `pending_bytes` of groups wait so, then
/// full() asks the caller to wait too. After a failed sync the file is closed and another one started: a later success of the
/// same descriptor would prove nothing.
class RunRecorder {
public:
  /// `facts` without stream and start, which change with each file.
  RunRecorder(const JournalPorts& ports, Clock& clock, const RecorderSettings& settings, RecordingFacts facts);

  /// Takes the points of `group`, whose buffers may be used again. `since`: when its first line came in.
  void add(LineGroup& group, SteadyNs since);
  /// Lost lines between the group before and the next one.
  void add(Gap gap);
  /// No more groups may be added now: wait until next_deadline(), tick(), ask again.
  [[nodiscard]] bool full() const noexcept { return pending_bytes_ >= settings_.pending_bytes; }
  /// Groups are pending because the disk refuses them.
  [[nodiscard]] bool is_blocked() const noexcept { return !status_.blocked.empty(); }
  /// Tries refused groups again, syncs, rotates: whatever is due.
  void tick();
  /// When tick() has something to do; kNever: not before something is added.
  [[nodiscard]] SteadyNs next_deadline() const noexcept;
  /// When the first line of the oldest unwritten group came in; kNever: all is written.
  [[nodiscard]] SteadyNs oldest_unwritten() const noexcept;
  /// Ends the run: one last attempt on what is pending, then the file is finished. What the disk still refuses is counted lost.
  void finish();
  /// Largest rounding error met on entry so far, in mm; stands at the end of each file.
  void note_rounding(double mm) noexcept { rounding_mm_ = std::max(rounding_mm_, mm); }
  [[nodiscard]] RecorderStatus status() const;

private:
  struct Pending {
    LineGroup group; ///< no lines: `gap` counts
    Gap gap;
    SteadyNs since = 0;
    std::uint64_t bytes = 0;
  };

  [[nodiscard]] Result<void> check_space() const;
  [[nodiscard]] Result<void> open_file();
  /// Realtime of the first line of the file to be opened; now for lines without stamps.
  [[nodiscard]] std::int64_t first_line_time() const;
  [[nodiscard]] Result<void> write_group(LineGroup& group);
  [[nodiscard]] Result<void> write_front();
  void note_written(const LineGroup& group);
  void find_features(const LineGroup& group);
  void finish_features();
  void drain();
  void block(const Error& error);
  void unblock();
  void rotate_if_due();
  void close_file(std::string_view why);

  JournalPorts ports_;
  Clock& clock_;
  RecorderSettings settings_;
  RecordingFacts facts_;

  std::unique_ptr<RecordingSink> sink_;
  std::optional<Pipeline> pipeline_;
  std::optional<FeatureStage> stage_; ///< of the open file: each file's feature lines are complete in themselves
  FeatureReport found_;
  EncodedGroup encoded_;
  bool is_encoded_ = false; ///< encoded_ holds the group that was refused, for the file that is open
  std::uint64_t groups_in_file_ = 0;
  std::uint64_t last_log_time_ns_ = 0;
  std::optional<std::int64_t> last_line_time_; ///< realtime of the newest line that was written, when it has one
  const LineGroup* writing_ = nullptr;         ///< the group a file is opened for
  std::uint32_t next_number_ = 1;              ///< NNN of the next file name
  SteadyNs opened_at_ = 0;
  SteadyNs sync_at_ = kNever; ///< kNever: nothing written since the last sync
  double rounding_mm_ = 0.0;

  std::deque<Pending> pending_;
  std::uint64_t pending_bytes_ = 0;
  SteadyNs retry_at_ = 0;
  RecorderStatus status_;
};

} // namespace scansion
