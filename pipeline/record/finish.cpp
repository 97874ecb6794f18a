// Finishes what a killed writer left: cut after the last whole block, then end, summary and footer.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/appender.hpp"
#include "pipeline/record/find_facts.hpp"
#include "pipeline/record/metadata.hpp"
#include "pipeline/record/repair_steps.hpp"
#include "pipeline/record/tail.hpp"
#include "pipeline/record/walk.hpp"

#include <algorithm>

namespace scansion {
namespace {

/// Collects what the interrupted writer knew. Stops at damage that has good groups behind it: cutting there would lose them.
class Finisher final : public WalkVisitor {
public:
  Finisher(Window& window, const GroupInspector& count_lines) : window_(window), count_lines_(count_lines) {}

  Result<void> run() {
    SCANSION_TRY(head, read_head(window_));
    facts_ = head.facts;
    const Bytes expected = head_bytes(facts_);
    SCANSION_TRY(actual, window_.view(0, expected.size()));
    if (!mcap::same(expected, actual)) return refuse("its head is broken");
    state_.size = expected.size();
    state_.data_crc = mcap::crc32(0, expected);
    state_.copies.push_back(expected.size() - copy_size());
    SCANSION_TRY(end, walk(window_, facts_, state_.size, *this));
    ended_ = end.end;
    return measure_torn();
  }

  /// The group whose payloads are whole while its message indexes were cut off; written again at its place.
  [[nodiscard]] Result<void> complete(Appender& appender) const {
    if (!torn_) return success();
    const std::vector<ByteView> views(torn_->payloads.begin(), torn_->payloads.end());
    return appender.append_group(views, torn_->lines.points, torn_->counts);
  }

  [[nodiscard]] const RecordingFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] Appender::State take_state() { return std::move(state_); }
  [[nodiscard]] const std::optional<RecordingEnd>& ended() const noexcept { return ended_; }

  Result<void> on_group(const FoundGroup& group) override;
  Result<void> on_gap(const Gap& gap, const ChunkEntry& entry) override;
  Result<void> on_note(const ChunkEntry& /*entry*/, ByteView /*text*/) override {
    state_.notes += 1;
    return success();
  }
  void on_block(const ChunkEntry& entry, std::uint64_t size, std::uint32_t crc) override;
  void on_copy(std::uint64_t offset, ByteView record) override;
  Result<void> on_damage(const Damage& damage) override;

private:
  struct TornGroup {
    std::vector<Bytes> payloads;
    PayloadHeader lines;
    GroupCounts counts;
  };
  [[nodiscard]] std::uint64_t copy_size() const;
  [[nodiscard]] Result<void> measure_torn();
  [[nodiscard]] Result<void> refuse(std::string_view why) const {
    return fail(Errc::damaged, window_.file().path(), ": cannot be finished in place without losing whole groups: ", why,
                "; use scansion recover");
  }

  Window& window_;
  const GroupInspector& count_lines_;
  RecordingFacts facts_;
  Appender::State state_;
  std::optional<RecordingEnd> ended_;
  std::optional<TornGroup> torn_;
};

std::uint64_t Finisher::copy_size() const {
  return facts_record(facts_).size();
}

Result<void> Finisher::on_group(const FoundGroup& group) {
  if (!state_.order.follows(group.lines)) return refuse("groups stand out of order");
  if (!group.framed && (torn_ || group.offset != state_.size + mcap::kFirstData))
    return refuse("groups stand in a broken stretch");
  auto counts = count_lines_(group.payloads);
  if (!counts) return refuse(counts.error().context);
  if (!group.framed) {
    torn_.emplace(TornGroup{{}, group.lines, counts.value()});
    for (const ByteView payload : group.payloads) torn_->payloads.emplace_back(payload.begin(), payload.end());
    return success();
  }
  state_.order.take(group.lines);
  state_.totals.groups += 1;
  state_.totals.lines += group.lines.line_count;
  state_.totals.points += group.lines.points;
  state_.totals.runs += counts.value().runs;
  state_.totals.invalid += counts.value().invalid;
  return success();
}

Result<void> Finisher::on_gap(const Gap& /*gap*/, const ChunkEntry& /*entry*/) {
  state_.totals.gaps += 1;
  return success();
}

void Finisher::on_block(const ChunkEntry& entry, std::uint64_t size, std::uint32_t crc) {
  state_.chunks.push_back(entry);
  state_.data_crc = mcap::crc32_joined(state_.data_crc, crc, size);
  state_.size = entry.offset + size;
}

void Finisher::on_copy(std::uint64_t offset, ByteView record) {
  state_.copies.push_back(offset);
  state_.data_crc = mcap::crc32(state_.data_crc, record);
  state_.size = offset + record.size();
}

Result<void> Finisher::on_damage(const Damage& damage) {
  if (damage.to != window_.size())
    return refuse("bytes " + std::to_string(damage.from) + " to " + std::to_string(damage.to) +
                  " are broken and blocks follow");
  return success();
}

/// What stands behind the last whole block must be the beginning of the torn group's block, to the last byte.
Result<void> Finisher::measure_torn() {
  if (!torn_) return success();
  const std::vector<ByteView> views(torn_->payloads.begin(), torn_->payloads.end());
  Block block;
  block.build_group(torn_->lines.group, torn_->lines.first_time_ns, views);
  state_.standing = window_.size() - state_.size;
  std::uint64_t at = 0;
  for (const ByteView piece : block.pieces()) {
    const std::uint64_t left = state_.standing - std::min(at, state_.standing);
    const ByteView expected = piece.first(std::min<std::uint64_t>(piece.size(), left));
    SCANSION_TRY(actual, window_.view(state_.size + at, expected.size()));
    if (!mcap::same(expected, actual)) return refuse("the framing of the last group is broken");
    at += piece.size();
  }
  if (state_.standing > at) return refuse("the framing of the last group is broken");
  return success();
}

} // namespace

Result<std::uint64_t> finish_in_place_with(const std::string& path, const GroupInspector& count_lines) {
  SCANSION_TRY(file, File::open_update(path));
  SCANSION_TRY(size, file.size());
  Window window(file, size);
  SCANSION_TRY(read_head(window)); // a footer alone makes no recording
  SCANSION_TRY(finished, ends_with_footer(window));
  if (finished) return std::uint64_t{0};

  Finisher finisher(window, count_lines);
  SCANSION_TRY(finisher.run());
  Appender::State state = finisher.take_state();
  const std::uint64_t kept = state.size + state.standing;
  SCANSION_TRY(appender, Appender::resume(std::move(file), finisher.facts(), std::move(state)));
  SCANSION_TRY(finisher.complete(appender));
  const auto& ended = finisher.ended();
  SCANSION_TRY(
      appender.finish(ended ? ended->ended_ns : std::nullopt, ended ? ended->rounding_mm : finisher.facts().rounding_mm));
  return size - kept;
}

} // namespace scansion
