// A temporary file without a name.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/temp_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <string>

namespace scansion {
namespace {

std::string directory() {
  const char* chosen = std::getenv("TMPDIR"); // NOLINT(concurrency-mt-unsafe): nothing here changes the environment
  return chosen != nullptr && *chosen != '\0' ? chosen : "/tmp";
}

Error trouble(const char* what, int errno_value) {
  return system_error(directory() + ": cannot " + what + " a temporary file; set TMPDIR to a folder with room", errno_value);
}

Result<UniqueFd> make() {
  const std::string folder = directory();
  if (UniqueFd fd{::open(folder.c_str(), O_TMPFILE | O_RDWR | O_EXCL | O_CLOEXEC, 0600)}; fd) return fd;
  // Not every file system has files without a name.
  std::string path = folder + "/scansion-XXXXXX";
  UniqueFd fd{::mkostemp(path.data(), O_CLOEXEC)};
  if (!fd) return trouble("create", errno);
  if (::unlink(path.c_str()) != 0) return trouble("hide", errno);
  return fd;
}

} // namespace

Result<std::size_t> read_at(int fd, std::uint64_t offset, std::span<std::byte> out, const std::string& name) {
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t n = ::pread(fd, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (n == 0) break;
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error(name + ": reading failed; check the disk", errno);
    done += static_cast<std::size_t>(n);
  }
  return done;
}

Result<void> TempFile::append(std::span<const std::byte> bytes) {
  if (!fd_) {
    SCANSION_TRY(fd, make());
    fd_ = std::move(fd);
  }
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(fd_.get(), bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return trouble("write", n < 0 ? errno : ENOSPC);
    size_ += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return success();
}

Result<void> TempFile::read(std::uint64_t offset, std::span<std::byte> out) const {
  if (offset > size_ || out.size() > size_ - offset)
    return fail(Errc::bug, "temporary file: read past its end; please report this");
  SCANSION_TRY(n, read_at(fd_.get(), offset, out, "temporary file"));
  if (n != out.size()) return fail(Errc::io, "temporary file: became shorter while in use; check the disk of $TMPDIR");
  return success();
}

} // namespace scansion
