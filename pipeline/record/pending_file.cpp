// Files that get their name only when they are complete.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/pending_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scansion {

Error creation_error(const std::string& path, int number) {
  Error error = system_error("cannot create " + path, number);
  if (error.code != Errc::permission) error.code = Errc::cannot_create;
  return error;
}

namespace {

// Names a signal handler may unlink: fixed memory, each slot published by its flag. More than one output at a time is rare.
struct PendingName {
  std::atomic<bool> used{false};
  std::array<char, 4096> name{};
};
std::array<PendingName, 8> pending_names;

} // namespace

void remember_pending(const std::string& name) noexcept {
  for (PendingName& slot : pending_names) {
    if (slot.used || name.size() >= slot.name.size()) continue;
    std::memcpy(slot.name.data(), name.c_str(), name.size() + 1);
    slot.used = true;
    return;
  }
}

void forget_pending(const std::string& name) noexcept {
  for (PendingName& slot : pending_names)
    if (slot.used && name == slot.name.data()) slot.used = false;
}

void unlink_pending_files() noexcept {
  for (const PendingName& slot : pending_names)
    if (slot.used) ::unlink(slot.name.data());
}

Result<PendingFile> PendingFile::create(const std::string& path, bool force) {
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) {
    if (!S_ISREG(info.st_mode))
      return fail(Errc::cannot_create, "cannot create ", path, ": it is there and no regular file; choose another name");
    if (!force) return fail(Errc::exists, path, " exists; give --force to replace it");
  }
  std::string pending = path + "." + std::to_string(::getpid()) + ".part";
  // Tried now, so that a folder that cannot be written to is found before the work.
  const int fd = ::open(pending.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) return boost::outcome_v2::failure(creation_error(path, errno));
  ::close(fd);
  ::unlink(pending.c_str());
  remember_pending(pending);
  return PendingFile(path, std::move(pending), force);
}

PendingFile::PendingFile(PendingFile&& other) noexcept
    : path_(std::move(other.path_)), pending_(std::exchange(other.pending_, {})), force_(other.force_) {}

PendingFile& PendingFile::operator=(PendingFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(pending_, other.pending_);
  std::swap(force_, other.force_);
  return *this;
}

PendingFile::~PendingFile() {
  if (pending_.empty()) return;
  ::unlink(pending_.c_str());
  forget_pending(pending_);
}

Result<void> PendingFile::commit() {
  // link() refuses to replace what appeared since create(); not every file system has it, then rename() must do.
  if (!force_ && ::link(pending_.c_str(), path_.c_str()) == 0) {
    ::unlink(pending_.c_str());
    forget_pending(pending_);
    pending_.clear();
    return success();
  }
  if (!force_ && errno == EEXIST) return fail(Errc::exists, path_, " appeared meanwhile; give --force to replace it");
  if (::rename(pending_.c_str(), path_.c_str()) != 0) return boost::outcome_v2::failure(creation_error(path_, errno));
  forget_pending(pending_);
  pending_.clear();
  return success();
}

} // namespace scansion
