// Recover: what can still be read of a broken recording, as a new one that is sound.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/find_facts.hpp"
#include "pipeline/record/line_ranges.hpp"
#include "pipeline/record/metadata.hpp"
#include "pipeline/record/new_recording.hpp"
#include "pipeline/record/repair_steps.hpp"
#include "pipeline/record/tail.hpp"
#include "pipeline/record/walk.hpp"

#include <algorithm>

namespace scansion {
namespace {

constexpr std::string_view kLostReason = "lost in a damaged recording";

class Recoverer final : public WalkVisitor {
public:
  Recoverer(Window& window, NewRecording& output, const GroupInspector& inspect)
      : window_(window), output_(output.appender()), facts_(output_.facts()), inspect_(inspect) {}

  Result<RecoverReport> run() {
    SCANSION_TRY(from, begin());
    SCANSION_TRY(end, walk(window_, facts_, from, *this));
    for (const Hole& hole : unexplained(holes_, std::move(gaps_))) {
      const auto [first, last] = hole.lines;
      SCANSION_TRY(output_.append_gap({first, last - first + 1, std::string(kLostReason)}, hole.time));
      report_.lost.push_back(hole.lines);
    }
    SCANSION_TRY(lost, tail_lost());
    report_.tail_lost = lost;
    SCANSION_TRY(notes, facts_.features ? held_blocks(broken_) : Result<bool>(false));
    report_.notes_lost = notes;
    const auto ended = end.end ? end.end->ended_ns : std::nullopt;
    SCANSION_TRY(output_.finish(ended, end.end ? end.end->rounding_mm : facts_.rounding_mm));
    const RecordingEnd& totals = output_.state().totals;
    report_.groups = totals.groups;
    report_.lines = totals.lines;
    report_.points = totals.points;
    return std::move(report_);
  }

  Result<void> on_group(const FoundGroup& group) override;
  Result<void> on_gap(const Gap& gap, const ChunkEntry& entry) override;
  Result<void> on_note(const ChunkEntry& entry, ByteView text) override {
    return output_.append_note(entry.kind, text, entry.time);
  }
  Result<void> on_damage(const Damage& damage) override;

private:
  Result<std::uint64_t> begin();
  struct Stretch {
    std::uint64_t from = 0, to = 0;
    std::uint64_t chunk_end = 0; ///< as the walk told it
    std::size_t groups = 0;      ///< found in it; where there are any, it starts where the payloads of the last one end
  };
  Result<bool> held_a_group(const Stretch& stretch);
  Result<bool> held_blocks(const std::vector<Stretch>& stretches);
  Result<bool> tail_lost();
  void skip(std::uint64_t bytes) {
    report_.bytes_skipped += bytes;
    skipped_before_ = true;
  }

