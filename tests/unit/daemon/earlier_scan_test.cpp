// What a raster goes on from: the recordings of runs that went on with one another.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal/earlier_scan.hpp"
#include "tests/unit/daemon/fakes.hpp"

#include <fstream>

namespace scansion::test {
namespace {

constexpr std::int64_t kBegin = 1'700'000'000'000'000'000;
constexpr std::uint64_t kEndless = 1ULL << 40U;

class EarlierScanTest : public testing::Test {
protected:
  void SetUp() override {
    auto opened = JournalDirectory::open(temporary_.path());
    ASSERT_TRUE(opened);
    directory_.emplace(std::move(opened).assume_value());
  }

  /// Lines 0 to `lines`, one each ten seconds from `begin` on; a file is full with `bytes`.
  void record(std::uint32_t lines, std::int64_t begin = kBegin, std::uint64_t bytes = kEndless) {
    RecorderSettings settings;
    settings.min_free_bytes = 0;
    settings.rotate_bytes = bytes;
    RecordingFacts facts;
    facts.device = "d";
    facts.lattice = test_facts().lattice;
    RunRecorder recorder(JournalPorts{*directory_, file_sinks(), {}}, clock_, settings, facts);
    GroupBuilder builder;
    LineBuffer line;
    LineGroup group;
    for (std::uint32_t i = 0; i < lines; ++i) {
      fill_line(line, 5);
      line.xyz[1].assign(5, static_cast<std::int32_t>(i));
      line.stamps.host_realtime_ns = begin + 10 * kSecond * i;
      builder.add(line);
      if (i % 10 != 9 && i + 1 != lines) continue;
      builder.take(group);
      recorder.add(group, 0);
      recorder.tick();
    }
    recorder.finish();
  }

  /// How many lines are found; each must be the right one.
  [[nodiscard]] std::size_t found(std::int64_t begin = kBegin, std::size_t most = 1000) {
    auto scan = find_earlier_scan(*directory_, "d", most);
    EXPECT_TRUE(scan) << scan.assume_error().context;
    if (!scan || !scan.assume_value()) return 0;
    const std::vector<LineBuffer>& lines = scan.assume_value()->lines;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      EXPECT_EQ(lines[i].points(), 5U);
      EXPECT_EQ(lines[i].xyz[1].front(), static_cast<std::int32_t>(i));
      EXPECT_EQ(lines[i].stamps.host_realtime_ns, begin + 10 * kSecond * static_cast<std::int64_t>(i));
    }
    return lines.size();
  }

  [[nodiscard]] std::size_t files() const {
    std::size_t out = 0;
    for (const auto& entry : std::filesystem::directory_iterator(temporary_.path())) out += entry.path().extension() == ".mcap";
    return out;
  }

  TemporaryDirectory temporary_;
  std::optional<JournalDirectory> directory_;
  ManualClock clock_;
};

TEST_F(EarlierScanTest, NothingIsThere) {
  EXPECT_EQ(found(), 0U);
}

TEST_F(EarlierScanTest, TheRunThatWentOn) {
  record(25);
  record(45);
  EXPECT_EQ(found(), 45U);
  EXPECT_EQ(found(kBegin, 30), 30U);
}

TEST_F(EarlierScanTest, ARunThatWasStoppedWhileItRepeatedLinesHidesNothing) {
  record(45);
  record(7);
  record(3);
  EXPECT_EQ(found(), 45U);
}

TEST_F(EarlierScanTest, FilesThatWereFullAndRunsOverThem) {
  record(95, kBegin, 1);
  EXPECT_EQ(files(), 10U);
  EXPECT_EQ(found(), 95U);
  record(33); // into one file, and stopped early
  EXPECT_EQ(found(), 95U);
  record(95 + 25, kBegin, 3000);
  EXPECT_GT(files(), 12U);
  EXPECT_EQ(found(), 120U);
}

TEST_F(EarlierScanTest, AnotherScanBeganLater) {
  record(45);
  const std::int64_t later = kBegin + 3600 * kSecond;
  record(5, later);
  EXPECT_EQ(found(later), 5U);
}

TEST_F(EarlierScanTest, WithoutItsBeginningItIsOfNoUse) {
  record(30, kBegin, 1);
  std::filesystem::remove(directory_->file_path("d", kBegin, 1));
  EXPECT_EQ(found(), 0U);
}

TEST_F(EarlierScanTest, OtherDevicesAndFilesAreLeftAlone) {
  record(12);
  std::ofstream(temporary_.path() + "/d-notes.mcap") << "x";
  std::ofstream(temporary_.path() + "/d-2-20990101T000000Z-001.mcap") << "of device d-2";
  EXPECT_EQ(found(), 12U);
}

} // namespace
} // namespace scansion::test
