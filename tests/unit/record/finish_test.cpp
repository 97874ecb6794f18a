// Finishing in place, and cutting to a level.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/synthetic.hpp"

#include <unistd.h>

namespace scansion::synthetic {
namespace {

TEST(FinishInPlace, EveryCutBecomesSoundAndKeepsEveryGroup) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 4, .body = 40, .gap_after_first = true});
  const Bytes original = read_file(path);
  for (std::uint64_t size = made.head; size < made.size; ++size) {
    write_file(path, ByteView(original).first(size));
    const auto cut = finish_in_place_with(path, inspector());
    ASSERT_TRUE(cut) << size << ' ' << cut.error().context;
    const auto report = verify_with(path, inspector());
    ASSERT_OK(report);
    ASSERT_TRUE(report.value().sound) << size << ' ' << report.value().findings.front().what;
    std::uint64_t whole = 0;
    for (const std::uint64_t end : made.payloads_end) whole += end <= size ? 1 : 0;
    ASSERT_EQ(report.value().groups, whole) << size;
    ASSERT_LT(cut.value(), 2000U);
  }
}

TEST(FinishInPlace, FinishedRecordingIsLeftAlone) {
  const Folder folder;
  make(folder / "a.mcap", {});
  const Bytes before = read_file(folder / "a.mcap");
  const auto cut = finish_in_place_with(folder / "a.mcap", inspector());
  ASSERT_OK(cut);
  EXPECT_EQ(cut.value(), 0U);
  EXPECT_EQ(read_file(folder / "a.mcap"), before);
}

TEST(FinishInPlace, OtherFilesAreRefused) {
  const Folder folder;
  make(folder / "a.mcap", {});
  Bytes bytes = read_file(folder / "a.mcap");
  bytes[0] = std::byte{0}; // what is left ends with a footer
  write_file(folder / "a.mcap", bytes);
  EXPECT_EQ(finish_in_place_with(folder / "a.mcap", inspector()).error().code, Errc::undecodable);
  EXPECT_EQ(finish_in_place_with(folder / "none", inspector()).error().code, Errc::not_found);
  EXPECT_EQ(read_file(folder / "a.mcap"), bytes);
}

TEST(FinishInPlace, GivesTheBytesOfAWriterThatWasNotKilled) {
  const Folder folder;
  Plan plan{.groups = 300, .body = 10, .gap_after_first = true};
  make(folder / "a.mcap", plan);
  plan.finish = false;
  make(folder / "b.mcap", plan);
  ASSERT_OK(finish_in_place_with(folder / "b.mcap", inspector()));
  const auto a = RecordingReader::open(folder / "a.mcap");
  const auto b = RecordingReader::open(folder / "b.mcap");
  ASSERT_OK(a);
  ASSERT_OK(b);
  RecordingEnd expected = *a.value().end();
  expected.ended_ns = {};
  expected.rounding_mm = 0;
  EXPECT_EQ(*b.value().end(), expected);
  EXPECT_EQ(a.value().groups().size(), b.value().groups().size());
}

TEST(FinishInPlace, NeverCutsGoodGroupsOff) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 4, .finish = false});
  const Bytes original = read_file(folder / "a.mcap");
  for (std::uint64_t at = 0; at < made.block_end[2]; ++at) {
    Bytes bytes = original;
    bytes[at] ^= std::byte{4};
    write_file(folder / "a.mcap", bytes);
    const auto cut = finish_in_place_with(folder / "a.mcap", inspector());
    ASSERT_FALSE(cut) << at;
    ASSERT_EQ(read_file(folder / "a.mcap"), bytes) << at;
  }
}

TEST(CutToLevel, KeepsPayloadBytesAndGaps) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 5, .gap_after_first = true});
  for (std::uint32_t level = 0; level < 4; ++level) {
    const std::string path = folder / ("level" + std::to_string(level));
    ASSERT_OK(cut_to_level_with(folder / "a.mcap", level, path, inspector()));
    const auto report = verify_with(path, inspector());
    ASSERT_OK(report);
    EXPECT_TRUE(report.value().sound);
    auto reader = RecordingReader::open(path);
    ASSERT_OK(reader);
    RecordingFacts expected = facts();
    expected.stored_levels = level + 1;
    EXPECT_EQ(reader.value().facts(), expected);
    EXPECT_EQ(reader.value().gaps().size(), 1U);
    ASSERT_EQ(reader.value().groups().size(), 5U);
    Bytes payload;
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t k = 0; k <= level + 1; ++k) {
        ASSERT_OK(reader.value().read_payload(i, k, payload));
        EXPECT_EQ(payload, made.groups[i].payloads[k]);
      }
  }
  ASSERT_OK(cut_to_level_with(folder / "level3", 3, folder / "again", inspector()));
  EXPECT_EQ(read_file(folder / "level3"), read_file(folder / "again")) << "all levels: the same recording";
  EXPECT_EQ(cut_to_level_with(folder / "a.mcap", 4, folder / "no", inspector()).error().code, Errc::usage);
  EXPECT_EQ(cut_to_level_with(folder / "level1", 2, folder / "no", inspector()).error().code, Errc::usage);
  EXPECT_EQ(cut_to_level_with(folder / "level1", 0, folder / "level2", inspector()).error().code, Errc::exists);
}

TEST(CutToLevel, RefusesDamage) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 3});
  Bytes bytes = read_file(folder / "a.mcap");
  bytes[made.payloads_end[1] - 1] ^= std::byte{1};
  write_file(folder / "broken.mcap", bytes);
  EXPECT_EQ(cut_to_level_with(folder / "broken.mcap", 1, folder / "b.mcap", inspector()).error().code, Errc::damaged);
  EXPECT_EQ(folder.names().size(), 2U);
}

} // namespace
} // namespace scansion::synthetic
