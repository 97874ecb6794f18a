// An output that appears under its name only when it is whole.
// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/output_file.hpp"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scansion {
namespace {

Error cannot_create(const std::string& path, int reason) {
  Error error = system_error(path + ": cannot create the file", reason);
  if (reason == EEXIST) error.context += "; choose another name or add --force";
  if (reason == ENOENT || reason == ENOTDIR || reason == EISDIR) error.code = Errc::cannot_create;
  return error;
}

int open_for_writing(const std::string& path, int flags) noexcept {
  int fd = -1;
  do fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | flags, 0666); // NOLINT(cppcoreguidelines-pro-type-vararg)
  while (fd < 0 && errno == EINTR);
  return fd;
}

} // namespace

Result<OutputFile> OutputFile::create(const std::string& path, bool force) {
  if (path == "-") return OutputFile(STDOUT_FILENO, "standard output", {}, force);
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) {
    if (S_ISDIR(info.st_mode)) return cannot_create(path, EISDIR);
    if (!S_ISREG(info.st_mode)) { // renaming over a pipe or device would replace it
      const int fd = open_for_writing(path, 0);
      if (fd < 0) return cannot_create(path, errno);
      return OutputFile(fd, path, {}, force);
    }
    if (!force) return cannot_create(path, EEXIST);
  }
  // A killed process of the same number may have left its file: take another name then.
  const std::string stem = path + ".tmp" + std::to_string(::getpid());
  std::string temporary = stem;
  int fd = open_for_writing(temporary, O_CREAT | O_EXCL);
  for (int k = 1; k < 100 && fd < 0 && errno == EEXIST; ++k) {
    temporary = stem + "-" + std::to_string(k);
    fd = open_for_writing(temporary, O_CREAT | O_EXCL);
  }
  if (fd < 0) return cannot_create(path, errno);
  return OutputFile(fd, path, std::move(temporary), force);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)), temporary_(std::exchange(other.temporary_, {})),
      force_(other.force_) {}

OutputFile::~OutputFile() {
  if (fd_ > STDOUT_FILENO) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Result<void> OutputFile::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t put = ::write(fd_, text.data(), text.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return system_error(path_ + ": writing failed", errno);
    text.remove_prefix(static_cast<std::size_t>(put));
  }
  return success();
}

Result<void> OutputFile::finish() {
  if (fd_ > STDOUT_FILENO) {
    const int fd = std::exchange(fd_, -1);
    if (::close(fd) != 0 && errno != EINTR) return system_error(path_ + ": closing failed", errno);
  }
  if (temporary_.empty()) return success();
  // Without --force a file that came into being meanwhile is kept.
  const bool renamed = force_ ? ::rename(temporary_.c_str(), path_.c_str()) == 0
                              : ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE) == 0;
  if (!renamed) {
    const int reason = errno;
    const bool no_flag = !force_ && (reason == EINVAL || reason == ENOSYS); // a file system without it: a link refuses, too
    if (!no_flag) return cannot_create(path_, reason);
    if (::link(temporary_.c_str(), path_.c_str()) != 0) return cannot_create(path_, errno);
    ::unlink(temporary_.c_str());
  }
  temporary_.clear();
  return success();
}

} // namespace scansion
