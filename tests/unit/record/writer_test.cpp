// The writer: bytes on disk, refusals, and a file that is whole after every failure.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/synthetic.hpp"

#include <filesystem>
#include <sys/stat.h>

namespace scansion::synthetic {
namespace {

TEST(RecordingWriter, StartsWithAHeadThatIsAValidUnfinishedRecording) {
  const Folder folder;
  auto writer = RecordingWriter::create(folder / "a.mcap", facts());
  ASSERT_OK(writer);
  const auto report = verify_with(folder / "a.mcap", inspector());
  ASSERT_OK(report);
  EXPECT_FALSE(report.value().finished);
  EXPECT_FALSE(report.value().sound);
  EXPECT_EQ(report.value().finding_count, 0U);
  EXPECT_EQ(report.value().good_bytes, writer.value().bytes());
}

TEST(RecordingWriter, RefusesAFileThatExistsAndLeavesItAlone) {
  const Folder folder;
  write_file(folder / "a.mcap", std::as_bytes(std::span("precious")));
  const auto writer = RecordingWriter::create(folder / "a.mcap", facts());
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, Errc::exists);
  EXPECT_EQ(read_file(folder / "a.mcap").size(), 9U);
}

TEST(RecordingWriter, SaysWhatIsWrongWithAFolderThatIsNotThere) {
  const Folder folder;
  const auto writer = RecordingWriter::create(folder / "no/a.mcap", facts());
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, Errc::cannot_create);
  EXPECT_NE(writer.error().context.find("no/a.mcap"), std::string::npos);
}

