// Walking the data section.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/walk.hpp"

#include "pipeline/record/metadata.hpp"
#include "pipeline/record/notes.hpp"
#include "pipeline/record/salvage.hpp"

namespace scansion {
namespace {

using namespace std::string_view_literals;

/// What can start behind a broken stretch. The first data of a chunk is a payload's mark or a gap's text, at a fixed distance
/// from the chunk's first byte; before the first gap of all its schema stands there; the name of a Metadata record stands
/// behind its framing.
constexpr std::string_view kMarkPattern{"\x89SCNGRP\n", 8};
constexpr std::array kRestarts{kMarkPattern,           R"({"first":)"sv,          R"({"group":)"sv, "\x0c\0\0\0scansion.Gap"sv,
                               "\x08\0\0\0scansion"sv, "\x0c\0\0\0scansion.end"sv};
constexpr std::uint64_t kFirstName = mcap::kChunkHead + mcap::kRecordHead + 2; // behind the id of a schema
constexpr std::array<std::uint64_t, kRestarts.size()> kStartBefore{mcap::kFirstData, mcap::kFirstData,  mcap::kFirstData,
                                                                   kFirstName,       mcap::kRecordHead, mcap::kRecordHead};

enum class What : std::uint8_t { group, gap, note, copy, end, nothing };

/// What stands at one offset. Views live until the next look.
struct Item {
  What what = What::nothing;
  std::uint64_t size = 0;
  ChunkEntry entry;
  std::uint32_t crc = 0;            ///< of the block
  std::vector<PayloadHeader> lines; ///< of each group
  Gap gap;
  RecordingEnd end;
  ByteView copy;
  std::uint64_t wrong_at = 0; ///< nothing: where
  std::string why;            ///< nothing: why
};

class Walker {
public:
  Walker(Window& window, const RecordingFacts& facts, WalkVisitor& visitor)
      : window_(window), facts_(facts), visitor_(visitor), copy_(facts_record(facts)), budget_(window.size()),
        restarts_(window, kRestarts) {}

  Result<WalkEnd> run(std::uint64_t from) {
    std::uint64_t at = from;
    while (at < window_.size()) {
      SCANSION_TRY(item, look(at));
      if (item.what == What::end) return WalkEnd{at, item.end};
      if (item.what == What::nothing) {
        SCANSION_TRY(next, broken(at, item));
        at = next;
      } else {
        SCANSION_TRY(tell(at, item));
        at += item.size;
      }
    }
    return WalkEnd{window_.size(), std::nullopt};
  }

private:
  Result<Item> look(std::uint64_t at);
  Result<Item> look_at_block(std::uint64_t at);
  Result<Item> look_at_metadata(std::uint64_t at, const mcap::RecordHead& head);
  Result<void> tell(std::uint64_t at, const Item& item);
  Result<std::uint64_t> broken(std::uint64_t at, const Item& item);
  Result<std::uint64_t> next_start(std::uint64_t after);
  std::optional<std::uint64_t> first_difference(ByteView block) const;

  static Item nothing(std::uint64_t wrong_at, std::string why) {
    Item item;
    item.wrong_at = wrong_at;
    item.why = std::move(why);
    return item;
  }

