// Recordings with real payloads: reading levels, and the repairs as the rest of the program calls them.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/reader.hpp"
#include "pipeline/record/repair.hpp"
#include "tests/unit/record/real_groups.hpp"
#include "tests/unit/record/synthetic.hpp"

#include <unistd.h>

namespace scansion::synthetic {
namespace {

class RealRecording : public ::testing::Test {
protected:
  void SetUp() override {
    groups_ = real_groups(facts(), 5, 20, 120);
    ASSERT_EQ(groups_.size(), 5U);
    ASSERT_TRUE(write_real(folder_ / "a.mcap", facts(), groups_, true));
  }
  Folder folder_;
  std::vector<RealGroup> groups_;
};

TEST_F(RealRecording, EveryLevelComesBack) {
  auto reader = RecordingReader::open(folder_ / "a.mcap");
  ASSERT_OK(reader);
  ASSERT_EQ(reader.value().groups().size(), 5U);
  DecodedGroup decoded;
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_OK(reader.value().read_lines(i, decoded));
    EXPECT_EQ(decoded.known_levels, 0U);
    EXPECT_EQ(decoded.group.lines, groups_[i].lines.lines);
    for (std::uint32_t level = 0; level < 5; ++level) {
      ASSERT_OK(reader.value().read_group(i, level, decoded));
      EXPECT_EQ(decoded.known_levels, std::min(level + 1, 4U));
      EXPECT_EQ(decoded.lossless(), level >= 3);
    }
    EXPECT_EQ(decoded.group.xyz, groups_[i].lines.xyz);
    EXPECT_EQ(decoded.group.runs, groups_[i].lines.runs);
  }
  EXPECT_EQ(reader.value().read_group(5, 0, decoded).error().code, Errc::usage);
}

TEST_F(RealRecording, IsSound) {
  const auto report = verify(folder_ / "a.mcap");
  ASSERT_OK(report);
  EXPECT_TRUE(report.value().sound) << (report.value().findings.empty() ? "" : report.value().findings.front().what);
  EXPECT_EQ(report.value().lines, 100U);
}

TEST_F(RealRecording, WrongTotalsAreSeen) {
  groups_[3].invalid += 1;
  ASSERT_TRUE(write_real(folder_ / "b.mcap", facts(), groups_, true));
  const auto report = verify(folder_ / "b.mcap");
  ASSERT_OK(report);
  EXPECT_FALSE(report.value().sound);
}

TEST_F(RealRecording, FinishInPlaceCountsAgain) {
  ASSERT_TRUE(write_real(folder_ / "b.mcap", facts(), groups_, false));
  const auto cut = finish_in_place(folder_ / "b.mcap");
  ASSERT_OK(cut);
  EXPECT_EQ(cut.value(), 0U);
  EXPECT_EQ(read_file(folder_ / "b.mcap"), read_file(folder_ / "a.mcap")) << "as if the writer had done it";
}

TEST_F(RealRecording, CutToALevelReadsAsThatLevel) {
  for (std::uint32_t level = 0; level < 3; ++level) {
    const std::string path = folder_ / ("level" + std::to_string(level));
    ASSERT_OK(cut_to_level(folder_ / "a.mcap", level, path));
    ASSERT_TRUE(verify(path).value().sound);
    auto whole = RecordingReader::open(folder_ / "a.mcap");
    auto cut = RecordingReader::open(path);
    ASSERT_OK(cut);
    DecodedGroup a;
    DecodedGroup b;
    for (std::size_t i = 0; i < 5; ++i) {
      ASSERT_OK(whole.value().read_group(i, level, a));
      ASSERT_OK(cut.value().read_group(i, 99, b));
      EXPECT_EQ(a.group.xyz, b.group.xyz);
      EXPECT_EQ(a.width, b.width);
    }
  }
}

TEST_F(RealRecording, ReadingALevelTouchesNoFinerByte) {
  auto reader = RecordingReader::open(folder_ / "a.mcap");
  ASSERT_OK(reader);
  Bytes bytes = read_file(folder_ / "a.mcap");
  for (const GroupEntry& group : reader.value().groups())
    for (std::size_t k = 3; k < group.payloads.size(); ++k)
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(group.payloads[k].offset), group.payloads[k].size,
                  std::byte{0xAA});
  write_file(folder_ / "b.mcap", bytes);
  auto broken = RecordingReader::open(folder_ / "b.mcap");
  ASSERT_OK(broken);
  DecodedGroup a;
  DecodedGroup b;
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_OK(reader.value().read_group(i, 1, a));
    ASSERT_OK(broken.value().read_group(i, 1, b));
    EXPECT_EQ(a.group.xyz, b.group.xyz);
    const auto finer = broken.value().read_group(i, 2, b);
    ASSERT_FALSE(finer);
    EXPECT_EQ(finer.error().code, Errc::damaged);
    EXPECT_NE(finer.error().context.find("b.mcap: group " + std::to_string(i)), std::string::npos) << finer.error().context;
  }
}

TEST_F(RealRecording, RecoverBringsBackWhatIsWhole) {
  Bytes bytes = read_file(folder_ / "a.mcap");
  auto reader = RecordingReader::open(folder_ / "a.mcap");
  ASSERT_OK(reader);
  bytes[reader.value().groups()[2].payloads[3].offset + 90] ^= std::byte{1};
  write_file(folder_ / "b.mcap", bytes);
  const auto report = recover(folder_ / "b.mcap", folder_ / "c.mcap");
  ASSERT_OK(report);
  EXPECT_EQ(report.value().groups, 4U);
  EXPECT_EQ(report.value().lost, (std::vector<LineRange>{{43, 62}}));
  EXPECT_TRUE(verify(folder_ / "c.mcap").value().sound);
}

} // namespace
} // namespace scansion::synthetic
