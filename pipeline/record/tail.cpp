// Making and reading the end of a recording.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/tail.hpp"

#include "pipeline/record/metadata.hpp"

#include <algorithm>
#include <array>

namespace scansion {
namespace {

using mcap::Builder;
using mcap::Opcode;

constexpr std::size_t kFlushAt = 1U << 20U;
constexpr std::uint64_t kFooterFields = mcap::kFooter - mcap::kRecordHead;
constexpr std::uint64_t kEnding = mcap::kFooter + mcap::kMagic.size();
/// ChunkIndex is the longest record that is read from a summary: 64 bytes and 10 for each channel.
constexpr std::uint64_t kMaxSummaryRecord = 64U << 10U;

/// Buffers records on their way out and knows where in the file they will stand.
class TailWriter {
public:
  TailWriter(const TailFacts& tail, const ByteSink& sink) : tail_(tail), sink_(sink), flushed_(tail.offset) {}

  Result<void> data_end() {
    end_record_ = end_record(tail_.end);
    buffer_ = end_record_;
    const std::uint32_t crc = mcap::crc32(tail_.data_crc, buffer_);
    Builder b(buffer_);
    b.begin_sized(Opcode::data_end, 4);
    b.u32(crc);
    return flush();
  }

  Result<void> summary() {
    summary_start_ = flushed_;
    const RecordingFacts& facts = *tail_.facts;
    append(schema_records(facts, tail_.end.gaps > 0));
    append(channel_records(facts, tail_.end.gaps > 0));
    statistics();
    for (const ChunkEntry& entry : *tail_.chunks) {
      chunk_index(entry);
      if (buffer_.size() >= kFlushAt) {
        SCANSION_TRY(flush());
      }
    }
    const std::uint64_t copy_size = facts_record(facts).size();
    for (const std::uint64_t copy : *tail_.copies) metadata_index(copy, copy_size, kFactsName);
    metadata_index(tail_.offset, end_record_.size(), kEndName);
    return footer();
  }

private:
  [[nodiscard]] std::uint64_t here() const noexcept { return flushed_ + buffer_.size(); }
  void append(const Bytes& bytes) { buffer_.insert(buffer_.end(), bytes.begin(), bytes.end()); }

  Result<void> flush() {
    if (summary_start_ != 0) crc_ = mcap::crc32(crc_, buffer_);
    SCANSION_TRY(sink_(buffer_));
    flushed_ += buffer_.size();
    buffer_.clear();
    return success();
  }

  void statistics() {
    const auto& chunks = *tail_.chunks;
    const RecordingFacts& facts = *tail_.facts;
    std::array<std::uint64_t, 4> blocks{}; // messages of a channel, by BlockKind
    std::uint64_t first = chunks.empty() ? 0 : UINT64_MAX;
    std::uint64_t last = 0;
    std::uint64_t messages = 0;
    std::uint32_t channels = 0;
    for (const ChunkEntry& c : chunks) {
      blocks[static_cast<std::size_t>(c.kind)] += c.count;
      messages += std::uint64_t{c.count} * messages_in(c.kind, facts);
      first = std::min(first, c.time);
      last = std::max(last, c.last_time);
    }
    for (std::size_t k = 0; k < blocks.size(); ++k)
      channels += blocks[k] > 0 ? messages_in(static_cast<BlockKind>(k), facts) : 0;
    Builder b(buffer_);
    const std::size_t begun = b.begin(Opcode::statistics);
    b.u64(messages);
    b.u16(schema_count(facts, tail_.end.gaps > 0));
    b.u32(channel_count(facts, tail_.end.gaps > 0));
    b.u32(0); // attachments
    b.u32(static_cast<std::uint32_t>(tail_.copies->size() + 1));
    b.u32(static_cast<std::uint32_t>(chunks.size()));
    b.u64(first);
    b.u64(last);
    b.u32(10 * channels);
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const auto kind = static_cast<BlockKind>(k);
      for (std::uint32_t i = 0; blocks[k] > 0 && i < messages_in(kind, facts); ++i) {
        b.u16(static_cast<std::uint16_t>(channel_of(kind, facts) + i));
        b.u64(blocks[k]);
      }
    }
    b.end(begun);
  }

  void chunk_index(const ChunkEntry& entry) {
    const std::uint32_t messages = messages_in(entry.kind, *tail_.facts);
    const std::uint16_t first = channel_of(entry.kind, *tail_.facts);
    const std::uint64_t records = entry.size - mcap::kChunkHead;
    const std::uint64_t index_size = mcap::message_index_size(entry.count);
    Builder b(buffer_);
    const std::size_t begun = b.begin(Opcode::chunk_index);
    b.u64(entry.time);
    b.u64(entry.last_time);
    b.u64(entry.offset);
    b.u64(entry.size);
    b.u32(10 * messages);
    for (std::uint32_t i = 0; i < messages; ++i) {
      b.u16(static_cast<std::uint16_t>(first + i));
      b.u64(entry.offset + entry.size + index_size * i);
    }
    b.u64(index_size * messages);
    b.string("");
    b.u64(records);
    b.u64(records);
    b.end(begun);
  }

