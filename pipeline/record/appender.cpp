// Appending whole blocks.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/appender.hpp"

#include "pipeline/record/metadata.hpp"
#include "pipeline/record/tail.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

constexpr std::uint64_t kFullChunk = 1U << 20U; ///< bytes of payloads and texts that are held back at most, but for the last

} // namespace

Appender::Appender(File file, const RecordingFacts& facts)
    : file_(std::move(file)), facts_(facts), copy_(facts_record(facts)) {}

Result<Appender> Appender::start(File file, const RecordingFacts& facts, ChunkRule rule) {
  Appender appender(std::move(file), facts);
  appender.rule_ = rule;
  const Bytes head = head_bytes(facts);
  const ByteView view(head);
  SCANSION_TRY(appender.write(std::span(&view, 1)));
  appender.state_.size = head.size();
  appender.state_.data_crc = mcap::crc32(0, head);
  appender.state_.copies.push_back(head.size() - appender.copy_.size());
  return appender;
}

Result<Appender> Appender::resume(File file, const RecordingFacts& facts, State state) {
  Appender appender(std::move(file), facts);
  appender.state_ = std::move(state);
  appender.written_groups_ = appender.state_.totals.groups;
  SCANSION_TRY(appender.file_.truncate(appender.state_.size + appender.state_.standing));
  return appender;
}

Result<void> Appender::usable() const {
  if (torn_)
    return fail(Errc::io, file_.path(),
                ": a failed write could not be cut off; nothing more is written: start another recording");
  if (finished_) return fail(Errc::usage, file_.path(), ": the recording is finished; start another one");
  return success();
}

/// After this call the file holds `pieces` behind what it held, or what it held.
Result<void> Appender::write(std::span<const ByteView> pieces) {
  std::vector<ByteView> rest;
  if (state_.standing > 0) {
    std::uint64_t skip = state_.standing;
    for (const ByteView piece : pieces) {
      const std::uint64_t here = std::min<std::uint64_t>(skip, piece.size());
      rest.push_back(piece.subspan(here));
      skip -= here;
    }
    pieces = rest;
  }
  auto written = file_.write_at(state_.size + state_.standing, pieces);
  if (!written) return cut_back(std::move(written).error());
  state_.standing = 0;
  return success();
}

Error Appender::cut_back(Error cause) {
  const auto cut = file_.truncate(state_.size + state_.standing);
  if (!cut) {
    torn_ = true;
    cause.context += "; then " + cut.error().context;
  }
  return cause;
}

Result<PayloadHeader> Appender::check(std::span<const ByteView> payloads) const {
  const auto wrong = [&](std::string_view what) {
    return fail(Errc::usage, file_.path(), ": a group cannot be written: ", what);
  };
  if (payloads.size() != payloads_per_group(facts_)) return wrong("it has not as many payloads as the recording has channels");
  PayloadHeader lines;
  std::uint64_t size = mcap::kChunkHead;
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    const auto header = parse_payload_header(payloads[i]);
    if (!header) return wrong(header.error().context);
    if (i == 0) lines = header.value();
    if (!belongs(header.value(), i, lines, facts_)) return wrong("a payload is not the next one of this stream and group");
    if (payload_size(header.value()) != payloads[i].size()) return wrong("bytes follow a payload");
    size += mcap::kMessageHead + payloads[i].size();
  }
  if (size > kMaxChunk) return wrong("it is longer than 192 MiB; close groups earlier");
  if (!state_.order.follows(lines)) return wrong("it does not follow the group before");
  return lines;
}

Result<void> Appender::append_group(std::span<const ByteView> payloads, std::uint64_t points, GroupCounts counts) {
  SCANSION_TRY(usable());
  SCANSION_TRY(lines, check(payloads));
  if (lines.points != points)
    return fail(Errc::usage, file_.path(), ": a group cannot be written: its line table counts other points than the caller");
  if (rule_ == ChunkRule::each_group) {
    const MessageSet set{lines.group, lines.first_time_ns, payloads};
    SCANSION_TRY(write_groups(std::span(&set, 1)));
  } else {
    std::uint64_t size = 0;
    for (const ByteView p : payloads) size += p.size();
    if (held_.size + size > kFullChunk) {
      SCANSION_TRY(write_held());
    }
    const std::size_t at = held_.groups.size() * payloads.size();
    if (held_.payloads.size() < at + payloads.size()) held_.payloads.resize(at + payloads.size());
    for (std::size_t i = 0; i < payloads.size(); ++i) held_.payloads[at + i].assign(payloads[i].begin(), payloads[i].end());
    held_.groups.push_back({lines.group, lines.first_time_ns});
    held_.size += size;
  }
  state_.order.take(lines);
  state_.totals.groups += 1;
  state_.totals.lines += lines.line_count;
  state_.totals.points += points;
  state_.totals.runs += counts.runs;
  state_.totals.invalid += counts.invalid;
  // Copies of the facts stand behind chunks.
  if (held_.groups.size() == kMaxChunkGroups || (facts_due(state_.totals.groups) && !held_.groups.empty())) return write_held();
  return success();
}

