// Full disks, torn writes and failing syncs. This program puts its own pwritev, ftruncate and fdatasync in front of the C
// library's.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/synthetic.hpp"

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

/// What the next calls do. Threads: the tests of this program run one after the other.
struct Faults {
  int write_error = 0;     ///< errno of the next write, after ...
  long bytes_before = -1;  ///< ... so many more bytes are taken (-1: no fault)
  std::size_t at_most = 0; ///< bytes taken by one call; 0: no limit
  int interrupts = 0;      ///< EINTR so many times
  int truncate_error = 0;
  int sync_error = 0;
  int write_calls = 0;
} faults;

ssize_t write_some(int fd, const iovec* io, int count, off_t offset, std::size_t limit) {
  std::vector<std::byte> bytes;
  for (int k = 0; k < count && bytes.size() < limit; ++k) {
    const auto* from = static_cast<const std::byte*>(io[k].iov_base);
    bytes.insert(bytes.end(), from, from + std::min(io[k].iov_len, limit - bytes.size()));
  }
  return ::pwrite(fd, bytes.data(), bytes.size(), offset);
}

} // namespace

extern "C" ssize_t pwritev(int fd, const iovec* io, int count, off_t offset) {
  ++faults.write_calls;
  if (faults.interrupts > 0) {
    --faults.interrupts;
    errno = EINTR;
    return -1;
  }
  if (faults.bytes_before == 0) {
    errno = faults.write_error;
    return -1;
  }
  std::size_t limit = faults.at_most == 0 ? SIZE_MAX : faults.at_most;
  if (faults.bytes_before > 0) limit = std::min(limit, static_cast<std::size_t>(faults.bytes_before));
  const ssize_t put = write_some(fd, io, count, offset, limit);
  if (put > 0 && faults.bytes_before > 0) faults.bytes_before -= put;
  return put;
}

extern "C" int ftruncate(int fd, off_t size) noexcept {
  if (faults.truncate_error != 0) {
    errno = faults.truncate_error;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_ftruncate, fd, size));
}

extern "C" int fdatasync(int fd) {
  if (faults.sync_error != 0) {
    errno = faults.sync_error;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fdatasync, fd));
}

