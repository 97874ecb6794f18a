// Head, chunks and message indexes.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/layout.hpp"

#include "pipeline/codec/endian.hpp"
#include "pipeline/record/metadata.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <nlohmann/json.hpp>

namespace scansion {
namespace {

using mcap::Builder;
using mcap::Opcode;

constexpr std::uint64_t kMessageFields = mcap::kMessageHead - mcap::kRecordHead;
constexpr std::uint64_t kChunkFields = mcap::kChunkHead - mcap::kRecordHead;
constexpr std::size_t kCrcInChunk = 33;

enum SchemaId : std::uint16_t { kLinesSchema = 1, kLevelSchema = 2, kGapSchema = 3, kFeaturesSchema = 4, kPatchesSchema = 5 };

constexpr std::string_view kGapJsonSchema =
    R"({"type":"object","properties":{"first":{"type":"integer"},"count":{"type":["integer","null"]},)"
    R"("reason":{"type":"string"}}})";
/// kMaxFirstData allows for these, with the longest name of a device.
constexpr std::size_t kMaxGapDefinitions = mcap::kMaxFirstData - mcap::kFirstData;

constexpr std::string_view kFeaturesJsonSchema =
    R"({"title":"scansion.Features","type":"object","properties":{"group":{"type":"integer","minimum":0},"lines":{"type)"
    R"(":"array","items":{"type":"object","properties":{"id":{"type":"integer"},"piece":{"type":"integer","default":0},)"
    R"("type":{"enum":["convex","concave","step-top","step-bottom","ridge","valley"]},"per_mm":{"type":"integer","minim)"
    R"(um":1,"description":"counts of x, y, z a mm"},"vertices":{"type":"array","items":{"type":"integer"},"description)"
    R"(":"rows of x, y, z in counts, scan line, sample; each less the row before"}},"required":["id","type","per_mm","v)"
    R"(ertices"]}}},"required":["group","lines"]})";

constexpr std::string_view kPatchesJsonSchema =
    R"({"title":"scansion.Patches","type":"object","properties":{"group":{"type":"integer","minimum":0},)"
    R"("runs":{"type":"array","items":{"type":"array"}},)"
    R"("merges":{"type":"array","items":{"type":"array","items":{"type":"integer"},"minItems":2,"maxItems":2}},)"
    R"("patches":{"type":"array","items":{"type":"object","required":["id","label","shape","samples"]}},)"
    R"("forms":{"type":"array","items":{"type":"object","required":["kind","patches","confidence"]}}},"required":["group"]})";

void schema(Builder& b, std::uint16_t id, std::string_view name, std::string_view encoding, std::string_view data) {
  const std::size_t begun = b.begin(Opcode::schema);
  b.u16(id);
  b.string(name);
  b.string(encoding);
  b.string(data);
  b.end(begun);
}

void channel(Builder& b, std::uint16_t id, std::uint16_t schema_id, std::string_view topic, std::string_view encoding) {
  const std::size_t begun = b.begin(Opcode::channel);
  b.u16(id);
  b.u16(schema_id);
  b.string(topic);
  b.string(encoding);
  b.entries({});
  b.end(begun);
}

void gap_schema(Builder& b) {
  schema(b, kGapSchema, "scansion.Gap", "jsonschema", kGapJsonSchema);
}

void gap_channel_record(Builder& b, const RecordingFacts& facts) {
  channel(b, channel_of(BlockKind::gap, facts), kGapSchema, "scan/" + facts.device + "/gaps", "json");
}

// Most recordings have no gap: what defines their channel stands in the chunk of the first one.
Bytes gap_definitions(const RecordingFacts& facts) {
  Bytes bytes;
  Builder b(bytes);
  gap_schema(b);
  gap_channel_record(b, facts);
  assert(bytes.size() <= kMaxGapDefinitions);
  return bytes;
}

void message_head(Builder& b, std::uint16_t channel_id, std::uint32_t sequence, std::uint64_t time, std::uint64_t size) {
  b.begin_sized(Opcode::message, kMessageFields + size);
  b.u16(channel_id);
  b.u32(sequence);
  b.u64(time);
  b.u64(time);
}

} // namespace

