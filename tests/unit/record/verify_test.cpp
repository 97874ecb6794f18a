// Verify: no flipped byte and no cut goes unseen, and nothing whole is called broken.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/synthetic.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace scansion::synthetic {
namespace {

VerifyReport look(const std::string& path) {
  auto report = verify_with(path, inspector());
  if (!report) {
    ADD_FAILURE() << report.error().context;
    return {};
  }
  return std::move(report).value();
}

TEST(Verify, FinishedRecordingIsSound) {
  const Folder folder;
  for (const std::uint32_t groups : {0U, 1U, 2U, 300U}) {
    const std::string path = folder / ("a" + std::to_string(groups));
    make(path, {.groups = groups, .gap_after_first = true});
    const VerifyReport report = look(path);
    EXPECT_TRUE(report.sound) << groups << (report.findings.empty() ? "" : report.findings.front().what);
    EXPECT_TRUE(report.finished);
    EXPECT_EQ(report.groups, groups);
    EXPECT_EQ(report.lines, groups * 64U);
    EXPECT_EQ(report.gaps, groups > 1 ? 1U : 0U);
    EXPECT_TRUE(report.lost.empty());
  }
}

TEST(Verify, RecordingCutToALevelIsSound) {
  const Folder folder;
  for (std::uint32_t stored = 1; stored <= 4; ++stored) {
    RecordingFacts f = facts();
    f.stored_levels = stored;
    const std::string path = folder / ("a" + std::to_string(stored));
    make(path, {.groups = 3, .facts = f});
    EXPECT_TRUE(look(path).sound) << stored;
  }
}

/// Overwrites one byte of a file and puts it back.
class Patch {
public:
  Patch(int fd, std::uint64_t at, std::byte value) : fd_(fd), at_(static_cast<off_t>(at)) {
    EXPECT_EQ(::pread(fd_, &old_, 1, at_), 1);
    EXPECT_EQ(::pwrite(fd_, &value, 1, at_), 1);
  }
  ~Patch() { EXPECT_EQ(::pwrite(fd_, &old_, 1, at_), 1); }
  Patch(const Patch&) = delete;
  Patch& operator=(const Patch&) = delete;

private:
  int fd_;
  off_t at_;
  std::byte old_{};
};

void every_flip_is_seen(const Plan& plan) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, plan);
  const Bytes original = read_file(path);
  const int fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  for (std::uint64_t at = 0; at < original.size(); ++at) {
    // Every bit of the head and of what follows the data, one bit of each other byte.
    const bool all_bits = kThorough && (at < made.head || at >= made.data_end);
    for (unsigned bit = all_bits ? 0 : at % 8; bit < 8; bit += all_bits ? 1 : 8) {
      const Patch patch(fd, at, original[at] ^ static_cast<std::byte>(1U << bit));
      const auto report = verify_with(path, inspector());
      if (!report) {
        ASSERT_EQ(report.error().code, Errc::undecodable) << at;
        ASSERT_LT(at, 8U + 9U + 12U) << "only a wrong magic or profile makes it another file";
        continue;
      }
      ASSERT_FALSE(report.value().sound) << "byte " << at << " bit " << bit;
      ASSERT_GT(report.value().finding_count, 0U) << "byte " << at << " bit " << bit;
      if (!plan.finish && at < made.head) continue; // no copy of the facts yet: nothing can be read
      ASSERT_GE(report.value().groups + 1, plan.groups) << "byte " << at << ": one byte costs one group at most";
    }
  }
  ::close(fd);
  EXPECT_EQ(look(path).finding_count, 0U) << "as it was";
}

TEST(Verify, EveryFlippedByteOfAFinishedRecordingIsSeen) {
  every_flip_is_seen({.groups = 3, .body = 60, .gap_after_first = true});
}
TEST(Verify, EveryFlippedByteOfAnUnfinishedRecordingIsSeen) {
  every_flip_is_seen({.groups = 3, .body = 60, .gap_after_first = true, .finish = false});
}
TEST(Verify, EveryFlippedByteOfAnEmptyRecordingIsSeen) {
  every_flip_is_seen({.groups = 0});
}

