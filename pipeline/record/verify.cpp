// Verify: every byte is either compared with what it must be or under a checksum.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/find_facts.hpp"
#include "pipeline/record/line_ranges.hpp"
#include "pipeline/record/metadata.hpp"
#include "pipeline/record/repair_steps.hpp"
#include "pipeline/record/tail.hpp"
#include "pipeline/record/walk.hpp"

namespace scansion {
namespace {

constexpr std::size_t kMaxFindings = 100;

class Verifier final : public WalkVisitor {
public:
  Verifier(Window& window, const GroupInspector& inspect) : window_(window), inspect_(inspect) {}

  Result<VerifyReport> run() {
    auto facts = find_facts(window_);
    if (!facts) return without_facts(std::move(facts).error());
    facts_ = std::move(facts).value();
    SCANSION_TRY(from, check_head());
    SCANSION_TRY(end, walk(window_, facts_, from, *this));
    check_lines();
    if (end.end) {
      SCANSION_TRY(check_tail(end));
    }
    report_.sound = report_.finished && report_.finding_count == 0;
    return std::move(report_);
  }

  Result<void> on_group(const FoundGroup& group) override;
  Result<void> on_gap(const Gap& gap, const ChunkEntry& entry) override;
  void on_block(const ChunkEntry& entry, std::uint64_t size, std::uint32_t crc) override;
  void on_copy(std::uint64_t offset, ByteView record) override;
  Result<void> on_damage(const Damage& damage) override;

private:
  Result<VerifyReport> without_facts(Error why);
  Result<std::uint64_t> check_head();
  void check_lines();
  Result<void> check_tail(const WalkEnd& end);
  Result<void> compare_tail(const TailFacts& tail);
  void check_totals(const WalkEnd& end);
  void find(std::uint64_t offset, std::string what);

