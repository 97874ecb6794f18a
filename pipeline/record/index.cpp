// The index of groups and gaps.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/index.hpp"

#include "pipeline/record/group_check.hpp"
#include "pipeline/record/metadata.hpp"
#include "pipeline/record/tail.hpp"

#include <algorithm>
#include <array>

namespace scansion {
namespace {

/// One chunk's place, before its gap message or payload checksums have been looked at.
struct Framed {
  std::uint64_t offset = 0;
  BlockStart start;
};

class Indexer {
public:
  Indexer(Window& window, const Head& head) : window_(window), facts_(head.facts), head_(head) {}

  Result<RecordingIndex> through_summary(const Summary& summary);
  Result<RecordingIndex> from_chunk_to_chunk();

private:
  Result<BlockStart> start_at(std::uint64_t offset) { return read_block_start(window_.file(), offset, window_.size(), facts_); }
  Result<void> add_groups(const Framed& framed);
  using Places = std::vector<GroupEntry::Place>;
  Result<void> places_from_indexes(const Framed& framed, Places& places);
  Result<void> places_from_messages(const Framed& framed, Places& places);
  [[nodiscard]] std::size_t payloads_of(const Framed& framed) const { return framed.start.groups * payloads_per_group(facts_); }
  Result<Gap> gap_at(const Framed& framed);
  Result<std::optional<RecordingEnd>> end_at(std::uint64_t offset, std::uint64_t length);
  Result<std::optional<std::uint64_t>> metadata_end(std::uint64_t offset);
  Result<void> add(const Framed& framed);
  Result<bool> intact(const Framed& framed);
  Result<void> drop_torn(std::vector<Framed>& chunks);

  /// Small reads go past the window: it would fetch a megabyte for each.
  Result<ByteView> small(std::uint64_t offset, std::uint64_t count) {
    if (offset >= window_.size()) return ByteView{};
    buffer_.resize(std::min(count, window_.size() - offset));
    SCANSION_TRY(window_.file().read_at(offset, buffer_));
    return ByteView(buffer_);
  }

