// Recording one device run through full disks, failed syncs and rotation, on a disk that fails on demand.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/daemon/fakes.hpp"

namespace scansion::test {
namespace {

class Recorder : public testing::Test {
protected:
  void SetUp() override {
    auto opened = JournalDirectory::open(temporary_.path());
    ASSERT_TRUE(opened);
    directory_.emplace(std::move(opened).assume_value());
    start();
  }

  void start() {
    RecordingFacts facts;
    facts.device = "table-1";
    facts.lattice = test_facts().lattice;
    recorder_.emplace(fake_ports(*directory_, disk_), clock_, settings_, facts);
  }

  void add_group(std::uint32_t lines = 3, std::uint32_t points = 20) {
    LineBuffer line;
    for (std::uint32_t i = 0; i < lines; ++i) {
      fill_line(line, points);
      builder_.add(line);
    }
    builder_.take(group_);
    recorder_->add(group_, clock_.steady_ns());
  }

  TemporaryDirectory temporary_;
  std::optional<JournalDirectory> directory_;
  ManualClock clock_;
  FakeDisk disk_;
  RecorderSettings settings_;
  GroupBuilder builder_;
  LineGroup group_;
  std::optional<RunRecorder> recorder_;
};

TEST_F(Recorder, NoGroupNoFile) {
  recorder_->add(Gap{0, 5, "lost"});
  recorder_->tick();
  recorder_->finish();
  EXPECT_TRUE(disk_.seen().empty());
  EXPECT_EQ(recorder_->status().lost_lines, 0U);
}

TEST_F(Recorder, FirstGroupMakesTheFileWithItsName) {
  add_group();
  auto files = disk_.seen();
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].path, temporary_.path() + "/table-1-20231114T221320Z-001.mcap");
  EXPECT_EQ(files[0].facts.started_ns, clock_.realtime_ns());
  EXPECT_FALSE(files[0].finished);
  recorder_->note_rounding(0.002);
  recorder_->finish();
  files = disk_.seen();
  EXPECT_TRUE(files[0].finished);
  EXPECT_EQ(files[0].rounding_mm, 0.002);
  EXPECT_EQ(files[0].points, 60U);
  EXPECT_EQ(recorder_->status().lines_written, 3U);
}

TEST_F(Recorder, TakenNamesAreStepped) {
  add_group();
  recorder_->finish();
  start();
  add_group();
  ASSERT_EQ(disk_.seen().size(), 2U);
  EXPECT_TRUE(disk_.seen()[1].path.ends_with("-002.mcap"));
}

TEST_F(Recorder, GapBeforeTheFirstGroupComesFirst) {
  recorder_->add(Gap{0, 5, "lost"});
  EXPECT_TRUE(disk_.seen().empty());
  builder_.skip(5);
  add_group();
  recorder_->add(Gap{8, std::nullopt, "lost again"});
  const auto files = disk_.seen();
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].gaps, (std::vector<Gap>{{0, 5, "lost"}, {8, std::nullopt, "lost again"}}));
  EXPECT_EQ(files[0].lines[0], (std::pair<std::uint64_t, std::uint32_t>{5, 3}));
}

TEST_F(Recorder, RotatesBySizeWithGroupNumbersFromZero) {
  disk_.bytes_per_group = settings_.rotate_bytes / 2;
  for (int i = 0; i < 5; ++i) add_group();
  const auto files = disk_.seen();
  ASSERT_EQ(files.size(), 3U);
  EXPECT_TRUE(files[0].finished);
  EXPECT_TRUE(files[1].finished);
  EXPECT_FALSE(files[2].finished);
  for (const auto& file : files) EXPECT_EQ(file.groups.front(), 0U);
  EXPECT_EQ(files[1].lines[0].first, 6U) << "line indexes go on";
  EXPECT_NE(files[0].facts.stream, files[1].facts.stream);
  EXPECT_TRUE(files[2].path.ends_with("-003.mcap"));
}

TEST_F(Recorder, RotatesByAgeEvenWhenNothingComes) {
  add_group();
  clock_.advance(settings_.rotate_age - 1);
  recorder_->tick();
  EXPECT_FALSE(disk_.seen()[0].finished);
  clock_.advance(1);
  EXPECT_LE(recorder_->next_deadline(), clock_.steady_ns());
  recorder_->tick();
  EXPECT_TRUE(disk_.seen()[0].finished);
  EXPECT_EQ(recorder_->next_deadline(), kNever);
}

