// Recover: every whole group comes back, every lost line is named, and the result is sound.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/synthetic.hpp"

#include "pipeline/record/metadata.hpp"

#include <filesystem>
#include <map>
#include <random>
#include <unistd.h>

namespace scansion::synthetic {
namespace {

RecoverReport recovered(const std::string& input, const std::string& output) {
  auto report = recover_with(input, output, inspector());
  if (!report) {
    ADD_FAILURE() << report.error().context;
    return {};
  }
  return std::move(report).value();
}

/// The groups of a recording, by number, with their payload bytes.
std::map<std::uint32_t, std::vector<Bytes>> groups_of(const std::string& path) {
  std::map<std::uint32_t, std::vector<Bytes>> groups;
  auto reader = RecordingReader::open(path);
  EXPECT_OK(reader);
  for (std::size_t i = 0; i < reader.value().groups().size(); ++i) {
    const GroupEntry& entry = reader.value().groups()[i];
    for (std::size_t k = 0; k < entry.payloads.size(); ++k)
      EXPECT_OK(reader.value().read_payload(i, k, groups[entry.number].emplace_back()));
  }
  return groups;
}

void expect_groups(const std::string& path, const Made& made, const std::vector<std::uint32_t>& numbers) {
  const auto groups = groups_of(path);
  ASSERT_EQ(groups.size(), numbers.size());
  for (const std::uint32_t n : numbers) {
    ASSERT_TRUE(groups.contains(n)) << n;
    EXPECT_EQ(groups.at(n), made.groups[n].payloads) << "payload bytes are unchanged";
  }
}

TEST(Recover, SoundRecordingComesBackWhole) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 4, .gap_after_first = true});
  const RecoverReport report = recovered(folder / "a.mcap", folder / "b.mcap");
  EXPECT_FALSE(report.anything_lost());
  EXPECT_EQ(report.groups, 4U);
  EXPECT_EQ(report.bytes_skipped, 0U);
  expect_groups(folder / "b.mcap", made, {0, 1, 2, 3});
  // Files that get their name when complete have chunks of many groups; such a one comes back byte for byte.
  recovered(folder / "b.mcap", folder / "c.mcap");
  EXPECT_EQ(read_file(folder / "b.mcap"), read_file(folder / "c.mcap"));
}

/// Far from every border of records.
bool inside_a_body(const Made& made, std::uint64_t offset) {
  for (std::size_t i = 0; i < made.groups.size(); ++i) {
    std::uint64_t end = made.payloads_end[i];
    for (std::size_t k = made.groups[i].payloads.size(); k-- > 0;) {
      const std::uint64_t begin = end - made.groups[i].payloads[k].size();
      if (offset > begin + kLongestPayloadHeader + 20 && offset + 20 < end) return true;
      end = begin - 31;
    }
  }
  return false;
}

/// A recording cut at every byte of its last 64 KiB, every whole group comes back.
TEST(Recover, EveryCutOfTheLast64KiB) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 5, .body = 3300});
  const std::uint64_t lowest = made.size - std::min<std::uint64_t>(made.size, 64U << 10U);
  for (std::uint64_t size = made.size; size-- > lowest;) {
    if (!kThorough && size % 13 != 0 && inside_a_body(made, size)) continue;
    ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(size)), 0);
    const auto result = recover_with(path, folder / "b.mcap", inspector());
    if (size < made.head) {
      EXPECT_EQ(result.error().code, size == 0 ? Errc::undecodable : Errc::damaged) << size;
      continue;
    }
    ASSERT_OK(result);
    std::uint64_t whole = 0;
    std::uint64_t group_bytes = made.head; // bytes that are known to end a group or the head
    for (std::size_t i = 0; i < made.groups.size(); ++i)
      if (made.payloads_end[i] <= size) {
        ++whole;
        group_bytes = made.block_end[i];
      }
    ASSERT_EQ(result.value().groups, whole) << size;
    ASSERT_TRUE(result.value().lost.empty()) << size;
    // Behind the last group may stand its copy of the facts, and behind all groups the end: no line is in those.
    const bool in_group =
        size > group_bytes && whole < made.groups.size() &&
        !(whole == 1 && size <= made.block_end[0] + 1000 && size <= group_bytes + facts_record(facts()).size());
    ASSERT_EQ(result.value().tail_lost, in_group) << size;
    ASSERT_EQ(::unlink((folder / "b.mcap").c_str()), 0);
  }
}