Bytes schema_records(const RecordingFacts& facts, bool gaps) {
  Bytes bytes;
  Builder b(bytes);
  schema(b, kLinesSchema, "scansion.Lines", "scansion", "");
  schema(b, kLevelSchema, "scansion.Level", "scansion", "");
  if (gaps) gap_schema(b);
  if (facts.features) {
    schema(b, kFeaturesSchema, "scansion.Features", "jsonschema", kFeaturesJsonSchema);
    schema(b, kPatchesSchema, "scansion.Patches", "jsonschema", kPatchesJsonSchema);
  }
  return bytes;
}

Bytes channel_records(const RecordingFacts& facts, bool gaps) {
  const std::string stem = "scan/" + facts.device + "/";
  Bytes bytes;
  Builder b(bytes);
  channel(b, 1, kLinesSchema, stem + "lines", "scansion");
  for (std::uint32_t k = 0; k < facts.stored_levels; ++k) {
    const std::string name = k < facts.level_count ? "lod" + std::to_string(k) : "rest";
    channel(b, static_cast<std::uint16_t>(k + 2), kLevelSchema, stem + name, "scansion");
  }
  if (gaps) gap_channel_record(b, facts);
  if (facts.features) {
    channel(b, channel_of(BlockKind::features, facts), kFeaturesSchema, stem + "features", "json");
    channel(b, channel_of(BlockKind::patches, facts), kPatchesSchema, stem + "patches", "json");
  }
  return bytes;
}

Bytes head_bytes(const RecordingFacts& facts) {
  Bytes bytes;
  Builder b(bytes);
  b.raw(mcap::kMagic);
  const std::size_t begun = b.begin(Opcode::header);
  b.string("scansion");
  b.string("scansion 1");
  b.end(begun);
  for (const Bytes& part : {schema_records(facts, false), channel_records(facts, false), facts_record(facts)})
    bytes.insert(bytes.end(), part.begin(), part.end());
  return bytes;
}

std::string gap_text(const Gap& gap) {
  const nlohmann::json reason(gap.reason);
  return R"({"first":)" + std::to_string(gap.first) + R"(,"count":)" + (gap.count ? std::to_string(*gap.count) : "null") +
         R"(,"reason":)" + reason.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "}";
}

Result<Gap> parse_gap(std::string_view text) {
  if (text.size() > kMaxGapText) return fail(Errc::damaged, "gap message is longer than 64 KiB");
  const nlohmann::json j = nlohmann::json::parse(text, nullptr, false);
  if (!j.is_object()) return fail(Errc::damaged, "gap message is no JSON object");
  const auto first = j.find("first");
  const auto count = j.find("count");
  const auto reason = j.find("reason");
  if (first == j.end() || !first->is_number_unsigned() || count == j.end() || reason == j.end() || !reason->is_string() ||
      !(count->is_null() || count->is_number_unsigned()))
    return fail(Errc::damaged, "gap message lacks first, count or reason");
  Gap gap;
  gap.first = first->get<std::uint64_t>();
  if (!count->is_null()) gap.count = count->get<std::uint64_t>();
  gap.reason = reason->get<std::string>();
  return gap;
}

void Block::build_groups(std::span<const MessageSet> groups) {
  build({}, 1, groups);
}

void Block::build_group(std::uint32_t number, std::uint64_t time, std::span<const ByteView> payloads) {
  const MessageSet set{number, time, payloads};
  build({}, 1, std::span(&set, 1));
}

void Block::build_text(const RecordingFacts& facts, BlockKind kind, std::uint32_t sequence, std::uint64_t time, ByteView text) {
  const bool first_gap = kind == BlockKind::gap && sequence == 0;
  const MessageSet set{sequence, time, std::span(&text, 1)};
  build(first_gap ? gap_definitions(facts) : Bytes{}, channel_of(kind, facts), std::span(&set, 1));
}

