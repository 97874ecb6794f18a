// The newest raw bytes of a device as a file.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal/raw_dump.hpp"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <unistd.h>

namespace scansion {
namespace {

bool write_all(int fd, std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t put = ::write(fd, text.data(), text.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

} // namespace

Result<std::string> write_raw_dump(const JournalDirectory& directory, std::string_view device, DumpReason reason,
                                   std::string_view transcript, std::uint64_t min_free_bytes) {
  SCANSION_TRY(free, directory.free_bytes());
  if (free < min_free_bytes + transcript.size()) return fail(Errc::io, directory.path(), ": too little space for a raw dump");
  std::string path = directory.path() + "/" + std::string(device) + (reason == DumpReason::fault ? "-fault.raw" : "-dump.raw");
  const std::string temporary = path + ".tmp";
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (fd < 0) return system_error(temporary, errno);
  const bool written = write_all(fd, transcript);
  const int reason_write = errno;
  if (::close(fd) != 0 || !written) {
    ::unlink(temporary.c_str());
    return system_error(temporary + ": writing failed", reason_write);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) return system_error(path, errno);
  return path;
}

} // namespace scansion
