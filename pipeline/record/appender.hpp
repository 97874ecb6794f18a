// Appends blocks to an open recording and finishes it. Behind RecordingWriter, and behind the repair of unfinished files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/file.hpp"
#include "pipeline/record/group_check.hpp"
#include "pipeline/record/layout.hpp"
#include "pipeline/record/writer.hpp"

namespace scansion {

/// Invariant: after every call, successful or not, the file ends with the last whole block (or, if even cutting failed, the
/// appender takes nothing more).
class Appender {
public:
  /// Writes the head into the empty file.
  [[nodiscard]] static Result<Appender> start(File file, const RecordingFacts& facts, ChunkRule rule);

  /// Where an interrupted recording goes on.
  struct State {
    std::uint64_t size = 0;     ///< up to the end of the last whole block
    std::uint64_t standing = 0; ///< bytes behind `size` that are the beginning of the next block, and stay
    std::uint32_t data_crc = 0;
    std::vector<ChunkEntry> chunks;
    std::vector<std::uint64_t> copies; ///< offsets of the records of facts
    RecordingEnd totals;
    GroupOrder order;
    std::uint32_t notes = 0; ///< messages about feature lines and patches
  };
  /// Cuts off what stands behind the state and goes on there.
  [[nodiscard]] static Result<Appender> resume(File file, const RecordingFacts& facts, State state);

  /// With many_groups a failure is final: what was held back is lost.
  [[nodiscard]] Result<void> append_group(std::span<const ByteView> payloads, std::uint64_t points, GroupCounts counts);
  [[nodiscard]] Result<void> append_gap(const Gap& gap, std::uint64_t time);
  /// A message about feature lines or patches, as it is.
  [[nodiscard]] Result<void> append_note(BlockKind kind, ByteView text, std::uint64_t time);
  [[nodiscard]] Result<void> sync();
  [[nodiscard]] Result<void> finish(std::optional<std::int64_t> ended_ns, double rounding_mm);

  [[nodiscard]] const RecordingFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] const State& state() const noexcept { return state_; }

private:
  Appender(File file, const RecordingFacts& facts);
  [[nodiscard]] Result<void> usable() const;
  [[nodiscard]] Result<PayloadHeader> check(std::span<const ByteView> payloads) const;
  [[nodiscard]] Result<void> write(std::span<const ByteView> pieces);
  [[nodiscard]] Error cut_back(Error cause);
  [[nodiscard]] Result<void> write_groups(std::span<const MessageSet> groups);
  [[nodiscard]] Result<void> write_text(BlockKind kind, std::uint32_t sequence, std::uint64_t time, ByteView text);
  [[nodiscard]] Result<void> write_held();
  void took_block(BlockKind kind);

  /// Groups of one chunk, and messages about feature lines that stand behind it.
  struct Held {
    struct Group {
      std::uint32_t number = 0;
      std::uint64_t time = 0;
    };
    struct Note {
      BlockKind kind = BlockKind::features;
      std::uint32_t sequence = 0;
      std::uint64_t time = 0;
      Bytes text;
    };
    std::vector<Group> groups;
    std::vector<Bytes> payloads; ///< of all groups; kept for the next ones
    std::vector<Note> notes;
    std::uint64_t size = 0;
  };

  File file_;
  RecordingFacts facts_;
  ChunkRule rule_ = ChunkRule::each_group;
  Held held_;
  Bytes copy_; ///< the record of facts
  State state_;
  Block block_;
  std::vector<ByteView> pieces_;
  std::vector<ByteView> payloads_;
  std::vector<MessageSet> sets_;
  std::uint64_t written_groups_ = 0;
  bool finished_ = false;
  bool torn_ = false; ///< a cut failed: what stands behind state_.size is unknown; or what was held is lost
  bool directory_synced_ = false;
};

} // namespace scansion