TEST(Verify, EveryCutIsSeenAndWholeGroupsAreCounted) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 6, .gap_after_first = true});
  for (std::uint64_t size = made.size; size-- > 0;) {
    ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(size)), 0);
    const auto result = verify_with(path, inspector());
    if (size == 0) {
      EXPECT_EQ(result.error().code, Errc::undecodable);
      break;
    }
    ASSERT_OK(result);
    const VerifyReport& report = result.value();
    ASSERT_FALSE(report.sound) << size;
    ASSERT_FALSE(report.finished) << size;
    std::uint64_t whole = 0;
    std::uint64_t good = size < made.head ? 0 : made.head;
    for (std::size_t i = 0; i < made.groups.size(); ++i) {
      if (made.payloads_end[i] <= size) ++whole;
      if (made.block_end[i] <= size) good = made.block_end[i];
    }
    ASSERT_EQ(report.groups, whole) << size;
    ASSERT_EQ(report.lines, whole * 64) << size;
    ASSERT_TRUE(report.good_bytes == good || report.gaps == 1) << size;
    ASSERT_LE(report.good_bytes, size);
    for (const Finding& finding : report.findings) {
      ASSERT_LE(finding.offset, size);
      if (size > made.head) {
        ASSERT_GE(finding.offset, report.good_bytes) << "damage starts behind what is good";
      }
    }
  }
}

TEST(Verify, BytesBehindTheEndAreSeen) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  make(path, {});
  Bytes bytes = read_file(path);
  bytes.push_back(std::byte{0});
  write_file(path, bytes);
  const VerifyReport report = look(path);
  EXPECT_FALSE(report.sound);
  ASSERT_EQ(report.finding_count, 1U);
  EXPECT_EQ(report.findings[0].offset, bytes.size() - 1);
  bytes.insert(bytes.end(), bytes.begin(), bytes.end() - 1); // the same recording once more
  write_file(path, bytes);
  EXPECT_FALSE(look(path).sound);
}

TEST(Verify, LinesThatNoGapNamesAreSeen) {
  const Folder folder;
  const RecordingFacts f = facts();
  for (const bool named : {false, true}) {
    const std::string path = folder / (named ? "named" : "silent");
    auto writer = RecordingWriter::create(path, f);
    ASSERT_OK(writer);
    append(writer.value(), group(f, 0, 0, 64));
    append(writer.value(), group(f, 1, 70, 64));
    if (named) ASSERT_OK(writer.value().append(Gap{64, {}, "later"}, 0));
    ASSERT_OK(writer.value().finish({}, 0));
    const VerifyReport report = look(path);
    EXPECT_EQ(report.sound, named);
    EXPECT_EQ(report.lost, named ? std::vector<LineRange>{} : (std::vector<LineRange>{{64, 69}}));
  }
}

TEST(Verify, FirstLineOfARotatedRecordingNeedNotBeZero) {
  const Folder folder;
  const RecordingFacts f = facts();
  auto writer = RecordingWriter::create(folder / "a.mcap", f);
  ASSERT_OK(writer);
  append(writer.value(), group(f, 77, 5000, 64));
  ASSERT_OK(writer.value().finish({}, 0));
  EXPECT_TRUE(look(folder / "a.mcap").sound);
}

TEST(Verify, DamagedGroupIsNamedByItsLines) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 5});
  Bytes bytes = read_file(path);
  bytes[made.payloads_end[2] - 1] ^= std::byte{1};
  bytes[made.payloads_end[0] - 1] ^= std::byte{1};
  write_file(path, bytes);
  const VerifyReport report = look(path);
  EXPECT_TRUE(report.finished);
  EXPECT_EQ(report.groups, 3U);
  EXPECT_EQ(report.lost, (std::vector<LineRange>{{0, 63}, {128, 191}}));
}

TEST(Verify, GroupThatDoesNotDecodeIsAFinding) {
  const Folder folder;
  make(folder / "a.mcap", {.groups = 3});
  const auto report = verify_with(folder / "a.mcap", [](std::span<const ByteView> payloads) -> Result<GroupCounts> {
    SCANSION_TRY(lines, parse_payload_header(payloads.front()));
    if (lines.group == 1) return fail(Errc::damaged, "nonsense inside");
    return GroupCounts{lines.line_count, lines.group % 3};
  });
  ASSERT_OK(report);
  EXPECT_FALSE(report.value().sound);
  EXPECT_EQ(report.value().groups, 2U);
  EXPECT_NE(report.value().findings.front().what.find("nonsense inside"), std::string::npos);
  EXPECT_EQ(report.value().lost, (std::vector<LineRange>{{64, 127}}));
}

TEST(Verify, OtherFilesAreAnError) {
  const Folder folder;
  EXPECT_EQ(verify_with(folder / "none", inspector()).error().code, Errc::not_found);
  EXPECT_EQ(verify_with(folder / "", inspector()).error().code, Errc::undecodable) << "a folder";
  write_file(folder / "text", std::as_bytes(std::span("0 0 1\n0 1 1\n")));
  EXPECT_EQ(verify_with(folder / "text", inspector()).error().code, Errc::undecodable);
  write_file(folder / "empty", {});
  EXPECT_EQ(verify_with(folder / "empty", inspector()).error().code, Errc::undecodable);
}

} // namespace
} // namespace scansion::synthetic