TEST(Recover, GoodGroupsBeforeAndAfterDamageComeBack) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 8, .gap_after_first = true});
  Bytes bytes = read_file(folder / "a.mcap");
  bytes[made.payloads_end[2] - 3] ^= std::byte{0x40};
  for (std::uint64_t at = made.block_end[4] + 5; at < made.payloads_end[5]; ++at) bytes[at] = std::byte{0};
  write_file(folder / "broken.mcap", bytes);
  const RecoverReport report = recovered(folder / "broken.mcap", folder / "b.mcap");
  EXPECT_EQ(report.groups, 6U);
  EXPECT_EQ(report.lost, (std::vector<LineRange>{{134, 197}, {326, 389}}));
  EXPECT_FALSE(report.tail_lost);
  expect_groups(folder / "b.mcap", made, {0, 1, 3, 4, 6, 7});
  const auto reader = RecordingReader::open(folder / "b.mcap");
  ASSERT_OK(reader);
  const auto& gaps = reader.value().gaps();
  ASSERT_EQ(gaps.size(), 3U);
  EXPECT_EQ(gaps[0], (Gap{64, 6, "the \"device\" said: \xC3\xBC"})) << "gap messages of the input are copied";
  EXPECT_EQ(gaps[1].first, 134U);
  EXPECT_EQ(gaps[1].count, 64U);
}

TEST(Recover, LastGroupOfAFinishedRecordingLost) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 3});
  Bytes bytes = read_file(folder / "a.mcap");
  bytes[made.payloads_end[2] - 3] ^= std::byte{0x40};
  write_file(folder / "broken.mcap", bytes);
  EXPECT_TRUE(recovered(folder / "broken.mcap", folder / "b.mcap").tail_lost);
  bytes.back() ^= std::byte{1}; // without a summary, too
  write_file(folder / "broken.mcap", bytes);
  EXPECT_TRUE(recovered(folder / "broken.mcap", folder / "c.mcap").tail_lost);
}

TEST(Recover, FirstGroupLost) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 3});
  Bytes bytes = read_file(folder / "a.mcap");
  bytes[made.payloads_end[0] - 3] ^= std::byte{0x40};
  write_file(folder / "broken.mcap", bytes);
  const RecoverReport report = recovered(folder / "broken.mcap", folder / "b.mcap");
  EXPECT_EQ(report.lost, (std::vector<LineRange>{{0, 63}}));
}

/// Any single flipped byte costs one group at most, and what recover says of it is true.
TEST(Recover, EveryFlippedByte) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 4, .body = 20, .gap_after_first = true});
  const Bytes original = read_file(folder / "a.mcap");
  for (std::size_t at = 0; at < original.size(); ++at) {
    Bytes bytes = original;
    bytes[at] ^= static_cast<std::byte>(1U << (at % 8));
    write_file(folder / "broken.mcap", bytes);
    const auto result = recover_with(folder / "broken.mcap", folder / "b.mcap", inspector());
    ASSERT_TRUE(result) << at << ' ' << result.error().context;
    // A broken gap message is the one thing that costs lines without costing a group: its six lines have no reason any more.
    const bool gap_lost = result.value().lost == std::vector<LineRange>{{64, 69}};
    const bool lines_lost = !result.value().lost.empty() && !gap_lost;
    ASSERT_EQ(result.value().groups + (lines_lost ? 1 : 0) + (result.value().tail_lost ? 1 : 0), 4U) << at;
    ASSERT_EQ(::unlink((folder / "b.mcap").c_str()), 0);
  }
}

TEST(Recover, GroupsAreFoundWhereNothingElseIsLeft) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 5, .body = 2000});
  const Bytes original = read_file(folder / "a.mcap");
  // Payloads in order with rubbish of odd lengths between them, the first mark across the border of a megabyte, one copy of the
  // facts.
  std::mt19937 random(3);
  Bytes bytes;
  const auto rubbish = [&](std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) bytes.push_back(static_cast<std::byte>(random()));
  };
  rubbish((1U << 20U) - 4);
  for (const EncodedGroup& g : made.groups) {
    for (const Bytes& payload : g.payloads) {
      bytes.insert(bytes.end(), payload.begin(), payload.end());
      rubbish(random() % 300);
    }
    if (g.number == 2) {
      const Bytes record = facts_record(facts());
      bytes.insert(bytes.end(), record.begin(), record.end());
    }
    rubbish(random() % 300000);
  }
  write_file(folder / "broken.mcap", bytes);
  const RecoverReport report = recovered(folder / "broken.mcap", folder / "b.mcap");
  EXPECT_EQ(report.groups, 5U);
  EXPECT_TRUE(report.lost.empty());
  EXPECT_TRUE(report.tail_lost);
  expect_groups(folder / "b.mcap", made, {0, 1, 2, 3, 4});
}

TEST(Recover, MarkAcrossEveryBorderOfABlock) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 1});
  const Bytes record = facts_record(facts());
  for (std::size_t before = (1U << 20U) - 80; before < (1U << 20U) + 20; ++before) {
    Bytes bytes(record);
    bytes.resize(before);
    for (const Bytes& payload : made.groups[0].payloads) bytes.insert(bytes.end(), payload.begin(), payload.end());
    write_file(folder / "broken.mcap", bytes);
    ASSERT_EQ(recovered(folder / "broken.mcap", folder / "b.mcap").groups, 1U) << before;
    ASSERT_EQ(::unlink((folder / "b.mcap").c_str()), 0);
  }
}

