// Whole reads and writes on a descriptor: interrupted and short calls are continued, never assumed away.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/file.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <limits.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

namespace scansion {
namespace {

constexpr std::uint64_t kMaxOffset = static_cast<std::uint64_t>(INT64_MAX);
/// iovecs of one call. A group has at most 18 payloads with a frame each, so that it always fits.
constexpr std::size_t kMaxPieces = 64;
static_assert(kMaxPieces <= IOV_MAX);

int open_retry(const char* path, int flags, mode_t mode = 0) noexcept {
  int fd = -1;
  do fd = ::open(path, flags, mode); // NOLINT(cppcoreguidelines-pro-type-vararg)
  while (fd < 0 && errno == EINTR);
  return fd;
}

/// One process writes a recording; readers take no lock. File systems without locks are taken as they are.
bool lock_taken_elsewhere(int fd) noexcept {
  return ::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

Result<void> must_be_regular(int fd, const std::string& path) {
  struct stat info {};
  if (::fstat(fd, &info) != 0) return system_error(path + ": cannot look at the file", errno);
  if (!S_ISREG(info.st_mode)) return fail(Errc::undecodable, path, ": is not a regular file; give the file of a recording");
  return success();
}

/// Fills `io` with what is left of `pieces` after `skip` bytes; returns how many entries.
std::size_t rest_of(std::span<const ByteView> pieces, std::uint64_t skip, std::array<iovec, kMaxPieces>& io) noexcept {
  std::size_t n = 0;
  for (const ByteView piece : pieces) {
    if (skip >= piece.size()) {
      skip -= piece.size();
      continue;
    }
    if (n == io.size()) break;
    const ByteView left = piece.subspan(skip);
    skip = 0;
    io[n++] = {const_cast<std::byte*>(left.data()), left.size()}; // NOLINT: iovec has no const form; it is only read from
  }
  return n;
}

} // namespace

Result<File> File::open_read(const std::string& path) {
  // O_NONBLOCK: a named pipe must not hold us for ever; it means nothing for regular files.
  const int fd = open_retry(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return system_error(path + ": cannot open the recording", errno);
  File file(fd, path);
  SCANSION_TRY(must_be_regular(fd, path));
  return file;
}

Result<File> File::open_update(const std::string& path) {
  const int fd = open_retry(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return system_error(path + ": cannot open the recording for writing", errno);
  File file(fd, path);
  SCANSION_TRY(must_be_regular(fd, path));
  if (lock_taken_elsewhere(fd))
    return fail(Errc::unavailable, path, ": another process is writing this recording; stop it first");
  return file;
}

Result<File> File::create(const std::string& path) {
  const int fd = open_retry(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) {
    const int reason = errno;
    Error error = system_error(path + ": cannot create the recording", reason);
    if (reason == EEXIST) error.context += "; choose another name or remove it";
    if (error.code == Errc::not_found || error.code == Errc::io) error.code = Errc::cannot_create;
    return error;
  }
  File file(fd, path);
  if (lock_taken_elsewhere(fd)) return fail(Errc::unavailable, path, ": another process took the new recording; try again");
  return file;
}

File::File(File&& other) noexcept : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(path_, other.path_);
  return *this;
}

File::~File() {
  // Data that matters has been synced, and that was checked; a late error of close has no one to go to.
  if (fd_ >= 0) ::close(fd_);
}

Result<std::uint64_t> File::size() const {
  struct stat info {};
  if (::fstat(fd_, &info) != 0) return system_error(path_ + ": cannot read the size", errno);
  return static_cast<std::uint64_t>(info.st_size);
}

Result<void> File::read_at(std::uint64_t offset, std::span<std::byte> into) const {
  if (offset > kMaxOffset - into.size()) return fail(Errc::io, path_, ": offset is beyond what a file can have");
  while (!into.empty()) {
    const ssize_t got = ::pread(fd_, into.data(), into.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return system_error(path_ + ": reading at byte " + std::to_string(offset) + " failed", errno);
    if (got == 0)
      return fail(Errc::io, path_, ": ends at byte ", std::to_string(offset), " while more was expected; it shrank");
    into = into.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return success();
}

Result<void> File::write_at(std::uint64_t offset, std::span<const ByteView> pieces) const {
  std::array<iovec, kMaxPieces> io{};
  std::uint64_t written = 0;
  while (const std::size_t n = rest_of(pieces, written, io)) {
    const ssize_t put = ::pwritev(fd_, io.data(), static_cast<int>(n), static_cast<off_t>(offset + written));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return system_error(path_ + ": writing at byte " + std::to_string(offset + written) + " failed", errno);
    if (put == 0) return fail(Errc::io, path_, ": the file system takes no more bytes at ", std::to_string(offset + written));
    written += static_cast<std::uint64_t>(put);
  }
  return success();
}

Result<void> File::truncate(std::uint64_t size) const {
  int result = -1;
  do result = ::ftruncate(fd_, static_cast<off_t>(size));
  while (result != 0 && errno == EINTR);
  if (result != 0) return system_error(path_ + ": cutting the file to " + std::to_string(size) + " bytes failed", errno);
  return success();
}

Result<void> File::sync() const {
  if (::fdatasync(fd_) != 0)
    return system_error(path_ + ": the disk did not confirm the data (fdatasync); close this recording and start another",
                        errno);
  return success();
}

Result<void> sync_directory_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string directory = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
  const int fd = open_retry(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return success(); // a directory may be writable without being readable
  const int reason = ::fsync(fd) == 0 ? 0 : errno;
  ::close(fd);
  if (reason != 0 && reason != EINVAL && reason != ENOTSUP && reason != EROFS)
    return system_error(directory + ": the disk did not confirm the folder (fsync)", reason);
  return success();
}

Result<void> rename_to_new(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return success();
  int reason = errno;
  if (reason == EINVAL || reason == ENOSYS) { // a file system without it: a hard link refuses an existing name, too
    if (::link(from.c_str(), to.c_str()) == 0) {
      ::unlink(from.c_str());
      return success();
    }
    reason = errno;
  }
  Error error = system_error(to + ": cannot give the finished file its name", reason);
  if (error.code == Errc::exists) error.context += "; choose another name or remove it";
  if (error.code == Errc::not_found) error.code = Errc::cannot_create;
  return error;
}

} // namespace scansion