namespace scansion::synthetic {
namespace {

class WriteFaults : public ::testing::Test {
protected:
  void SetUp() override { faults = {}; }
  void TearDown() override { faults = {}; }
  Folder folder_;
};

TEST_F(WriteFaults, GroupGoesOutInOneCall) {
  auto writer = RecordingWriter::create(folder_ / "a.mcap", facts(16));
  ASSERT_OK(writer);
  for (std::uint32_t i = 0; i < 3; ++i) {
    faults.write_calls = 0;
    append(writer.value(), group(facts(16), i, std::uint64_t{i} * 64, 64, 10'000));
    EXPECT_EQ(faults.write_calls, 1);
  }
}

TEST_F(WriteFaults, ShortAndInterruptedWritesAreContinued) {
  make(folder_ / "a.mcap", {.groups = 3});
  faults.at_most = 7;
  faults.interrupts = 5;
  make(folder_ / "b.mcap", {.groups = 3});
  EXPECT_EQ(read_file(folder_ / "a.mcap"), read_file(folder_ / "b.mcap"));
}

/// The disk is full at every byte of a group, then of the end; after each the file is as before, and the next try succeeds.
TEST_F(WriteFaults, FullDiskAtEveryByteCutsBackToTheLastGroup) {
  const RecordingFacts f = facts(2);
  auto created = RecordingWriter::create(folder_ / "a.mcap", f);
  ASSERT_OK(created);
  RecordingWriter& writer = created.value();
  append(writer, group(f, 0, 0, 64, 20));
  const EncodedGroup next = group(f, 1, 64, 64, 20);
  const std::uint64_t before = writer.bytes();
  const auto whole = [&] {
    return std::filesystem::file_size(folder_ / "a.mcap") == writer.bytes() && writer.bytes() == before;
  };
  for (long room = 0; room < 500; ++room) {
    faults.write_error = ENOSPC;
    faults.bytes_before = room;
    const auto result = writer.append(next, points(next), 64, 1);
    ASSERT_FALSE(result) << room;
    EXPECT_EQ(result.error().code, Errc::io);
    EXPECT_NE(result.error().context.find("No space left on device"), std::string::npos) << result.error().context;
    ASSERT_TRUE(whole()) << room;
  }
  for (long room = 0; room < 2500; room += 7) {
    faults.bytes_before = room;
    ASSERT_FALSE(writer.append(Gap{64, 3, std::string(3000, 'x')}, 0)) << room;
    ASSERT_TRUE(whole()) << room;
  }
  for (long room = 0; room < 1000; ++room) { // somewhat less than the end takes
    faults.bytes_before = room;
    ASSERT_FALSE(writer.finish({}, 0)) << room;
    ASSERT_TRUE(whole()) << room;
  }
  faults = {};
  append(writer, next);
  ASSERT_OK(writer.finish(1'700'000'001'000'000'000, 0.25));
  const auto report = verify_with(folder_ / "a.mcap", inspector());
  ASSERT_OK(report);
  EXPECT_TRUE(report.value().sound);
  make(folder_ / "b.mcap", {.groups = 2, .body = 20, .facts = f});
  EXPECT_EQ(read_file(folder_ / "a.mcap"), read_file(folder_ / "b.mcap")) << "as if nothing had happened";
}

TEST_F(WriteFaults, WriterThatCannotCutRefusesEverythingAfter) {
  auto created = RecordingWriter::create(folder_ / "a.mcap", facts());
  ASSERT_OK(created);
  RecordingWriter& writer = created.value();
  append(writer, group(facts(), 0, 0, 64));
  faults.write_error = EIO;
  faults.bytes_before = 100;
  faults.truncate_error = EIO;
  const auto result = writer.append(group(facts(), 1, 64, 64), 1001, 1, 0);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().context.find("cutting"), std::string::npos);
  faults = {};
  EXPECT_EQ(writer.append(group(facts(), 1, 64, 64), 1001, 1, 0).error().code, Errc::io);
  EXPECT_EQ(writer.append(Gap{64, 1, "x"}, 0).error().code, Errc::io);
  EXPECT_EQ(writer.finish({}, 0).error().code, Errc::io);
  ASSERT_OK(verify_with(folder_ / "a.mcap", inspector()));
  EXPECT_EQ(verify_with(folder_ / "a.mcap", inspector()).value().groups, 1U) << "what was whole before stays whole";
}

TEST_F(WriteFaults, FailedSyncIsTold) {
  auto writer = RecordingWriter::create(folder_ / "a.mcap", facts());
  ASSERT_OK(writer);
  faults.sync_error = EIO;
  EXPECT_EQ(writer.value().sync().error().code, Errc::io);
  EXPECT_EQ(writer.value().finish({}, 0).error().code, Errc::io);
  faults = {};
  const auto report = verify_with(folder_ / "a.mcap", inspector());
  ASSERT_OK(report);
}

TEST_F(WriteFaults, FailedHeadLeavesNoFile) {
  faults.write_error = ENOSPC;
  faults.bytes_before = 100;
  EXPECT_FALSE(RecordingWriter::create(folder_ / "a.mcap", facts()));
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(WriteFaults, FailedRecoveryLeavesNoFile) {
  make(folder_ / "a.mcap", {.groups = 5});
  const auto before = folder_.names();
  for (long room = 0; room < 6000; room += 101) {
    faults.write_error = ENOSPC;
    faults.bytes_before = room;
    const auto result = recover_with(folder_ / "a.mcap", folder_ / "b.mcap", inspector());
    ASSERT_FALSE(result) << room;
    EXPECT_EQ(result.error().code, Errc::io);
    EXPECT_EQ(folder_.names(), before);
  }
}

TEST_F(WriteFaults, FailedFinishInPlaceKeepsEveryGroup) {
  const Made made = make(folder_ / "a.mcap", {.groups = 5, .finish = false});
  const Bytes whole = read_file(folder_ / "a.mcap");
  const Bytes torn(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(made.payloads_end.back() + 10));
  for (long room = 0; room < 1700; room += 13) { // somewhat less than the end takes
    write_file(folder_ / "a.mcap", torn);
    faults.write_error = ENOSPC;
    faults.bytes_before = room;
    ASSERT_FALSE(finish_in_place_with(folder_ / "a.mcap", inspector())) << room;
    faults = {};
    const auto report = verify_with(folder_ / "a.mcap", inspector());
    ASSERT_OK(report);
    ASSERT_EQ(report.value().groups, 5U) << room;
  }
}

/// The same through the kernel: a limit on the size of files gives short writes and EFBIG.
TEST_F(WriteFaults, FileSizeLimitOfTheSystem) {
  auto created = RecordingWriter::create(folder_ / "a.mcap", facts());
  ASSERT_OK(created);
  RecordingWriter& writer = created.value();
  append(writer, group(facts(), 0, 0, 64));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{writer.bytes() + 300, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto result = writer.append(group(facts(), 1, 64, 64), 1001, 1, 0);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().context.find("File too large"), std::string::npos);
  EXPECT_EQ(std::filesystem::file_size(folder_ / "a.mcap"), writer.bytes());
  append(writer, group(facts(), 1, 64, 64));
  ASSERT_OK(writer.finish({}, 0));
  EXPECT_TRUE(verify_with(folder_ / "a.mcap", inspector()).value().sound);
}

TEST_F(WriteFaults, DiskThatIsReallyFull) {
  const std::string disk = folder_ / "disk";
  std::filesystem::create_directory(disk);
  if (::mount("none", disk.c_str(), "tmpfs", 0, "size=64k") != 0) GTEST_SKIP() << "mounting a small disk needs root";
  {
    auto created = RecordingWriter::create(disk + "/a.mcap", facts());
    ASSERT_OK(created);
    RecordingWriter& writer = created.value();
    std::uint32_t i = 0;
    while (i < 1000) {
      const EncodedGroup g = group(facts(), i, std::uint64_t{i} * 64, 64, 1000);
      const auto result = writer.append(g, points(g), g.line_count, g.number % 3);
      if (result) {
        ++i;
        continue;
      }
      EXPECT_NE(result.error().context.find("No space left on device"), std::string::npos);
      break;
    }
    EXPECT_GT(i, 5U);
    EXPECT_LT(i, 60U);
    EXPECT_EQ(std::filesystem::file_size(disk + "/a.mcap"), writer.bytes());
    const auto report = verify_with(disk + "/a.mcap", inspector());
    EXPECT_OK(report);
    EXPECT_EQ(report.value().groups, i);
    EXPECT_EQ(report.value().finding_count, 0U);
  }
  EXPECT_EQ(::umount2(disk.c_str(), MNT_DETACH), 0);
}

} // namespace
} // namespace scansion::synthetic