  Window& window_;
  Appender& output_;
  const RecordingFacts& facts_;
  const GroupInspector& inspect_;
  RecoverReport report_;
  std::vector<Hole> holes_;
  std::vector<Gap> gaps_;                  ///< without their reasons
  std::vector<Stretch> behind_last_group_; ///< broken
  std::vector<Stretch> broken_;            ///< all of them
  bool refused_behind_last_group_ = false; ///< whole, but out of order or not to be decoded
  bool skipped_before_ = false;            ///< something was skipped before the group that comes next
};

/// Behind the head when the file has the one its facts ask for, else 0.
Result<std::uint64_t> Recoverer::begin() {
  const Bytes head = head_bytes(facts_);
  SCANSION_TRY(actual, window_.view(0, head.size()));
  skipped_before_ = !mcap::same(head, actual);
  return skipped_before_ ? std::uint64_t{0} : std::uint64_t{head.size()};
}

Result<void> Recoverer::on_group(const FoundGroup& group) {
  std::uint64_t size = 0;
  for (const ByteView payload : group.payloads) size += payload.size();
  skipped_before_ = skipped_before_ || group.behind_damage;
  const GroupOrder& order = output_.state().order;
  const auto counts = order.follows(group.lines) ? inspect_(group.payloads) : fail(Errc::damaged, "out of order");
  if (!counts) {
    skip(size);
    refused_behind_last_group_ = true;
    return success();
  }
  if (group.lines.first_line > order.next_line() && (order.any() || skipped_before_))
    holes_.push_back({{order.next_line(), group.lines.first_line - 1}, group.lines.first_time_ns});
  behind_last_group_.clear();
  refused_behind_last_group_ = false;
  return output_.append_group(group.payloads, group.lines.points, counts.value());
}

Result<void> Recoverer::on_gap(const Gap& gap, const ChunkEntry& entry) {
  gaps_.push_back({gap.first, gap.count, {}});
  return output_.append_gap(gap, entry.time);
}

Result<void> Recoverer::on_damage(const Damage& damage) {
  skip(damage.to - damage.from - damage.grouped);
  behind_last_group_.push_back({damage.last_group_end, damage.to, damage.chunk_end, damage.groups});
  broken_.push_back(behind_last_group_.back());
  return success();
}

/// Without a summary: whether more is broken there than the end of a block, or a metadata record, or what stands behind all
/// data.
Result<bool> Recoverer::held_a_group(const Stretch& stretch) {
  const std::uint64_t size = stretch.to - stretch.from;
  const std::uint64_t index = mcap::message_index_size(std::min(stretch.groups, kMaxChunkGroups));
  if (stretch.groups > 0 && stretch.chunk_end > stretch.to) return true;
  if (stretch.groups > 0) return size > index * payloads_per_group(facts_) + facts_record(facts_).size();
  SCANSION_TRY(first, window_.view(stretch.from, 1));
  const bool metadata = !first.empty() && first.front() == static_cast<std::byte>(mcap::Opcode::metadata);
  return size > 0 && !(metadata && size <= kMaxMetadata);
}

/// Whether what is broken behind the last group held groups. Between groups the missing lines tell; here nothing does.
Result<bool> Recoverer::tail_lost() {
  if (refused_behind_last_group_) return true;
  return held_blocks(behind_last_group_);
}

Result<bool> Recoverer::held_blocks(const std::vector<Stretch>& stretches) {
  if (stretches.empty()) return false;
  const auto summary = read_summary(window_);
  if (!summary && summary.error().code != Errc::damaged) return summary.error();
  for (const Stretch& stretch : stretches) {
    if (summary) { // it lists every chunk there was
      const auto& chunks = summary.value().chunks;
      const auto behind = std::lower_bound(chunks.begin(), chunks.end(), stretch.to);
      if (behind != chunks.begin() &&
          summary.value().chunk_ends[static_cast<std::size_t>(behind - chunks.begin()) - 1] > stretch.from)
        return true;
    } else {
      SCANSION_TRY(held, held_a_group(stretch));
      if (held) return true;
    }
  }
  return false;
}

/// A report of what was written, once the written recording has been read back and found sound.
Result<void> prove(const std::string& path, const RecoverReport& report, const GroupInspector& inspect) {
  SCANSION_TRY(verified, verify_with(path, inspect));
  if (verified.sound && verified.groups == report.groups && verified.lines == report.lines) return success();
  const std::string what =
      verified.findings.empty() ? "other groups came back than were written" : verified.findings.front().what;
  return fail(Errc::damaged, path, ": the recovered recording is not sound (", what,
              "); it was removed: check the disk, then try again");
}

} // namespace

Result<RecoverReport> recover_with(const std::string& input, const std::string& output, const GroupInspector& inspect) {
  SCANSION_TRY(file, File::open_read(input));
  SCANSION_TRY(size, file.size());
  Window window(file, size);
  auto facts = find_facts(window);
  if (!facts) {
    Error error = std::move(facts).error();
    if (error.code == Errc::damaged)
      error.context = input +
                      ": the facts of the recording (units, lattice) are lost: the head is broken and no copy of them was "
                      "found; without them points cannot be read";
    return error;
  }
  SCANSION_TRY(recording, NewRecording::create(output, facts.value()));
  SCANSION_TRY(report, Recoverer(window, recording, inspect).run());
  SCANSION_TRY(prove(recording.temporary(), report, inspect));
  SCANSION_TRY(recording.commit());
  return std::move(report);
}

} // namespace scansion