TEST(Recover, BrokenHeadIsSurvivedByTheCopies) {
  const Folder folder;
  for (const bool finish : {false, true}) {
    const Made made = make(folder / "a.mcap", {.groups = finish ? 3U : 16U, .finish = finish});
    Bytes bytes = read_file(folder / "a.mcap");
    std::fill_n(bytes.begin(), made.head, std::byte{0});
    write_file(folder / "broken.mcap", bytes);
    const RecoverReport report = recovered(folder / "broken.mcap", folder / "b.mcap");
    EXPECT_EQ(report.groups, finish ? 3U : 16U);
    EXPECT_TRUE(report.lost.empty());
    EXPECT_FALSE(report.tail_lost);
    EXPECT_GE(report.bytes_skipped, made.head);
    for (const char* name : {"a.mcap", "b.mcap"}) ASSERT_EQ(::unlink((folder / name).c_str()), 0);
  }
}

TEST(Recover, WithoutAnyFactsItSaysSo) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 1, .finish = false});
  Bytes bytes = read_file(folder / "a.mcap");
  bytes[made.head - 5] ^= std::byte{1};
  bytes.back() ^= std::byte{1};
  write_file(folder / "broken.mcap", bytes);
  const auto report = recover_with(folder / "broken.mcap", folder / "b.mcap", inspector());
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Errc::damaged);
  EXPECT_NE(report.error().context.find("facts"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.mcap"));
}

TEST(Recover, PayloadsOfOtherStreamsAndStaleGroupsStayOut) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 3, .finish = false});
  RecordingFacts other = facts();
  other.stream = 1;
  Bytes bytes = read_file(folder / "a.mcap");
  for (const EncodedGroup& g : {group(other, 3, 192, 64), group(facts(), 1, 64, 64)})
    for (const Bytes& payload : g.payloads) bytes.insert(bytes.end(), payload.begin(), payload.end());
  write_file(folder / "broken.mcap", bytes);
  EXPECT_EQ(recovered(folder / "broken.mcap", folder / "b.mcap").groups, 3U);
  expect_groups(folder / "b.mcap", made, {0, 1, 2});
}

TEST(Recover, OutputMustBeNew) {
  const Folder folder;
  make(folder / "a.mcap", {});
  write_file(folder / "b.mcap", std::as_bytes(std::span("precious")));
  EXPECT_EQ(recover_with(folder / "a.mcap", folder / "b.mcap", inspector()).error().code, Errc::exists);
  EXPECT_EQ(recover_with(folder / "a.mcap", folder / "a.mcap", inspector()).error().code, Errc::exists);
  EXPECT_EQ(read_file(folder / "b.mcap").size(), 9U);
  EXPECT_EQ(folder.names().size(), 2U);
}

TEST(Recover, UnsoundOutputIsRemoved) {
  const Folder folder;
  make(folder / "a.mcap", {.groups = 3});
  int calls = 0; // an inspector that changes its mind stands for a disk that does
  const auto report =
      recover_with(folder / "a.mcap", folder / "b.mcap", [&](std::span<const ByteView> payloads) -> Result<GroupCounts> {
        if (++calls == 5) return fail(Errc::damaged, "changed its mind");
        return inspector()(payloads);
      });
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Errc::damaged);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.mcap"});
}

TEST(Recover, HostileLengthsAllocateNothing) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 3, .finish = false});
  Bytes bytes = read_file(folder / "a.mcap");
  for (std::size_t k = 1; k < 9; ++k) bytes[made.block_end[1] + k] = std::byte{0xFF}; // length of the last chunk
  write_file(folder / "broken.mcap", bytes);
  EXPECT_EQ(recovered(folder / "broken.mcap", folder / "b.mcap").groups, 3U);
}

/// A file of nothing but false starts, each claiming megabytes, ends soon with a clear error.
TEST(Recover, FileOfFalseMarksEndsSoon) {
  const Folder folder;
  Bytes bytes = facts_record(facts());
  EncodedGroup g = group(facts(), 0, 0, 64, 0);
  Bytes& start = g.payloads[0];
  const PayloadHeader header = parse_payload_header(start).value();
  seal_payload(header, Bytes(4U << 20U), start);
  start.resize(start.size() - (4U << 20U));
  while (bytes.size() < (12U << 20U)) bytes.insert(bytes.end(), start.begin(), start.end());
  write_file(folder / "broken.mcap", bytes);
  const auto report = recover_with(folder / "broken.mcap", folder / "b.mcap", inspector());
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Errc::damaged);
  EXPECT_NE(report.error().context.find("false starts"), std::string::npos);
}

} // namespace
} // namespace scansion::synthetic