TEST_F(Recorder, SyncsOncePerIntervalAndOnlyWhenNeeded) {
  add_group();
  add_group();
  clock_.advance(settings_.sync_interval);
  recorder_->tick();
  EXPECT_EQ(disk_.seen()[0].syncs, 1);
  clock_.advance(10 * settings_.sync_interval);
  recorder_->tick();
  EXPECT_EQ(disk_.seen()[0].syncs, 1) << "nothing new was written";
}

TEST_F(Recorder, FailedSyncSealsTheFileAndStartsAnother) {
  add_group();
  disk_.sync_fails = true;
  clock_.advance(settings_.sync_interval);
  recorder_->tick();
  disk_.sync_fails = false;
  EXPECT_TRUE(disk_.seen()[0].finished);
  add_group();
  ASSERT_EQ(disk_.seen().size(), 2U);
  EXPECT_EQ(disk_.seen()[1].groups, (std::vector<std::uint64_t>{0}));
}

TEST_F(Recorder, FullDiskLosesNothing) {
  add_group();
  disk_.full = true;
  for (int i = 0; i < 10; ++i) add_group();
  EXPECT_EQ(recorder_->status().pending_groups, 10U);
  EXPECT_EQ(recorder_->status().blocked, "no space left");
  EXPECT_FALSE(recorder_->full());
  clock_.advance(settings_.retry);
  recorder_->tick();
  EXPECT_EQ(recorder_->status().pending_groups, 10U) << "still full";
  disk_.full = false;
  recorder_->tick();
  EXPECT_EQ(recorder_->status().pending_groups, 10U) << "the next attempt is not due yet";
  clock_.advance(settings_.retry);
  recorder_->tick();
  EXPECT_EQ(recorder_->status().blocked, "");
  const auto files = disk_.seen();
  ASSERT_EQ(files.size(), 1U);
  ASSERT_EQ(files[0].lines.size(), 11U);
  for (std::uint64_t i = 0; i < 11; ++i) {
    EXPECT_EQ(files[0].lines[i].first, 3 * i);
    EXPECT_EQ(files[0].groups[i], i);
  }
}

TEST_F(Recorder, FullDiskBeforeTheFirstFile) {
  disk_.full = true;
  add_group();
  EXPECT_EQ(recorder_->status().blocked, "no space left");
  disk_.full = false;
  clock_.advance(settings_.retry);
  recorder_->tick();
  EXPECT_EQ(disk_.lines_seen(), 3U);
}

TEST_F(Recorder, LittleFreeSpaceBlocksBeforeTheDiskIsFull) {
  disk_.free = settings_.min_free_bytes - 1;
  add_group();
  EXPECT_NE(recorder_->status().blocked.find("1023 MB free, less than min_free_mb = 1024"), std::string::npos);
  EXPECT_TRUE(disk_.seen().empty());
  disk_.free = settings_.min_free_bytes;
  clock_.advance(settings_.retry);
  recorder_->tick();
  EXPECT_EQ(disk_.lines_seen(), 3U);
}

TEST_F(Recorder, PendingGroupsAreBounded) {
  settings_.pending_bytes = 10'000;
  start();
  disk_.full = true;
  int groups = 0;
  while (!recorder_->full()) {
    add_group(1, 100);
    ASSERT_LT(++groups, 20);
  }
  EXPECT_GE(groups, 5);
}

/// A sync that fails while groups wait: they go into the next file with its numbers.
TEST_F(Recorder, SealedWhileBlockedGoesOnInANewFile) {
  add_group();
  disk_.full = true;
  add_group();
  disk_.sync_fails = true;
  clock_.advance(settings_.sync_interval);
  recorder_->tick();
  disk_.full = false;
  clock_.advance(settings_.retry);
  recorder_->tick();
  const auto files = disk_.seen();
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[1].groups, (std::vector<std::uint64_t>{0}));
  EXPECT_EQ(files[1].lines[0].first, 3U);
}

TEST_F(Recorder, WhatTheDiskRefusesAtTheEndIsCountedLost) {
  add_group();
  disk_.full = true;
  add_group();
  recorder_->finish();
  EXPECT_EQ(recorder_->status().lost_lines, 3U);
  EXPECT_EQ(recorder_->status().lines_written, 3U);
  EXPECT_TRUE(disk_.seen()[0].finished);
}

} // namespace
} // namespace scansion::test