/// The groups are the last ones of the totals, or come next.
Result<void> Appender::write_groups(std::span<const MessageSet> groups) {
  block_.build_groups(groups);
  pieces_ = block_.pieces();
  written_groups_ += groups.size();
  const bool with_copy = facts_due(written_groups_);
  if (with_copy) pieces_.emplace_back(copy_);
  if (auto written = write(pieces_); !written) {
    written_groups_ -= groups.size();
    return written;
  }
  took_block(BlockKind::group);
  if (with_copy) {
    state_.copies.push_back(state_.size);
    state_.size += copy_.size();
    state_.data_crc = mcap::crc32(state_.data_crc, copy_);
  }
  return success();
}

Result<void> Appender::write_text(BlockKind kind, std::uint32_t sequence, std::uint64_t time, ByteView text) {
  block_.build_text(facts_, kind, sequence, time, text);
  SCANSION_TRY(write(block_.pieces()));
  took_block(kind);
  return success();
}

Result<void> Appender::write_held() {
  if (held_.groups.empty() && held_.notes.empty()) return success();
  const std::size_t stride = payloads_per_group(facts_);
  payloads_.assign(held_.payloads.begin(), held_.payloads.end());
  sets_.clear();
  for (std::size_t g = 0; g < held_.groups.size(); ++g)
    sets_.push_back({held_.groups[g].number, held_.groups[g].time, std::span(payloads_).subspan(g * stride, stride)});
  auto written = sets_.empty() ? success() : write_groups(sets_);
  for (std::size_t n = 0; written && n < held_.notes.size(); ++n) {
    const Held::Note& note = held_.notes[n];
    written = write_text(note.kind, note.sequence, note.time, note.text);
  }
  if (!written) torn_ = true; // the totals count what was held
  held_.groups.clear();
  held_.notes.clear();
  held_.size = 0;
  return written;
}

Result<void> Appender::append_gap(const Gap& gap, std::uint64_t time) {
  SCANSION_TRY(usable());
  const std::string text = gap_text(gap);
  if (text.size() > kMaxGapText)
    return fail(Errc::usage, file_.path(), ": the reason of a gap is longer than 64 KiB; shorten it");
  SCANSION_TRY(write_held());
  SCANSION_TRY(write_text(BlockKind::gap, static_cast<std::uint32_t>(state_.totals.gaps), time, mcap::bytes_of(text)));
  state_.totals.gaps += 1;
  return success();
}

Result<void> Appender::append_note(BlockKind kind, ByteView text, std::uint64_t time) {
  SCANSION_TRY(usable());
  if (!facts_.features)
    return fail(Errc::usage, file_.path(), ": the recording has no channels for feature lines; its facts say so");
  if (text.size() > kMaxNoteText)
    return fail(Errc::usage, file_.path(), ": a message about feature lines is longer than 32 MiB; write it in pieces");
  if (rule_ == ChunkRule::each_group) {
    SCANSION_TRY(write_text(kind, state_.notes, time, text));
  } else {
    held_.notes.push_back({kind, state_.notes, time, Bytes(text.begin(), text.end())});
    held_.size += text.size();
  }
  state_.notes += 1;
  return held_.size > kFullChunk ? write_held() : success();
}

void Appender::took_block(BlockKind kind) {
  state_.chunks.push_back(block_.entry(state_.size, kind));
  state_.size += block_.size();
  state_.data_crc = mcap::crc32_joined(state_.data_crc, block_.crc(), block_.size());
}

Result<void> Appender::sync() {
  SCANSION_TRY(write_held());
  SCANSION_TRY(file_.sync());
  if (!directory_synced_) {
    SCANSION_TRY(sync_directory_of(file_.path()));
    directory_synced_ = true;
  }
  return success();
}

Result<void> Appender::finish(std::optional<std::int64_t> ended_ns, double rounding_mm) {
  SCANSION_TRY(usable());
  if (!std::isfinite(rounding_mm) || rounding_mm < 0)
    return fail(Errc::usage, file_.path(), ": the rounding error at the end is no length; give a finite number of millimetres");
  SCANSION_TRY(write_held());
  RecordingEnd end = state_.totals;
  end.ended_ns = ended_ns;
  end.rounding_mm = rounding_mm;

  // The facts once more, far from the head; they belong to the tail until all of it stands.
  std::vector<std::uint64_t> copies = state_.copies;
  copies.push_back(state_.size);
  TailFacts tail;
  tail.facts = &facts_;
  tail.chunks = &state_.chunks;
  tail.copies = &copies;
  tail.end = end;
  tail.offset = state_.size + copy_.size();
  tail.data_crc = mcap::crc32(state_.data_crc, copy_);

  std::uint64_t at = state_.size;
  const ByteSink sink = [&](ByteView bytes) -> Result<void> {
    SCANSION_TRY(file_.write_at(at, std::span(&bytes, 1)));
    at += bytes.size();
    return success();
  };
  auto written = sink(copy_);
  if (written) written = make_tail(tail, sink);
  if (!written) return cut_back(std::move(written).error());
  finished_ = true;
  state_.size = at;
  state_.copies = std::move(copies);
  state_.totals = end;
  return sync();
}

} // namespace scansion
