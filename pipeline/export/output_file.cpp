// Outputs that appear whole or not at all.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/output_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scansion {
namespace {

Result<void> write_all(int fd, std::string_view bytes, const std::string& shown) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const Error error = system_error("cannot write " + shown, errno);
      return fail(Errc::io, error.context);
    }
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return success();
}

bool is_special(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

Result<void> copy_to_stdout(int fd, const std::string& shown) {
  std::vector<char> buffer(std::size_t{1} << 20);
  if (::lseek(fd, 0, SEEK_SET) != 0) return fail(Errc::io, system_error("cannot read back " + shown, errno).context);
  while (true) {
    const ssize_t n = ::read(fd, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return fail(Errc::io, system_error("cannot read back " + shown, errno).context);
    if (n == 0) return success();
    SCANSION_TRY(write_all(STDOUT_FILENO, {buffer.data(), static_cast<std::size_t>(n)}, "standard output"));
  }
}

} // namespace

std::string temporary_folder() {
  const char* folder = std::getenv("TMPDIR");
  return folder != nullptr && *folder != '\0' ? folder : "/tmp";
}

Result<void> copy_to_stdout(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return boost::outcome_v2::failure(system_error("cannot read back " + path, errno));
  const Result<void> copied = copy_to_stdout(fd, path);
  ::close(fd);
  return copied;
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), spooled_(other.spooled_), shown_(std::move(other.shown_)),
      pending_(std::move(other.pending_)), buffer_(std::move(other.buffer_)), used_(std::exchange(other.used_, 0)) {}

OutputFile::~OutputFile() {
  if (fd_ > STDERR_FILENO) ::close(fd_);
}

Result<OutputFile> OutputFile::create(const std::string& path, bool force, bool patching) {
  if (path == "-" && !patching) return OutputFile(STDOUT_FILENO, "standard output");
  if (path == "-") {
    std::string name = temporary_folder() + "/scansion-XXXXXX";
    const int fd = ::mkostemp(name.data(), O_CLOEXEC);
    if (fd < 0) return boost::outcome_v2::failure(creation_error(name, errno));
    ::unlink(name.c_str());
    OutputFile file(fd, "a temporary file in " + temporary_folder());
    file.spooled_ = true;
    return file;
  }
  if (is_special(path)) { // a pipe or /dev/null is written in place
    const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd < 0) return boost::outcome_v2::failure(creation_error(path, errno));
    return OutputFile(fd, path);
  }
  SCANSION_TRY(pending, PendingFile::create(path, force));
  const int fd = ::open(pending.name().c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) return boost::outcome_v2::failure(creation_error(path, errno));
  OutputFile file(fd, path);
  file.pending_.push_back(std::move(pending));
  return file;
}

Result<void> OutputFile::flush() {
  const std::string_view bytes(buffer_.data(), std::exchange(used_, 0));
  return write_all(fd_, bytes, shown_);
}

Result<void> OutputFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    if (used_ == buffer_.size()) {
      SCANSION_TRY(flush());
    }
    const std::size_t part = std::min(bytes.size(), buffer_.size() - used_);
    std::memcpy(buffer_.data() + used_, bytes.data(), part);
    used_ += part;
    bytes.remove_prefix(part);
  }
  return success();
}

Result<char*> OutputFile::reserve(std::size_t size) {
  if (buffer_.size() - used_ < size) {
    SCANSION_TRY(flush());
  }
  return buffer_.data() + used_;
}

Result<void> OutputFile::patch(std::uint64_t offset, std::string_view bytes) {
  SCANSION_TRY(flush());
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == ESPIPE)
      return fail(Errc::cannot_create, shown_,
                  " is a pipe; this format needs a file or '-' because its header holds the count");
    if (n < 0) return fail(Errc::io, system_error("cannot write " + shown_, errno).context);
    offset += static_cast<std::uint64_t>(n);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return success();
}

Result<void> OutputFile::commit() {
  SCANSION_TRY(flush());
  if (spooled_) return copy_to_stdout(fd_, shown_);
  if (fd_ == STDOUT_FILENO) return success();
  if (::close(std::exchange(fd_, -1)) != 0) return fail(Errc::io, system_error("cannot write " + shown_, errno).context);
  if (pending_.empty()) return success();
  return pending_.front().commit();
}

} // namespace scansion