  Window& window_;
  const GroupInspector& inspect_;
  RecordingFacts facts_;
  VerifyReport report_;
  RecordingEnd counted_;
  GroupOrder order_;
  std::vector<Hole> holes_;
  std::vector<Gap> gaps_; ///< without their reasons
  std::vector<ChunkEntry> chunks_;
  std::vector<std::uint64_t> copies_;
  std::uint32_t data_crc_ = 0;
  bool broken_before_ = false; ///< damage since the last group, or since the start
};

void Verifier::find(std::uint64_t offset, std::string what) {
  ++report_.finding_count;
  if (report_.findings.size() < kMaxFindings) report_.findings.push_back({offset, std::move(what)});
}

Result<VerifyReport> Verifier::without_facts(Error why) {
  if (why.code != Errc::damaged) return why;
  report_.findings.push_back({0, std::move(why.context) + " (no copy of the facts was found either)"});
  report_.finding_count = 1;
  return std::move(report_);
}

/// Returns where the walk begins: behind the head, or at 0 when something else stands there.
Result<std::uint64_t> Verifier::check_head() {
  const Bytes expected = head_bytes(facts_);
  SCANSION_TRY(actual, window_.view(0, expected.size()));
  copies_.push_back(expected.size() - facts_record(facts_).size());
  const std::uint64_t at = mcap::same_bytes(expected, actual);
  if (at == expected.size()) {
    data_crc_ = mcap::crc32(0, expected);
    report_.good_bytes = at;
    return at;
  }
  broken_before_ = true;
  find(at, at == actual.size() ? "the file ends inside its head" : "the head is not what the facts of the recording ask for");
  SCANSION_TRY(behind, window_.view(expected.size(), 1));
  const bool goes_on = !behind.empty() && behind.front() == static_cast<std::byte>(mcap::Opcode::chunk);
  return goes_on ? std::uint64_t{expected.size()} : std::uint64_t{0};
}

Result<void> Verifier::on_group(const FoundGroup& group) {
  if (!order_.follows(group.lines)) {
    find(group.offset, "group " + std::to_string(group.lines.group) + " does not follow the group before it");
    return success();
  }
  const auto counts = inspect_(group.payloads);
  if (!counts) {
    broken_before_ = true;
    find(group.offset, "group " + std::to_string(group.lines.group) + " does not decode: " + counts.error().context);
    return success();
  }
  broken_before_ = broken_before_ || group.behind_damage;
  const bool first_of_all = !order_.any();
  const std::uint64_t expected = order_.next_line();
  if (group.lines.first_line > expected && (!first_of_all || broken_before_))
    holes_.push_back({{expected, group.lines.first_line - 1}, group.lines.first_time_ns});
  order_.take(group.lines);
  broken_before_ = false;
  counted_.groups += 1;
  counted_.lines += group.lines.line_count;
  counted_.points += group.lines.points;
  counted_.runs += counts.value().runs;
  counted_.invalid += counts.value().invalid;
  return success();
}

Result<void> Verifier::on_gap(const Gap& gap, const ChunkEntry& /*entry*/) {
  counted_.gaps += 1;
  gaps_.push_back({gap.first, gap.count, {}});
  return success();
}

void Verifier::on_block(const ChunkEntry& entry, std::uint64_t size, std::uint32_t crc) {
  chunks_.push_back(entry);
  data_crc_ = mcap::crc32_joined(data_crc_, crc, size);
  report_.good_bytes = entry.offset + size;
}

void Verifier::on_copy(std::uint64_t offset, ByteView record) {
  copies_.push_back(offset);
  data_crc_ = mcap::crc32(data_crc_, record);
}

Result<void> Verifier::on_damage(const Damage& damage) {
  broken_before_ = true;
  find(damage.at, damage.what + " (bytes " + std::to_string(damage.from) + " to " + std::to_string(damage.to) + ")");
  return success();
}

void Verifier::check_lines() {
  report_.groups = counted_.groups;
  report_.lines = counted_.lines;
  report_.points = counted_.points;
  report_.gaps = counted_.gaps;
  for (const Hole& hole : unexplained(holes_, std::move(gaps_))) report_.lost.push_back(hole.lines);
  if (report_.finding_count == 0 && !report_.lost.empty())
    find(report_.good_bytes, "lines " + std::to_string(report_.lost.front().first) + " to " +
                                 std::to_string(report_.lost.front().second) + " are missing and no gap message names them");
}

void Verifier::check_totals(const WalkEnd& end) {
  counted_.ended_ns = end.end->ended_ns;
  counted_.rounding_mm = end.end->rounding_mm;
  if (*end.end != counted_) find(end.offset, "the totals at the end are not those of the groups");
}

Result<void> Verifier::check_tail(const WalkEnd& end) {
  SCANSION_TRY(finished, ends_with_footer(window_));
  report_.finished = finished;
  if (report_.finding_count == 0) {
    check_totals(end);
    return compare_tail({&facts_, &chunks_, &copies_, *end.end, end.offset, data_crc_});
  }
  // What the tail must say cannot be known with parts of the data missing: its own checksum tells.
  if (!finished) {
    find(window_.size(), "the file does not end with a footer: it was cut, or something follows");
    return success();
  }
  const auto summary = read_summary(window_);
  if (summary) return success();
  if (summary.error().code != Errc::damaged) return summary.error();
  find(end.offset, summary.error().context);
  return success();
}

Result<void> Verifier::compare_tail(const TailFacts& tail) {
  std::uint64_t at = tail.offset;
  bool differs = false;
  const ByteSink compare = [&](ByteView expected) -> Result<void> {
    if (differs) return success();
    SCANSION_TRY(actual, window_.view(at, expected.size()));
    const std::size_t equal = mcap::same_bytes(expected, actual);
    at += equal;
    differs = equal < expected.size();
    if (differs)
      find(at, at >= window_.size() ? "the file ends inside its end records"
                                    : "data end, summary or footer are not what the data asks for");
    return success();
  };
  SCANSION_TRY(make_tail(tail, compare));
  if (!differs && at != window_.size()) {
    report_.finished = true; // a whole recording, then something else
    find(at, std::to_string(window_.size() - at) + " bytes follow the end of the recording");
  }
  return success();
}

} // namespace

Result<VerifyReport> verify_with(const std::string& path, const GroupInspector& inspect) {
  SCANSION_TRY(file, File::open_read(path));
  SCANSION_TRY(size, file.size());
  Window window(file, size);
  return Verifier(window, inspect).run();
}

} // namespace scansion
