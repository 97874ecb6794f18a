// Chunks of many groups: what complete files are made of.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/reader.hpp"
#include "pipeline/record/repair_steps.hpp"
#include "pipeline/record/tail.hpp"
#include "tests/unit/record/synthetic.hpp"

#include <algorithm>

namespace scansion::synthetic {
namespace {

std::vector<std::uint64_t> chunk_offsets(const std::string& path) {
  auto file = File::open_read(path);
  EXPECT_OK(file);
  Window window(file.value(), file.value().size().value());
  auto summary = read_summary(window);
  EXPECT_OK(summary);
  return summary.value().chunks;
}

void expect_same_groups(const std::string& path, const Made& made) {
  auto reader = RecordingReader::open(path);
  ASSERT_OK(reader);
  ASSERT_EQ(reader.value().groups().size(), made.groups.size());
  Bytes payload;
  for (std::size_t g = 0; g < made.groups.size(); ++g) {
    EXPECT_EQ(reader.value().groups()[g].number, made.groups[g].number);
    for (std::size_t k = 0; k < made.groups[g].payloads.size(); ++k) {
      ASSERT_OK(reader.value().read_payload(g, k, payload));
      EXPECT_EQ(payload, made.groups[g].payloads[k]);
    }
  }
}

TEST(ChunksOfManyGroups, TakeSixteenAndComeBack) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 40, .gap_after_first = true, .rule = ChunkRule::many_groups});
  // The gap ends a chunk, and so does the 16th group, behind which the facts stand again: 1, the gap, 15, 16, 8.
  EXPECT_EQ(chunk_offsets(path).size(), 5U);
  expect_same_groups(path, made);
  const auto report = verify_with(path, inspector());
  ASSERT_OK(report);
  EXPECT_TRUE(report.value().sound) << (report.value().findings.empty() ? "" : report.value().findings.front().what);
  EXPECT_EQ(report.value().groups, 40U);
  EXPECT_EQ(report.value().gaps, 1U);
}

TEST(ChunksOfManyGroups, HoldTheSameAsChunksOfOne) {
  const Folder folder;
  const Made many = make(folder / "many.mcap", {.groups = 20, .rule = ChunkRule::many_groups});
  const Made each = make(folder / "each.mcap", {.groups = 20});
  expect_same_groups(folder / "many.mcap", each);
  // 16 and 4 groups: of 18 chunks frame and entry are saved, and of 18 groups the index records but for one entry a message.
  const std::uint64_t messages = payloads_per_group(facts());
  const std::uint64_t chunk = mcap::kChunkHead + 73 + 10 * messages;
  EXPECT_EQ(each.size - many.size, 18 * (chunk + (mcap::message_index_size(1) - 16) * messages));
}

TEST(ChunksOfManyGroups, LargeOnesEndEarlier) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 6, .body = 100'000, .rule = ChunkRule::many_groups});
  EXPECT_EQ(chunk_offsets(path).size(), 3U) << "two groups of half a MiB each";
  expect_same_groups(path, made);
}

TEST(ChunksOfManyGroups, EachChangedByteIsFoundAndTheOtherGroupsComeBack) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  (void)make(path, {.groups = 5, .body = 30, .rule = ChunkRule::many_groups});
  const Bytes sound = read_file(path);
  for (std::size_t at = 0; at < sound.size(); ++at) {
    Bytes broken = sound;
    broken[at] ^= std::byte{0x10};
    write_file(path, broken);
    const auto report = verify_with(path, inspector());
    EXPECT_TRUE(!report || !report.value().sound) << at;
    if (at % 3 != 0) continue;
    const std::string out = folder / ("out" + std::to_string(at));
    const auto recovered = recover_with(path, out, inspector());
    ASSERT_OK(recovered);
    EXPECT_GE(recovered.value().groups, 4U) << at;
    EXPECT_EQ(recovered.value().anything_lost(), recovered.value().groups < 5) << at;
    std::remove(out.c_str());
  }
}

TEST(ChunksOfManyGroups, CutAnywhereWholeGroupsComeBackAndLossIsTold) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 5, .body = 30, .rule = ChunkRule::many_groups});
  const Bytes sound = read_file(path);
  const std::uint64_t begin = chunk_offsets(path).front() + mcap::kChunkHead;
  std::vector<std::uint64_t> ends;
  for (std::uint64_t at = begin; const EncodedGroup& group : made.groups) {
    for (const Bytes& payload : group.payloads) at += mcap::kMessageHead + payload.size();
    ends.push_back(at);
  }
  for (std::uint64_t at = begin; at < ends.back(); ++at) {
    write_file(path, Bytes(sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(at)));
    const std::string out = folder / ("out" + std::to_string(at));
    const auto recovered = recover_with(path, out, inspector());
    ASSERT_OK(recovered);
    const auto whole = std::count_if(ends.begin(), ends.end(), [&](auto end) { return end <= at; });
    EXPECT_EQ(recovered.value().groups, static_cast<std::uint64_t>(whole)) << at;
    EXPECT_TRUE(recovered.value().anything_lost()) << at;
    std::remove(out.c_str());
  }
}

TEST(ChunksOfManyGroups, WithoutSummaryGroupsAreStillRead) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 20, .rule = ChunkRule::many_groups});
  Bytes bytes = read_file(path);
  bytes.resize(bytes.size() - 40);
  write_file(path, bytes);
  expect_same_groups(path, made);
  ASSERT_OK(finish_in_place_with(path, inspector()));
  expect_same_groups(path, made);
  EXPECT_TRUE(verify_with(path, inspector()).value().sound);
}

} // namespace
} // namespace scansion::synthetic
