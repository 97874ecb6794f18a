// How a recording's records are laid out: the head, and the block (chunk and message indexes) of groups or of one text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/scan_line.hpp"
#include "pipeline/record/file.hpp"
#include "pipeline/record/mcap.hpp"
#include "pipeline/record/recording.hpp"

namespace scansion {

/// The longest chunk record that is written or read. The longest line (kMaxLinePoints) with IEEE residuals needs about 150 MiB.
inline constexpr std::uint64_t kMaxChunk = 192U << 20U;
/// The most groups in one chunk.
inline constexpr std::size_t kMaxChunkGroups = 16;
/// The longest text of a gap message.
inline constexpr std::uint64_t kMaxGapText = 64U << 10U;
/// The longest text of a message with feature lines or patches.
inline constexpr std::uint64_t kMaxNoteText = 32U << 20U;
/// The facts are repeated in the file, so that they outlive a broken head: soon, when a copy weighs little beside the groups,
/// and then again and again.
[[nodiscard]] constexpr bool facts_due(std::uint64_t groups) noexcept {
  constexpr std::uint64_t kSoon = 16;
  constexpr std::uint64_t kEvery = 256;
  return groups == kSoon || (groups != 0 && groups % kEvery == 0);
}

[[nodiscard]] inline std::uint32_t payloads_per_group(const RecordingFacts& f) noexcept {
  return f.stored_levels + 1;
}
/// Payload i of a group stands on channel i + 1.
[[nodiscard]] inline std::uint16_t gap_channel(const RecordingFacts& f) noexcept {
  return static_cast<std::uint16_t>(f.level_count + 3);
}

/// What a block (a chunk and its message indexes) holds: the payloads of one or more groups, or one text message.
enum class BlockKind : std::uint8_t { group, gap, features, patches };
[[nodiscard]] inline std::uint16_t channel_of(BlockKind kind, const RecordingFacts& f) noexcept {
  return kind == BlockKind::group
             ? std::uint16_t{1}
             : static_cast<std::uint16_t>(gap_channel(f) + static_cast<int>(kind) - static_cast<int>(BlockKind::gap));
}
/// Messages of one group, or of a text: as many as there are channels of this kind.
[[nodiscard]] inline std::uint32_t messages_in(BlockKind kind, const RecordingFacts& f) noexcept {
  return kind == BlockKind::group ? payloads_per_group(f) : 1;
}
[[nodiscard]] inline std::uint64_t max_text(BlockKind kind) noexcept {
  return kind == BlockKind::gap ? kMaxGapText : kMaxNoteText;
}
/// Text channels, each with a schema of its own: gaps, and features and patches where the recording has them.
[[nodiscard]] inline std::uint16_t text_channels(const RecordingFacts& f) noexcept {
  return f.features ? 3 : 1;
}

/// Schemas and channels, each a run of whole records.
/// `gaps`: with those of gap messages, which come with the first of these; neither is in the head.
[[nodiscard]] Bytes schema_records(const RecordingFacts& facts, bool gaps);
[[nodiscard]] Bytes channel_records(const RecordingFacts& facts, bool gaps);
[[nodiscard]] inline std::uint16_t schema_count(const RecordingFacts& f, bool gaps) noexcept {
  return static_cast<std::uint16_t>(1 + text_channels(f) + (gaps ? 1 : 0));
}
[[nodiscard]] inline std::uint32_t channel_count(const RecordingFacts& f, bool gaps) noexcept {
  return payloads_per_group(f) + text_channels(f) - (gaps ? 0 : 1);
}

/// Everything before the first chunk, magic included.
[[nodiscard]] Bytes head_bytes(const RecordingFacts& facts);

/// {"first":1,"count":2,"reason":"..."}
[[nodiscard]] std::string gap_text(const Gap& gap);
[[nodiscard]] Result<Gap> parse_gap(std::string_view text);

/// What a summary says of one chunk; everything else in its ChunkIndex follows from it.
struct ChunkEntry {
  std::uint64_t offset = 0;    ///< of the chunk record in the file
  std::uint64_t time = 0;      ///< the earliest log time of its messages
  std::uint64_t last_time = 0; ///< the latest
  std::uint32_t size = 0;      ///< of the chunk record, framing included
  std::uint8_t count = 1;      ///< groups in it; 1 for a text
  BlockKind kind = BlockKind::group;
};

/// The messages of one group, or one text message.
struct MessageSet {
  std::uint32_t sequence = 0;
  std::uint64_t time = 0;
  std::span<const ByteView> messages;
};

/// The records of a chunk and its message indexes, as pieces that stand one after the other in the file. The pieces of payloads
/// are the caller's.
class Block {
public:
  void build_groups(std::span<const MessageSet> groups);
  void build_group(std::uint32_t number, std::uint64_t time, std::span<const ByteView> payloads);
  void build_text(const RecordingFacts& facts, BlockKind kind, std::uint32_t sequence, std::uint64_t time, ByteView text);

  [[nodiscard]] const std::vector<ByteView>& pieces() const noexcept { return pieces_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return chunk_size_ + index_size_; }
  /// What a summary says of it when it stands at `offset`.
  [[nodiscard]] ChunkEntry entry(std::uint64_t offset, BlockKind kind) const noexcept {
    return {offset, first_time_, last_time_, static_cast<std::uint32_t>(chunk_size_), count_, kind};
  }
  [[nodiscard]] std::uint32_t crc() const noexcept { return crc_; } ///< CRC-32 of all pieces

private:
  void build(const Bytes& definitions, std::uint16_t first_channel, std::span<const MessageSet> sets);
  void put_indexes(mcap::Builder& b, std::uint64_t first_offset, std::uint16_t first_channel, std::span<const MessageSet> sets);
  Bytes frame_;
  std::vector<ByteView> pieces_;
  std::uint64_t chunk_size_ = 0;
  std::uint64_t index_size_ = 0;
  std::uint64_t first_time_ = 0;
  std::uint64_t last_time_ = 0;
  std::uint8_t count_ = 0;
  std::uint32_t crc_ = 0;
};

/// What the first kMaxFirstData bytes of a chunk and the first of its message indexes say. Nothing of it is certain before the
/// block has been compared.
struct BlockStart {
  BlockKind kind = BlockKind::group;
  std::uint32_t sequence = 0; ///< of its first message
  std::uint64_t time = 0;     ///< the same
  std::uint64_t chunk_size = 0;
  std::size_t groups = 1;
  std::uint64_t block_size = 0;                ///< chunk and message indexes
  std::uint64_t first_data = mcap::kFirstData; ///< from the start of the chunk to the data of its first message
};
/// Fails with damaged when no block of this recording can start so, or it would be longer than `available` or kMaxChunk.
[[nodiscard]] Result<BlockStart> parse_block_start(ByteView bytes, std::uint64_t available, const RecordingFacts& facts);
/// Completes it by the first bytes behind the chunk; `available` as above.
[[nodiscard]] Result<void> parse_first_index(ByteView behind_chunk, std::uint64_t available, const RecordingFacts& facts,
                                             BlockStart& start);
/// Both, of the block at `offset`.
[[nodiscard]] Result<BlockStart> read_block_start(const File& file, std::uint64_t offset, std::uint64_t file_size,
                                                  const RecordingFacts& facts);

/// The message data in a chunk record, in order; fails with damaged when they do not fill it.
[[nodiscard]] Result<void> split_chunk(ByteView chunk, const BlockStart& start, const RecordingFacts& facts,
                                       std::vector<ByteView>& out);

} // namespace scansion