void Block::build(const Bytes& definitions, std::uint16_t first_channel, std::span<const MessageSet> sets) {
  const std::size_t channels = sets.front().messages.size();
  std::uint64_t records = definitions.size();
  first_time_ = last_time_ = sets.front().time;
  for (const MessageSet& set : sets) {
    first_time_ = std::min(first_time_, set.time);
    last_time_ = std::max(last_time_, set.time);
    for (const ByteView m : set.messages) records += mcap::kMessageHead + m.size();
  }
  count_ = static_cast<std::uint8_t>(sets.size());
  index_size_ = mcap::message_index_size(sets.size()) * channels;
  chunk_size_ = mcap::kChunkHead + records;

  frame_.clear();
  // Pieces point into it.
  frame_.reserve(mcap::kChunkHead + definitions.size() + mcap::kMessageHead * channels * sets.size() + index_size_);
  pieces_.clear();
  Builder b(frame_);
  b.begin_sized(Opcode::chunk, kChunkFields + records);
  b.u64(first_time_);
  b.u64(last_time_);
  b.u64(records);
  b.u32(0); // CRC, below
  b.string("");
  b.u64(records);

  frame_.insert(frame_.end(), definitions.begin(), definitions.end());
  std::uint32_t records_crc = mcap::crc32(0, definitions);
  std::size_t piece_begin = 0;
  for (const MessageSet& set : sets) {
    for (std::size_t i = 0; i < channels; ++i) {
      const std::size_t head_at = frame_.size();
      message_head(b, static_cast<std::uint16_t>(first_channel + i), set.sequence, set.time, set.messages[i].size());
      records_crc = mcap::crc32(mcap::crc32(records_crc, ByteView(frame_).subspan(head_at)), set.messages[i]);
      pieces_.push_back(ByteView(frame_).subspan(piece_begin));
      pieces_.push_back(set.messages[i]);
      piece_begin = frame_.size();
    }
  }
  store_le(frame_.data() + kCrcInChunk, records_crc);
  put_indexes(b, definitions.size(), first_channel, sets);
  pieces_.push_back(ByteView(frame_).subspan(piece_begin));

  // Payloads are passed over once: the CRC of the file continues from that of the chunk.
  crc_ = mcap::crc32(0, ByteView(frame_).first(mcap::kChunkHead));
  crc_ = mcap::crc32_joined(crc_, records_crc, records);
  crc_ = mcap::crc32(crc_, pieces_.back());
}

void Block::put_indexes(mcap::Builder& b, std::uint64_t first_offset, std::uint16_t first_channel,
                        std::span<const MessageSet> sets) {
  for (std::size_t i = 0; i < sets.front().messages.size(); ++i) {
    b.begin_sized(Opcode::message_index, mcap::message_index_size(sets.size()) - mcap::kRecordHead);
    b.u16(static_cast<std::uint16_t>(first_channel + i));
    b.u32(static_cast<std::uint32_t>(16 * sets.size())); // bytes of the array
    std::uint64_t offset = first_offset;
    for (const MessageSet& set : sets) {
      for (std::size_t k = 0; k < set.messages.size(); ++k) {
        if (k == i) {
          b.u64(set.time);
          b.u64(offset);
        }
        offset += mcap::kMessageHead + set.messages[k].size();
      }
    }
  }
}

