// The recording directory: lock, names, and recordings that a killed daemon left behind.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/reader.hpp"
#include "pipeline/record/repair.hpp"
#include "tests/unit/daemon/fakes.hpp"

#include <fstream>
#include <sys/stat.h>

namespace scansion::test {
namespace {

JournalDirectory open_directory(const std::string& path) {
  auto opened = JournalDirectory::open(path);
  if (!opened) std::abort();
  return std::move(opened).assume_value();
}

/// Records `groups` groups into real files; without `finished` as a killed daemon leaves them.
void record(const JournalDirectory& directory, const std::string& device, int groups, bool finished) {
  ManualClock clock;
  RecorderSettings settings;
  settings.min_free_bytes = 0;
  RecordingFacts facts;
  facts.device = device;
  facts.lattice = test_facts().lattice;
  RunRecorder recorder(JournalPorts{directory, file_sinks(), {}}, clock, settings, facts);
  GroupBuilder builder;
  LineBuffer line;
  LineGroup group;
  for (int i = 0; i < groups; ++i) {
    fill_line(line, 30);
    builder.add(line);
    builder.take(group);
    recorder.add(group, 0);
  }
  if (finished) recorder.finish();
}

TEST(JournalDirectory, IsMadeWithParentsAndMode) {
  TemporaryDirectory temporary;
  const std::string path = temporary.path() + "/a/b";
  const JournalDirectory directory = open_directory(path);
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U & ~0750U, 0U);
}

TEST(JournalDirectory, IsLocked) {
  TemporaryDirectory temporary;
  {
    const JournalDirectory first = open_directory(temporary.path());
    auto second = JournalDirectory::open(temporary.path());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.assume_error().code, Errc::unavailable);
    EXPECT_NE(second.assume_error().context.find("another daemon"), std::string::npos);
  }
  EXPECT_TRUE(JournalDirectory::open(temporary.path()));
}

TEST(JournalDirectory, ImpossiblePlacesAreClearErrors) {
  auto directory = JournalDirectory::open("/proc/scansion");
  ASSERT_FALSE(directory);
  EXPECT_NE(directory.assume_error().context.find("/proc/scansion"), std::string::npos);
  TemporaryDirectory temporary;
  std::ofstream(temporary.path() + "/file") << "x";
  EXPECT_FALSE(JournalDirectory::open(temporary.path() + "/file"));
  EXPECT_FALSE(JournalDirectory::open(temporary.path() + "/file/below"));
}

TEST(JournalDirectory, CompletesWhatAKillLeftBehind) {
  TemporaryDirectory temporary;
  const JournalDirectory directory = open_directory(temporary.path());
  record(directory, "killed", 5, false);
  record(directory, "good", 2, true);
  const std::string killed = directory.file_path("killed", ManualClock().realtime_ns(), 1);
  { std::ofstream(killed, std::ios::app) << "half a chunk"; }
  auto repaired = directory.repair_all();
  ASSERT_TRUE(repaired);
  ASSERT_EQ(repaired.assume_value().size(), 1U);
  EXPECT_EQ(repaired.assume_value()[0].file, killed);
  EXPECT_EQ(repaired.assume_value()[0].problem, "");
  EXPECT_EQ(repaired.assume_value()[0].cut_bytes, 12U);
  auto report = verify(killed);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report.assume_value().sound);
  EXPECT_EQ(report.assume_value().groups, 5U);
  auto again = directory.repair_all();
  ASSERT_TRUE(again);
  EXPECT_TRUE(again.assume_value().empty());
}

TEST(JournalDirectory, ForeignFilesAreLeftAlone) {
  TemporaryDirectory temporary;
  const JournalDirectory directory = open_directory(temporary.path());
  std::ofstream(temporary.path() + "/notes.txt") << "x";
  std::ofstream(temporary.path() + "/other.mcap") << "not a recording";
  std::ofstream(temporary.path() + "/empty.mcap");
  auto repaired = directory.repair_all();
  ASSERT_TRUE(repaired);
  ASSERT_EQ(repaired.assume_value().size(), 2U);
  for (const auto& one : repaired.assume_value()) EXPECT_NE(one.problem, "");
  std::ifstream other(temporary.path() + "/other.mcap");
  std::string content;
  std::getline(other, content);
  EXPECT_EQ(content, "not a recording");
}

TEST(JournalDirectory, HeadWithoutALineIsRemoved) {
  TemporaryDirectory temporary;
  const JournalDirectory directory = open_directory(temporary.path());
  RecordingFacts facts;
  facts.device = "d";
  facts.lattice = test_facts().lattice;
  const std::string path = directory.file_path("d", 0, 1);
  { ASSERT_TRUE(file_sinks()(path, facts)); }
  auto repaired = directory.repair_all();
  ASSERT_TRUE(repaired);
  ASSERT_EQ(repaired.assume_value().size(), 1U);
  EXPECT_TRUE(repaired.assume_value()[0].removed) << repaired.assume_value()[0].problem;
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(JournalDirectory, RecordingsOfTheRecorderAreSound) {
  TemporaryDirectory temporary;
  const JournalDirectory directory = open_directory(temporary.path());
  record(directory, "d", 20, true);
  auto report = verify(directory.file_path("d", ManualClock().realtime_ns(), 1));
  ASSERT_TRUE(report);
  EXPECT_TRUE(report.assume_value().sound);
  EXPECT_EQ(report.assume_value().groups, 20U);
  EXPECT_EQ(report.assume_value().lines, 20U);
}

} // namespace
} // namespace scansion::test
