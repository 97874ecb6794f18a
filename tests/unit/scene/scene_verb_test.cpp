// scansim scene as a command: text form, output files, and the project's recordings made again byte for byte.
// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/output_file.hpp"
#include "sim/cli/scene_verb.hpp"
#include "sim/scene/xyz_text.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>

namespace scansion {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class SceneVerb : public testing::Test {
protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "scene_verb_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

TEST(XyzText, Millimetres) {
  const std::pair<std::int32_t, const char*> cases[] = {{0, "0.000"},
                                                        {1, "0.001"},
                                                        {-1, "-0.001"},
                                                        {999, "0.999"},
                                                        {-1000, "-1.000"},
                                                        {123456, "123.456"},
                                                        {std::numeric_limits<std::int32_t>::max(), "2147483.647"},
                                                        {std::numeric_limits<std::int32_t>::min(), "-2147483.648"}};
  for (const auto& [um, want] : cases) {
    std::string text = ">";
    append_millimetres(text, um);
    EXPECT_EQ(text, std::string(">") + want);
  }
}

TEST(XyzText, BlankLinesStandBetweenLinesOnly) {
  std::string text;
  bool first = true;
  SceneLine line;
  append_xyz(text, line, first); // nothing to write: no separator either
  line.points = {{1, 2, 3, SampleState::missing}};
  append_xyz(text, line, first);
  EXPECT_EQ(text, "");
  line.points = {{1, 2, 3, SampleState::measured}, {0, 0, 0, SampleState::missing}, {-4, 5, 6000, SampleState::outlier}};
  append_xyz(text, line, first);
  EXPECT_EQ(text, "0.001 0.002 0.003\n-0.004 0.005 6.000\n");
  append_xyz(text, SceneLine{}, first);
  append_xyz(text, line, first);
  EXPECT_EQ(text, "0.001 0.002 0.003\n-0.004 0.005 6.000\n\n0.001 0.002 0.003\n-0.004 0.005 6.000\n");
}

TEST_F(SceneVerb, OutputAppearsWholeOrNotAtAll) {
  const std::string path = folder_ / "out.xyz";
  {
    auto file = OutputFile::create(path, false);
    ASSERT_TRUE(file) << file.error().context;
    ASSERT_TRUE(file.value().write("half"));
    EXPECT_FALSE(fs::exists(path));
  }
  EXPECT_EQ(files(), 0U);
  auto file = OutputFile::create(path, false);
  ASSERT_TRUE(file);
  ASSERT_TRUE(file.value().write("whole"));
  ASSERT_TRUE(file.value().finish());
  EXPECT_EQ(content(path), "whole");
  EXPECT_EQ(files(), 1U);
}

TEST_F(SceneVerb, ExistingFilesAreKeptUnlessForced) {
  const std::string path = folder_ / "out.xyz";
  std::ofstream(path) << "old";
  const auto refused = OutputFile::create(path, false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::exists);
  EXPECT_NE(refused.error().context.find("--force"), std::string::npos);
  {
    auto forced = OutputFile::create(path, true);
    ASSERT_TRUE(forced);
    ASSERT_TRUE(forced.value().write("new"));
    EXPECT_EQ(content(path), "old");
    ASSERT_TRUE(forced.value().finish());
  }
  EXPECT_EQ(content(path), "new");
  // A file that came into being after the start is kept, too.
  const std::string late = folder_ / "late.xyz";
  auto slow = OutputFile::create(late, false);
  ASSERT_TRUE(slow);
  std::ofstream(late) << "someone else's";
  const auto finished = slow.value().finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().code, Errc::exists);
  EXPECT_EQ(content(late), "someone else's");
}

TEST_F(SceneVerb, BadPlacesAreErrors) {
  const auto folder = OutputFile::create(folder_.string(), true);
  ASSERT_FALSE(folder);
  EXPECT_EQ(exit_code(folder.error().code), 73);
  const auto nowhere = OutputFile::create(folder_ / "no" / "such" / "place.xyz", false);
  ASSERT_FALSE(nowhere);
  EXPECT_NE(nowhere.error().context.find("place.xyz: "), std::string::npos) << nowhere.error().context;
  EXPECT_EQ(exit_code(nowhere.error().code), 73);
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  auto full = OutputFile::create("/dev/full", false);
  ASSERT_TRUE(full);
  const auto written = full.value().write("x");
  ASSERT_FALSE(written);
  EXPECT_EQ(exit_code(written.error().code), 74);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(SceneVerb, UsageErrorsLeaveNothing) {
  const std::string out = (folder_ / "x.xyz").string();
  for (const std::string& command :
       {std::string("scansim scene"), std::string("scansim scene part"), "scansim scene teapot -o " + out,
        "scansim scene part --tilt 80 -o " + out, "scansim scene part --pitch 1e-6 -o " + out,
        std::string("scansim scene part --json -o -")}) {
    const auto request = parse_scene_command(command);
    ASSERT_TRUE(request) << command;
    const auto done = run_scene(request.value());
    ASSERT_FALSE(done) << command;
    EXPECT_EQ(done.error().code, Errc::usage) << command;
  }
  for (const char* command :
       {"scansim scene part --lines x -o y", "scansim scene part --lines -3 -o y", "scansim scene part --seed -1 -o y",
        "scansim", "scansim play", "scansim scene part --colour red"}) {
    const auto request = parse_scene_command(command);
    ASSERT_FALSE(request) << command;
    EXPECT_EQ(request.error().code, Errc::usage);
  }
  EXPECT_EQ(files(), 0U);
}

// Each recording's first row is the command that made it.
TEST_F(SceneVerb, RecordingsAreMadeAgainByteForByte) {
  std::size_t recordings = 0;
  for (const auto& entry : fs::directory_iterator(SCANSION_RECORDINGS)) {
    if (entry.path().extension() != ".xyz") continue;
    const std::string want = content(entry.path());
    if (!want.starts_with("# scansim scene ")) continue;
    ++recordings;
    EXPECT_LT(want.size(), 60U * 1024U) << entry.path();
    auto request = parse_scene_command(want.substr(2, want.find('\n') - 2));
    ASSERT_TRUE(request) << request.error().context;
    request.value().output = folder_ / entry.path().filename();
    const auto done = run_scene(request.value());
    ASSERT_TRUE(done) << done.error().context;
    EXPECT_TRUE(content(request.value().output) == want) << entry.path() << ": the scan is another one than the recorded";
  }
  EXPECT_GE(recordings, 7U);
}

TEST_F(SceneVerb, TruthStandsBesideTheScan) {
  EXPECT_EQ(truth_path("a/b.xyz"), "a/b.truth.json");
  EXPECT_EQ(truth_path("plain"), "plain.truth.json");
  SceneRequest request;
  request.scene = "star";
  request.plan.pitch_mm = request.plan.spacing_mm = 0.5;
  request.truth = true;
  request.output = folder_ / "star.xyz";
  ASSERT_TRUE(run_scene(request));
  EXPECT_EQ(files(), 2U);
  const std::string first = content(folder_ / "star.truth.json");
  EXPECT_NE(first.find("\"format\":\"scansion-truth\""), std::string::npos);
  EXPECT_FALSE(run_scene(request)) << "nothing is overwritten without --force";
  request.force = true;
  ASSERT_TRUE(run_scene(request));
  EXPECT_EQ(content(folder_ / "star.truth.json"), first);
  request.output = "-";
  const auto refused = run_scene(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::usage);
}

} // namespace
} // namespace scansion