Result<BlockStart> parse_block_start(ByteView bytes, std::uint64_t available, const RecordingFacts& facts) {
  const mcap::RecordHead head = mcap::record_head(bytes);
  if (head.opcode == 0) return fail(Errc::damaged, "cut inside the framing of a record");
  if (!mcap::is(head, Opcode::chunk)) return fail(Errc::damaged, "no record of a recording starts here");
  if (head.length > kMaxChunk - mcap::kRecordHead) return fail(Errc::damaged, "chunk claims more than 192 MiB");
  BlockStart start;
  start.chunk_size = head.length + mcap::kRecordHead;
  if (start.chunk_size > available) return fail(Errc::damaged, "chunk is cut short");
  if (start.chunk_size < mcap::kFirstData) return fail(Errc::damaged, "chunk is too short for a message");
  if (mcap::is(mcap::record_head(bytes.subspan(mcap::kChunkHead)), Opcode::schema)) {
    const Bytes definitions = gap_definitions(facts);
    if (start.chunk_size < mcap::kFirstData + definitions.size() ||
        !mcap::same(bytes.subspan(mcap::kChunkHead, definitions.size()), definitions))
      return fail(Errc::damaged, "chunk does not define the channel of gaps");
    start.first_data += definitions.size();
  }
  mcap::Cursor cursor(bytes.first(start.first_data));
  (void)cursor.take(start.first_data - mcap::kMessageHead + mcap::kRecordHead);
  const std::uint16_t channel_id = cursor.u16();
  start.sequence = cursor.u32();
  start.time = cursor.u64();
  if (channel_id != 1) {
    if (channel_id < gap_channel(facts) || channel_id >= gap_channel(facts) + text_channels(facts))
      return fail(Errc::damaged, "chunk starts with a message of an unexpected channel");
    start.kind = static_cast<BlockKind>(channel_id - gap_channel(facts) + static_cast<int>(BlockKind::gap));
    if (start.chunk_size - start.first_data > max_text(start.kind)) return fail(Errc::damaged, "a text message is too long");
  }
  return start;
}

Result<void> parse_first_index(ByteView behind_chunk, std::uint64_t available, const RecordingFacts& facts, BlockStart& start) {
  const mcap::RecordHead head = mcap::record_head(behind_chunk);
  if (!mcap::is(head, Opcode::message_index)) return fail(Errc::damaged, "message indexes of the chunk are missing");
  const std::uint64_t one = mcap::message_index_size(1);
  const std::uint64_t size = mcap::kRecordHead + std::min<std::uint64_t>(head.length, kMaxGapText);
  const std::uint64_t more = size < one ? 1 : size - one; // than an index of one message has
  if (more % 16 != 0 || more / 16 >= (start.kind == BlockKind::group ? kMaxChunkGroups : 1))
    return fail(Errc::damaged, "message indexes of the chunk are broken");
  start.groups = 1 + more / 16;
  start.block_size = start.chunk_size + size * messages_in(start.kind, facts);
  if (start.block_size > available) return fail(Errc::damaged, "message indexes of the chunk are cut short");
  return success();
}

Result<BlockStart> read_block_start(const File& file, std::uint64_t offset, std::uint64_t file_size,
                                    const RecordingFacts& facts) {
  if (offset >= file_size) return fail(Errc::damaged, "no block starts behind the end of the file");
  std::array<std::byte, mcap::kMaxFirstData> room{};
  const auto bytes = std::span(room).first(std::min<std::uint64_t>(room.size(), file_size - offset));
  SCANSION_TRY(file.read_at(offset, bytes));
  SCANSION_TRY(start, parse_block_start(bytes, file_size - offset, facts));
  const std::uint64_t behind = offset + start.chunk_size;
  const auto head = std::span(room).first(std::min<std::uint64_t>(mcap::kRecordHead, file_size - behind));
  SCANSION_TRY(file.read_at(behind, head));
  SCANSION_TRY(parse_first_index(head, file_size - offset, facts, start));
  return start;
}

Result<void> split_chunk(ByteView chunk, const BlockStart& start, const RecordingFacts& facts, std::vector<ByteView>& out) {
  out.clear();
  mcap::Cursor cursor(chunk);
  (void)cursor.take(start.first_data - mcap::kMessageHead);
  for (std::size_t i = 0; i < start.groups * messages_in(start.kind, facts); ++i) {
    const mcap::RecordHead head = mcap::record_head(cursor.take(mcap::kRecordHead));
    (void)cursor.take(kMessageFields);
    if (!mcap::is(head, Opcode::message) || head.length < kMessageFields)
      return fail(Errc::damaged, "chunk does not hold the messages of its groups");
    out.push_back(cursor.take(head.length - kMessageFields));
    if (!cursor.ok()) return fail(Errc::damaged, "message reaches beyond its chunk");
  }
  if (!cursor.at_end()) return fail(Errc::damaged, "chunk holds more than the messages of its groups");
  return success();
}

} // namespace scansion