TEST(RecordingWriter, FileModeIsReadableByAll) {
  const Folder folder;
  const mode_t before = ::umask(0);
  { ASSERT_OK(RecordingWriter::create(folder / "a.mcap", facts())); }
  ::umask(before);
  struct stat info {};
  ASSERT_EQ(::stat((folder / "a.mcap").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0644U);
}

TEST(RecordingWriter, RefusesFactsThatWouldNotComeBack) {
  const Folder folder;
  for (const char* device :
       {"", "a/b", "a b", "\xC3\xBC", "0123456789012345678901234567890123456789012345678901234567890123456789"}) {
    RecordingFacts f = facts();
    f.device = device;
    EXPECT_FALSE(RecordingWriter::create(folder / "a.mcap", f)) << device;
  }
  RecordingFacts f = facts();
  f.stored_levels = 5; // of 3 + 1
  EXPECT_FALSE(RecordingWriter::create(folder / "a.mcap", f));
  f = facts();
  f.rounding_mm = -1;
  EXPECT_FALSE(RecordingWriter::create(folder / "a.mcap", f));
  f = facts();
  f.level_count = 17;
  EXPECT_FALSE(RecordingWriter::create(folder / "a.mcap", f));
  EXPECT_TRUE(folder.names().empty());
}

TEST(RecordingWriter, RefusesGroupsThatAreNotOfThisRecording) {
  const Folder folder;
  const RecordingFacts f = facts();
  auto created = RecordingWriter::create(folder / "a.mcap", f);
  ASSERT_OK(created);
  RecordingWriter& writer = created.value();
  const EncodedGroup good = group(f, 1, 64, 64);
  const auto refused = [&](const EncodedGroup& g) {
    const std::uint64_t before = writer.bytes();
    const auto result = writer.append(g, points(good), 1, 0);
    return !result && result.error().code == Errc::usage && writer.bytes() == before;
  };

  RecordingFacts other = f;
  other.stream += 1;
  EXPECT_TRUE(refused(group(other, 1, 64, 64)));
  EncodedGroup bad = good;
  bad.payloads.pop_back();
  EXPECT_TRUE(refused(bad));
  bad = good;
  std::swap(bad.payloads[1], bad.payloads[2]);
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.payloads[2].push_back(std::byte{0});
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.payloads[4] = group(f, 2, 64, 64).payloads[4];
  EXPECT_TRUE(refused(bad));
  EXPECT_FALSE(writer.append(good, points(good) + 1, 1, 0)) << "points that are not the line table's";

  append(writer, good);
  EXPECT_TRUE(refused(good)) << "the same group again";
  EXPECT_FALSE(writer.append(group(f, 2, 127, 64), points(group(f, 2, 127, 64)), 1, 0)) << "lines that were written already";
  append(writer, group(f, 2, 128, 64));
  ASSERT_OK(writer.finish({}, 0));
  const auto report = verify_with(folder / "a.mcap", inspector());
  ASSERT_OK(report);
  EXPECT_TRUE(report.value().sound);
}

TEST(RecordingWriter, TakesNothingAfterTheEnd) {
  const Folder folder;
  auto created = RecordingWriter::create(folder / "a.mcap", facts());
  ASSERT_OK(created);
  RecordingWriter& writer = created.value();
  EXPECT_FALSE(writer.finish({}, -1.0));
  ASSERT_OK(writer.finish(7, 0));
  EXPECT_EQ(writer.append(group(facts(), 0, 0, 1), 1000, 1, 0).error().code, Errc::usage);
  EXPECT_EQ(writer.append(Gap{0, 1, "x"}, 0).error().code, Errc::usage);
  EXPECT_EQ(writer.finish(7, 0).error().code, Errc::usage);
  EXPECT_EQ(writer.bytes(), std::filesystem::file_size(folder / "a.mcap"));
}

TEST(RecordingWriter, EqualInputGivesEqualBytes) {
  const Folder folder;
  make(folder / "a.mcap", {.groups = 5, .gap_after_first = true});
  make(folder / "b.mcap", {.groups = 5, .gap_after_first = true});
  EXPECT_EQ(read_file(folder / "a.mcap"), read_file(folder / "b.mcap"));
}

TEST(RecordingWriter, DescribesGapsOnlyWhereThereIsOne) {
  const Folder folder;
  for (const bool gap : {false, true}) {
    const std::string path = folder / (gap ? "with.mcap" : "without.mcap");
    make(path, {.groups = 3, .gap_after_first = gap});
    const Bytes bytes = read_file(path);
    const std::string_view text = mcap::text_of(bytes);
    std::size_t found = 0;
    for (std::size_t at = text.find("scansion.Gap"); at != std::string_view::npos; at = text.find("scansion.Gap", at + 1))
      ++found;
    EXPECT_EQ(found, gap ? 2U : 0U) << "in the chunk of the first gap and in the summary";
  }
}

TEST(RecordingWriter, CountsWhatItWrote) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 4, .lines = 10, .gap_after_first = true});
  const auto reader = RecordingReader::open(folder / "a.mcap");
  ASSERT_OK(reader);
  ASSERT_TRUE(reader.value().end().has_value());
  const RecordingEnd& end = *reader.value().end();
  EXPECT_EQ(end.groups, 4U);
  EXPECT_EQ(end.lines, 40U);
  EXPECT_EQ(end.points, 4006U);
  EXPECT_EQ(end.runs, 40U);
  EXPECT_EQ(end.invalid, 3U);
  EXPECT_EQ(end.gaps, 1U);
  EXPECT_EQ(end.rounding_mm, 0.25);
  EXPECT_EQ(end.ended_ns, 1'700'000'001'000'000'000);
  EXPECT_EQ(made.size, std::filesystem::file_size(folder / "a.mcap"));
}

TEST(RecordingWriter, SecondWriterOfTheSameFileIsRefused) {
  const Folder folder;
  const auto writer = RecordingWriter::create(folder / "a.mcap", facts());
  ASSERT_OK(writer);
  const auto finished = finish_in_place_with(folder / "a.mcap", inspector());
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().code, Errc::unavailable);
}

} // namespace
} // namespace scansion::synthetic