  void metadata_index(std::uint64_t offset, std::uint64_t length, std::string_view name) {
    Builder b(buffer_);
    const std::size_t begun = b.begin(Opcode::metadata_index);
    b.u64(offset);
    b.u64(length);
    b.string(name);
    b.end(begun);
  }

  Result<void> footer() {
    Builder b(buffer_);
    b.begin_sized(Opcode::footer, kFooterFields);
    b.u64(summary_start_);
    b.u64(0); // no SummaryOffsets: the summary is short, and readers take it whole
    SCANSION_TRY(flush());
    b.u32(crc_);
    b.raw(mcap::kMagic);
    return flush();
  }

  const TailFacts& tail_;
  const ByteSink& sink_;
  std::uint64_t flushed_;
  std::uint64_t summary_start_ = 0;
  std::uint32_t crc_ = 0;
  Bytes end_record_;
  Bytes buffer_;
};

struct FooterFields {
  std::uint64_t summary_start = 0;
  std::uint32_t crc = 0;
  std::uint64_t footer_offset = 0;
};

Result<FooterFields> read_footer(Window& window) {
  if (window.size() < kEnding) return fail(Errc::damaged, "the file is too short for a footer");
  FooterFields fields;
  fields.footer_offset = window.size() - kEnding;
  SCANSION_TRY(bytes, window.view(fields.footer_offset, kEnding));
  const mcap::RecordHead head = mcap::record_head(bytes);
  if (!mcap::is(head, Opcode::footer) || head.length != kFooterFields || mcap::text_of(bytes.last(8)) != mcap::kMagic)
    return fail(Errc::damaged, "no footer and magic at the end of the file");
  mcap::Cursor cursor(bytes.subspan(mcap::kRecordHead));
  fields.summary_start = cursor.u64();
  (void)cursor.u64();
  fields.crc = cursor.u32();
  if (fields.summary_start == 0 || fields.summary_start > fields.footer_offset)
    return fail(Errc::damaged, "the footer points outside the file");
  return fields;
}

Result<void> check_summary_crc(Window& window, const FooterFields& footer) {
  std::uint32_t crc = 0;
  const std::uint64_t end = window.size() - mcap::kMagic.size() - 4;
  for (std::uint64_t at = footer.summary_start; at < end; at += std::min<std::uint64_t>(kFlushAt, end - at)) {
    SCANSION_TRY(block, window.view(at, std::min<std::uint64_t>(kFlushAt, end - at)));
    crc = mcap::crc32(crc, block);
  }
  if (crc != footer.crc) return fail(Errc::damaged, "checksum of the summary is wrong");
  return success();
}

} // namespace

Result<void> make_tail(const TailFacts& tail, const ByteSink& sink) {
  TailWriter writer(tail, sink);
  SCANSION_TRY(writer.data_end());
  return writer.summary();
}

Result<bool> ends_with_footer(Window& window) {
  const auto footer = read_footer(window);
  if (footer) return true;
  if (footer.error().code == Errc::damaged) return false;
  return footer.error();
}

Result<Summary> read_summary(Window& window) {
  SCANSION_TRY(footer, read_footer(window));
  SCANSION_TRY(check_summary_crc(window, footer));
  Summary summary;
  for (std::uint64_t at = footer.summary_start; at < footer.footer_offset;) {
    SCANSION_TRY(head_bytes, window.view(at, mcap::kRecordHead));
    const mcap::RecordHead head = mcap::record_head(head_bytes);
    if (head.opcode == 0 || head.length > kMaxSummaryRecord || head.length > footer.footer_offset - at)
      return fail(Errc::damaged, "a record of the summary is impossible");
    SCANSION_TRY(record, window.view(at, mcap::kRecordHead + head.length));
    mcap::Cursor cursor(record.subspan(mcap::kRecordHead));
    if (mcap::is(head, Opcode::chunk_index)) {
      (void)cursor.take(16);
      summary.chunks.push_back(cursor.u64());
      summary.chunk_ends.push_back(summary.chunks.back() + cursor.u64());
      if (summary.chunks.size() > 1 && summary.chunks.back() <= summary.chunks[summary.chunks.size() - 2])
        return fail(Errc::damaged, "the summary lists chunks out of order");
    } else if (mcap::is(head, Opcode::metadata_index)) {
      const std::uint64_t offset = cursor.u64();
      const std::uint64_t length = cursor.u64();
      if (cursor.string() == kEndName) {
        summary.end_offset = offset;
        summary.end_length = length;
      }
    }
    if (!cursor.ok()) return fail(Errc::damaged, "a record of the summary is cut short");
    at += mcap::kRecordHead + head.length;
  }
  return summary;
}

} // namespace scansion