  Window& window_;
  const RecordingFacts& facts_;
  WalkVisitor& visitor_;
  Bytes copy_;
  WorkBudget budget_;
  PatternFinder restarts_;
  Block block_;
  std::vector<ByteView> payloads_;
  std::vector<MessageSet> sets_;
};

Result<Item> Walker::look(std::uint64_t at) {
  SCANSION_TRY(start, window_.view(at, mcap::kRecordHead));
  const mcap::RecordHead head = mcap::record_head(start);
  if (mcap::is(head, mcap::Opcode::metadata)) return look_at_metadata(at, head);
  return look_at_block(at);
}

Result<Item> Walker::look_at_metadata(std::uint64_t at, const mcap::RecordHead& head) {
  if (head.length > kMaxMetadata) return nothing(at, "metadata record claims more than 64 KiB");
  SCANSION_TRY(record, window_.view(at, mcap::kRecordHead + head.length));
  if (record.size() < mcap::kRecordHead + head.length) return nothing(at, "metadata record is cut short");
  Item item;
  item.size = record.size();
  if (mcap::same(record, copy_)) {
    item.what = What::copy;
    item.copy = record;
    return item;
  }
  const auto end = parse_end(record.subspan(mcap::kRecordHead));
  if (!end) return nothing(at, "metadata record is broken: neither the facts of this recording nor its end");
  item.what = What::end;
  item.end = end.value();
  return item;
}

std::optional<std::uint64_t> Walker::first_difference(ByteView block) const {
  std::uint64_t at = 0;
  for (const ByteView piece : block_.pieces()) {
    const ByteView theirs = block.subspan(at, piece.size());
    const std::size_t equal = piece.data() == theirs.data() ? piece.size() : mcap::same_bytes(piece, theirs);
    if (equal < piece.size()) return at + equal;
    at += piece.size();
  }
  return std::nullopt;
}

Result<Item> Walker::look_at_block(std::uint64_t at) {
  const auto start = read_block_start(window_.file(), at, window_.size(), facts_);
  if (!start && start.error().code != Errc::damaged) return start.error();
  if (!start) return nothing(at, start.error().context);
  const BlockStart& s = start.value();
  SCANSION_TRY(budget_.spend(s.block_size, window_.file()));
  SCANSION_TRY(block, window_.view(at, s.block_size));
  const auto split = split_chunk(block.first(s.chunk_size), s, facts_, payloads_);
  if (!split) return nothing(at, split.error().context);

  Item item;
  item.size = s.block_size;
  sets_.clear();
  if (s.kind == BlockKind::gap) {
    auto gap = parse_gap(mcap::text_of(payloads_.front()));
    if (!gap) return nothing(at + s.first_data, gap.error().context);
    item.what = What::gap;
    item.gap = std::move(gap).value();
    block_.build_text(facts_, s.kind, s.sequence, s.time, payloads_.front());
    if (gap_text(item.gap) != mcap::text_of(payloads_.front()))
      return nothing(at + s.first_data, "gap message is not as written");
  } else if (s.kind != BlockKind::group) {
    FeatureReport report;
    const std::string_view text = mcap::text_of(payloads_.front());
    const auto read =
        s.kind == BlockKind::features ? parse_features_message(text, report) : parse_patches_message(text, report);
    if (!read) return nothing(at + s.first_data, read.error().context);
    item.what = What::note;
    block_.build_text(facts_, s.kind, s.sequence, s.time, payloads_.front());
  } else {
    const std::size_t stride = payloads_per_group(facts_);
    for (std::size_t g = 0; g < s.groups; ++g) {
      const auto payloads = std::span(payloads_).subspan(g * stride, stride);
      const auto lines = check_group(payloads, facts_);
      if (!lines) return nothing(at, lines.error().context);
      item.lines.push_back(lines.value());
      sets_.push_back({lines.value().group, lines.value().first_time_ns, payloads});
    }
    item.what = What::group;
    block_.build_groups(sets_);
  }
  if (const auto differs = first_difference(block))
    return nothing(at + *differs, "framing or checksum of a chunk is not what its payloads ask for");
  item.entry = block_.entry(at, s.kind);
  item.crc = block_.crc();
  return item;
}

Result<void> Walker::tell(std::uint64_t at, const Item& item) {
  if (item.what == What::copy) {
    visitor_.on_copy(at, item.copy);
    return success();
  }
  if (item.what == What::group) {
    const std::size_t stride = payloads_per_group(facts_);
    for (std::size_t g = 0; g < item.lines.size(); ++g) {
      SCANSION_TRY(visitor_.on_group({item.lines[g], std::span(payloads_).subspan(g * stride, stride), at, true}));
    }
  }
  if (item.what == What::gap) {
    SCANSION_TRY(visitor_.on_gap(item.gap, item.entry));
  }
  if (item.what == What::note) {
    SCANSION_TRY(visitor_.on_note(item.entry, payloads_.front()));
  }
  visitor_.on_block(item.entry, item.size, item.crc);
  return success();
}

/// The first offset behind `after` where something intact starts; the size of the file when nothing does.
Result<std::uint64_t> Walker::next_start(std::uint64_t after) {
  for (std::uint64_t at = after; at < window_.size();) {
    SCANSION_TRY(hit, restarts_.find(at, window_.size()));
    if (!hit) break;
    at = hit->offset + 1;
    const std::uint64_t before = kStartBefore[hit->pattern];
    if (hit->offset < before || hit->offset - before <= after) continue;
    const std::uint64_t start = hit->offset - before;
    SCANSION_TRY(item, look(start));
    if (item.what != What::nothing) return start;
  }
  return window_.size();
}

Result<std::uint64_t> Walker::broken(std::uint64_t at, const Item& item) {
  WalkVisitor::Damage damage;
  damage.from = at;
  damage.at = item.wrong_at;
  damage.what = item.why;
  SCANSION_TRY(start, window_.view(at, mcap::kRecordHead));
  const mcap::RecordHead head = mcap::record_head(start);
  if (mcap::is(head, mcap::Opcode::chunk) && head.length < kMaxChunk) damage.chunk_end = at + mcap::kRecordHead + head.length;
  SCANSION_TRY(next, next_start(at));
  damage.to = next;
  SCANSION_TRY(salvaged, salvage_groups(window_, facts_, at, next, budget_, [this, at, &damage](FoundGroup group) {
                 group.behind_damage = damage.groups++ == 0 && group.offset > at + mcap::kFirstData;
                 return visitor_.on_group(group);
               }));
  damage.grouped = salvaged.grouped;
  damage.last_group_end = salvaged.last_end;
  SCANSION_TRY(visitor_.on_damage(damage));
  return next;
}

} // namespace

Result<WalkEnd> walk(Window& window, const RecordingFacts& facts, std::uint64_t from, WalkVisitor& visitor) {
  return Walker(window, facts, visitor).run(from);
}

} // namespace scansion
