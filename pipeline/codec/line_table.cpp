// The body of a lines payload.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/line_table.hpp"

#include "pipeline/codec/endian.hpp"

#include <algorithm>
#include <limits>

namespace scansion {
namespace {

constexpr std::uint8_t kExact = 1;
constexpr std::uint8_t kFan = 2;
constexpr std::uint8_t kRuled = 4; // of x; the others follow
constexpr std::uint8_t kKnownGroupFlags = 31;

enum LineFlag : std::uint8_t {
  kDevice = 1,
  kMonotonic = 2,
  kRealtime = 4,
  kEncoder = 8,
  kPlane = 16,
  kOneRun = 32,   ///< one run and no invalid sample: only its count follows
  kRepeated = 64, ///< how many lines more are the same follows behind all else; they have neither stamps nor planes
};
constexpr std::uint8_t kKnownFlags = 127;
constexpr std::uint8_t kOfItsOwn = kDevice | kMonotonic | kRealtime | kEncoder | kPlane;

// The stamps in the order they are stored, each with its flag.
struct StampField {
  std::uint8_t flag;
  std::optional<std::int64_t> Stamps::*member;
};
constexpr std::array<StampField, 4> kStamps{{{kDevice, &Stamps::device_ns},
                                             {kMonotonic, &Stamps::host_monotonic_ns},
                                             {kRealtime, &Stamps::host_realtime_ns},
                                             {kEncoder, &Stamps::encoder}}};

std::int64_t wrapping_difference(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}
std::int64_t wrapping_sum(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

Result<void> read_runs(ByteReader& from, std::uint8_t flags, std::uint32_t limit, LineGroup& group, ScanLine& line) {
  const bool one = (flags & kOneRun) != 0;
  const std::uint64_t run_count = one ? 1 : from.varint();
  if (!from.ok() || run_count > limit) return fail(Errc::damaged, "a line has more runs than the group has points");
  line.first_run = static_cast<std::uint32_t>(group.runs.size());
  line.run_count = static_cast<std::uint32_t>(run_count);
  auto next = group.runs.empty() ? 0U : group.runs.back().first + group.runs.back().count;
  for (std::uint64_t r = 0; r < run_count; ++r) {
    const std::uint64_t invalid = one ? 0 : from.varint();
    const std::uint64_t count = from.varint();
    if (!from.ok() || invalid > std::numeric_limits<std::uint32_t>::max() || count == 0 || count > limit - next)
      return fail(Errc::damaged, "the runs of a line do not fit the group");
    group.runs.push_back({next, static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(invalid)});
    next += static_cast<std::uint32_t>(count);
  }
  const std::uint64_t after = one ? 0 : from.varint();
  if (after > std::numeric_limits<std::uint32_t>::max()) return fail(Errc::damaged, "a line counts too many invalid samples");
  line.invalid_after = static_cast<std::uint32_t>(after);
  return success();
}

void read_stamps(ByteReader& from, std::uint8_t flags, Stamps& last, ScanLine& line) {
  for (const auto& [flag, member] : kStamps) {
    if ((flags & flag) == 0) continue;
    const std::int64_t value = wrapping_sum((last.*member).value_or(0), from.signed_varint());
    line.stamps.*member = value;
    last.*member = value;
  }
  if ((flags & kPlane) != 0) {
    auto& plane = line.plane.emplace();
    for (double& coefficient : plane) {
      const ByteView raw = from.bytes(8);
      if (!raw.empty()) coefficient = std::bit_cast<double>(load_le<std::uint64_t>(raw.data()));
    }
  }
}

// Lines `count` times the same as the last one of the group.
Result<void> repeat_line(std::uint64_t count, std::uint32_t limit, LineGroup& group) {
  for (; count > 0; --count) {
    ScanLine line = group.lines.back();
    ++line.index;
    for (std::uint32_t r = 0; r < line.run_count; ++r) {
      Run run = group.runs[line.first_run + r];
      run.first = group.runs.back().first + group.runs.back().count;
      if (run.count > limit - run.first) return fail(Errc::damaged, "the runs of a line do not fit the group");
      group.runs.push_back(run);
    }
    line.first_run += line.run_count;
    group.lines.push_back(line);
  }
  return success();
}

bool same_lines(const LineGroup& group, const ScanLine& a, const ScanLine& b) noexcept {
  return !b.plane && b.stamps == Stamps{} && a.invalid_after == b.invalid_after &&
         std::ranges::equal(group.runs_of(a), group.runs_of(b), [](const Run& x, const Run& y) {
           return x.count == y.count && x.invalid_before == y.invalid_before;
         });
}

} // namespace

void write_line_table(const LineGroup& group, const GroupFacts& facts, Bytes& to) {
  unsigned flags_of_all = (facts.exact ? kExact : 0U) | (facts.fan.empty() ? 0U : kFan);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (facts.scales[axis].ruled) flags_of_all |= unsigned{kRuled} << axis;
  to.push_back(static_cast<std::byte>(flags_of_all));
  for (const AxisScale& scale : facts.scales) {
    put_signed(to, scale.base);
    put_varint(to, std::uint64_t{scale.step} << 2U | (scale.even ? 2U : 0U) | (scale.split ? 1U : 0U));
  }
  if (!facts.fan.empty()) write_fan(facts.fan, to);
  Stamps last;
  for (std::size_t l = 0; l < group.lines.size(); ++l) {
    const ScanLine& line = group.lines[l];
    const auto runs = group.runs_of(line);
    const bool one = runs.size() == 1 && runs[0].invalid_before == 0 && line.invalid_after == 0;
    std::uint8_t flags = one ? kOneRun : 0;
    for (const auto& [flag, member] : kStamps)
      if (line.stamps.*member) flags = static_cast<std::uint8_t>(flags | flag);
    if (line.plane) flags |= kPlane;
    std::size_t same = 0;
    while ((flags & kOfItsOwn) == 0 && l + same + 1 < group.lines.size() && same_lines(group, line, group.lines[l + same + 1]))
      ++same;
    if (same > 0) flags |= kRepeated;
    to.push_back(static_cast<std::byte>(flags));
    if (!one) put_varint(to, runs.size());
    for (const Run& run : runs) {
      if (!one) put_varint(to, run.invalid_before);
      put_varint(to, run.count);
    }
    if (!one) put_varint(to, line.invalid_after);
    for (const auto& [flag, member] : kStamps) {
      if (!(line.stamps.*member)) continue;
      put_signed(to, wrapping_difference(*(line.stamps.*member), (last.*member).value_or(0)));
      last.*member = line.stamps.*member;
    }
    if (line.plane)
      for (const double coefficient : *line.plane) append_le(to, std::bit_cast<std::uint64_t>(coefficient));
    if (same > 0) put_varint(to, same);
    l += same;
  }
}

Result<void> read_line_table(ByteView table, const PayloadHeader& header, LineGroup& group, GroupFacts& facts) {
  ByteReader from(table);
  const std::uint8_t flags_of_all = from.byte();
  if (flags_of_all > kKnownGroupFlags) return fail(Errc::damaged, "the line table has unknown flags");
  facts.exact = (flags_of_all & kExact) != 0;
  facts.fan.clear();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t base = from.signed_varint();
    const std::uint64_t packed = from.varint();
    const std::uint64_t step = packed >> 2U;
    if (!from.ok() || base != static_cast<std::int32_t>(base) || step == 0 || step > std::numeric_limits<std::uint32_t>::max())
      return fail(Errc::damaged, "the line table has an impossible axis scale");
    const bool even = (packed & 2U) != 0;
    const bool ruled = (flags_of_all & unsigned{kRuled} << axis) != 0;
    if (ruled && !even) return fail(Errc::damaged, "the line table has an axis that is ruled and not even");
    facts.scales[axis] = {static_cast<std::int32_t>(base), static_cast<std::uint32_t>(step), (packed & 1U) != 0, even, ruled};
  }
  if ((flags_of_all & kFan) != 0) {
    SCANSION_TRY(read_fan(from, header.points, facts.fan));
  }
  Stamps last;
  group.clear();
  group.number = header.group;
  while (group.lines.size() < header.line_count) {
    const std::uint8_t flags = from.byte();
    if (!from.ok() || flags > kKnownFlags) return fail(Errc::damaged, "a line has unknown flags");
    ScanLine line;
    line.index = header.first_line + group.lines.size();
    SCANSION_TRY(read_runs(from, flags, header.points, group, line));
    read_stamps(from, flags, last, line);
    group.lines.push_back(line);
    const bool repeated = (flags & kRepeated) != 0;
    const std::uint64_t same = repeated ? from.varint() : 0;
    if (!from.ok()) return fail(Errc::damaged, "the line table is cut short");
    if (repeated && ((flags & kOfItsOwn) != 0 || same == 0 || same > header.line_count - group.lines.size()))
      return fail(Errc::damaged, "a line is repeated in an impossible way");
    SCANSION_TRY(repeat_line(same, header.points, group));
  }
  const std::uint32_t points = group.runs.empty() ? 0 : group.runs.back().first + group.runs.back().count;
  if (!from.at_end() || points != header.points) return fail(Errc::damaged, "the line table and its header disagree");
  return success();
}

} // namespace scansion