  Window& window_;
  const RecordingFacts& facts_;
  const Head& head_;
  RecordingIndex index_;
  Bytes buffer_;
};

Result<void> Indexer::places_from_indexes(const Framed& framed, Places& places) {
  const std::uint64_t records = framed.start.chunk_size - mcap::kChunkHead;
  SCANSION_TRY(bytes, small(framed.offset + framed.start.chunk_size, framed.start.block_size - framed.start.chunk_size));
  mcap::Cursor cursor(bytes);
  const std::uint32_t stride = payloads_per_group(facts_);
  std::vector<std::uint64_t> offsets(payloads_of(framed) + 1, records);
  for (std::uint32_t i = 0; i < stride; ++i) {
    const mcap::RecordHead head = mcap::record_head(cursor.take(mcap::kRecordHead));
    const std::uint16_t channel = cursor.u16();
    const std::uint32_t array = cursor.u32();
    for (std::size_t g = 0; g < framed.start.groups; ++g) {
      (void)cursor.u64();
      offsets[g * stride + i] = cursor.u64();
    }
    if (!mcap::is(head, mcap::Opcode::message_index) || channel != i + 1 || array != 16 * framed.start.groups)
      return fail(Errc::damaged, "message indexes are broken");
  }
  places.clear();
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    const bool fits = (i > 0 || offsets[i] == 0) && offsets[i + 1] <= records && offsets[i] <= offsets[i + 1] &&
                      offsets[i + 1] - offsets[i] >= mcap::kMessageHead + kShortestPayloadHeader;
    if (!fits) return fail(Errc::damaged, "message indexes are broken");
    places.push_back({framed.offset + mcap::kChunkHead + offsets[i] + mcap::kMessageHead,
                      static_cast<std::uint32_t>(offsets[i + 1] - offsets[i] - mcap::kMessageHead)});
  }
  return success();
}

/// The slower way when the message indexes are broken: from message to message.
Result<void> Indexer::places_from_messages(const Framed& framed, Places& places) {
  const std::uint64_t chunk_end = framed.offset + framed.start.chunk_size;
  places.clear();
  std::uint64_t at = framed.offset + mcap::kChunkHead;
  for (std::size_t i = 0; i < payloads_of(framed); ++i) {
    SCANSION_TRY(bytes, small(at, mcap::kMessageHead));
    const mcap::RecordHead head = mcap::record_head(bytes);
    const std::uint64_t left = chunk_end - at;
    if (!mcap::is(head, mcap::Opcode::message) || left < mcap::kMessageHead || head.length > left - mcap::kRecordHead ||
        head.length < mcap::kMessageHead - mcap::kRecordHead + kShortestPayloadHeader)
      return fail(Errc::damaged, "the framing of a chunk is broken");
    const std::uint64_t size = mcap::kRecordHead + head.length - mcap::kMessageHead;
    places.push_back({at + mcap::kMessageHead, static_cast<std::uint32_t>(size)});
    at += mcap::kMessageHead + size;
  }
  if (at != chunk_end) return fail(Errc::damaged, "the framing of a chunk is broken");
  return success();
}

Result<void> Indexer::add_groups(const Framed& framed) {
  Places places;
  auto placed = places_from_indexes(framed, places);
  if (!placed && placed.error().code == Errc::damaged) placed = places_from_messages(framed, places);
  if (!placed) return placed;
  const std::uint32_t stride = payloads_per_group(facts_);
  for (std::size_t at = 0; at < places.size(); at += stride) {
    const auto first = places.begin() + static_cast<std::ptrdiff_t>(at);
    GroupEntry entry;
    entry.number = framed.start.sequence;
    if (at > 0) {
      SCANSION_TRY(head, small(first->offset - mcap::kMessageHead, mcap::kMessageHead));
      mcap::Cursor cursor(head);
      (void)cursor.take(mcap::kRecordHead + 2);
      entry.number = cursor.u32();
    }
    entry.payloads.assign(first, first + stride);
    index_.groups.push_back(std::move(entry));
  }
  return success();
}

Result<Gap> Indexer::gap_at(const Framed& framed) {
  const std::uint64_t size = framed.start.chunk_size - framed.start.first_data;
  if (size > kMaxGapText) return fail(Errc::damaged, "gap message is longer than 64 KiB");
  SCANSION_TRY(text, small(framed.offset + framed.start.first_data, size));
  return parse_gap(mcap::text_of(text));
}

Result<std::optional<RecordingEnd>> Indexer::end_at(std::uint64_t offset, std::uint64_t length) {
  if (length <= mcap::kRecordHead || length > kMaxMetadata) return std::optional<RecordingEnd>{};
  SCANSION_TRY(bytes, small(offset, length));
  if (bytes.size() != length) return std::optional<RecordingEnd>{};
  const mcap::RecordHead head = mcap::record_head(bytes);
  if (!mcap::is(head, mcap::Opcode::metadata) || head.length + mcap::kRecordHead != length)
    return std::optional<RecordingEnd>{};
  const auto end = parse_end(bytes.subspan(mcap::kRecordHead));
  if (!end) return std::optional<RecordingEnd>{};
  return std::optional<RecordingEnd>(end.value());
}

Result<void> Indexer::add(const Framed& framed) {
  const auto broken = [&](const Error& why) {
    return fail(why.code, window_.file().path(), ": byte ", std::to_string(framed.offset), ": ", why.context,
                "; use scansion recover");
  };
  if (framed.start.kind == BlockKind::features || framed.start.kind == BlockKind::patches) {
    index_.notes.push_back({framed.offset + framed.start.first_data,
                            static_cast<std::uint32_t>(framed.start.chunk_size - framed.start.first_data),
                            framed.start.kind == BlockKind::patches});
    return success();
  }
  if (framed.start.kind == BlockKind::gap) {
    auto gap = gap_at(framed);
    if (!gap) return broken(gap.error());
    index_.gaps.push_back(std::move(gap).value());
    return success();
  }
  const auto added = add_groups(framed);
  if (!added) return broken(added.error());
  return success();
}

Result<RecordingIndex> Indexer::through_summary(const Summary& summary) {
  SCANSION_TRY(end, end_at(summary.end_offset, summary.end_length));
  if (!end) return fail(Errc::damaged, "the end metadata is broken");
  index_.complete = true;
  index_.end = end;
  for (const std::uint64_t offset : summary.chunks) {
    const auto start = start_at(offset);
    if (!start)
      return fail(start.error().code, window_.file().path(), ": byte ", std::to_string(offset), ": ", start.error().context,
                  "; use scansion recover");
    SCANSION_TRY(add({offset, start.value()}));
  }
  return std::move(index_);
}

/// Where the Metadata record at `offset` ends; the end metadata stays in the index. Empty when there is no such record.
Result<std::optional<std::uint64_t>> Indexer::metadata_end(std::uint64_t offset) {
  SCANSION_TRY(bytes, small(offset, mcap::kRecordHead));
  const mcap::RecordHead head = mcap::record_head(bytes);
  if (!mcap::is(head, mcap::Opcode::metadata) || head.length > kMaxMetadata) return std::optional<std::uint64_t>{};
  const std::uint64_t length = mcap::kRecordHead + head.length;
  if (length > window_.size() - offset) return std::optional<std::uint64_t>{};
  SCANSION_TRY(end, end_at(offset, length));
  if (end) index_.end = end;
  return std::optional<std::uint64_t>(offset + length);
}

/// Whether every checksum of a chunk is right and its framing is that of its payloads.
Result<bool> Indexer::intact(const Framed& framed) {
  SCANSION_TRY(block, window_.view(framed.offset, framed.start.block_size));
  if (block.size() != framed.start.block_size) return false;
  std::vector<ByteView> messages;
  if (!split_chunk(block.first(framed.start.chunk_size), framed.start, facts_, messages)) return false;
  if (framed.start.kind == BlockKind::gap && !parse_gap(mcap::text_of(messages.front()))) return false;
  Block expected;
  if (framed.start.kind == BlockKind::group) {
    const std::size_t stride = payloads_per_group(facts_);
    std::vector<MessageSet> sets;
    for (std::size_t at = 0; at < messages.size(); at += stride) {
      const auto payloads = std::span(messages).subspan(at, stride);
      const auto lines = check_group(payloads, facts_);
      if (!lines) return false;
      sets.push_back({lines.value().group, lines.value().first_time_ns, payloads});
    }
    expected.build_groups(sets);
  } else {
    expected.build_text(facts_, framed.start.kind, framed.start.sequence, framed.start.time, messages.front());
  }
  return expected.crc() == mcap::crc32(0, block);
}

/// After a power cut the last chunks may have their length and not their bytes.
Result<void> Indexer::drop_torn(std::vector<Framed>& chunks) {
  while (!chunks.empty()) {
    SCANSION_TRY(good, intact(chunks.back()));
    if (good) break;
    chunks.pop_back();
  }
  return success();
}

Result<RecordingIndex> Indexer::from_chunk_to_chunk() {
  std::vector<Framed> chunks;
  for (std::uint64_t at = head_.size; at < window_.size() && !index_.end;) {
    const auto start = start_at(at);
    if (start) {
      chunks.push_back({at, start.value()});
      at += start.value().block_size;
      continue;
    }
    if (start.error().code != Errc::damaged) return start.error();
    SCANSION_TRY(next, metadata_end(at));
    if (!next) break;
    at = *next;
  }
  if (!index_.end) {
    SCANSION_TRY(drop_torn(chunks));
  }
  index_.chunks = chunks.size();
  index_.end.reset(); // an unfinished recording has no end yet, whatever was being written
  for (const Framed& framed : chunks) {
    SCANSION_TRY(add(framed));
  }
  return std::move(index_);
}

} // namespace

Result<RecordingIndex> build_index(Window& window, const Head& head) {
  const auto summary = read_summary(window);
  if (!summary && summary.error().code != Errc::damaged) return summary.error();
  if (summary) {
    auto index = Indexer(window, head).through_summary(summary.value());
    if (index || index.error().code != Errc::damaged) return index;
    // A summary whose checksum is right with chunks that are not: only the walk below tells how far the file is good.
    auto walked = Indexer(window, head).from_chunk_to_chunk();
    if (walked && walked.value().chunks == summary.value().chunks.size()) return walked;
    return index;
  }
  return Indexer(window, head).from_chunk_to_chunk();
}

} // namespace scansion
