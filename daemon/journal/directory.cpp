// The recording directory: made, locked, tidied at start.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal/directory.hpp"

#include "pipeline/record/reader.hpp"
#include "pipeline/record/repair.hpp"

#include <cerrno>
#include <cstdio>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace scansion {
namespace {

Result<void> make_directories(const std::string& path) {
  for (std::size_t at = path.find('/', 1);; at = path.find('/', at + 1)) {
    const std::string part = path.substr(0, at);
    if (::mkdir(part.c_str(), 0750) != 0 && errno != EEXIST) {
      // A parent that exists may refuse mkdir for other reasons (read-only root); only a missing one is an error.
      const int error = errno;
      struct stat status {};
      if (::stat(part.c_str(), &status) != 0)
        return system_error(path + ": cannot make the recording directory (" + part + ")", error);
    }
    if (at == std::string::npos) return success();
  }
}

/// Whether the file lacks its end. Fails when it is no recording.
Result<bool> is_unfinished(const std::string& file) {
  SCANSION_TRY(reader, RecordingReader::open(file));
  return !reader.complete();
}

/// A head without a single group, left by a kill between creating the file and writing to it.
Result<bool> is_empty(const std::string& file) {
  SCANSION_TRY(reader, RecordingReader::open(file));
  return reader.groups().empty() && reader.gaps().empty();
}

JournalDirectory::Repaired repair_one(const std::string& file) {
  JournalDirectory::Repaired out{file, 0, {}, false};
  auto cut = finish_in_place(file);
  if (!cut) {
    out.problem = std::move(cut).assume_error().context;
    return out;
  }
  out.cut_bytes = cut.assume_value();
  auto empty = is_empty(file);
  if (out.cut_bytes == 0 && empty && empty.assume_value()) out.removed = ::unlink(file.c_str()) == 0;
  return out;
}

} // namespace

Result<JournalDirectory> JournalDirectory::open(const std::string& path) {
  SCANSION_TRY(make_directories(path));
  const std::string lock_path = path + "/.lock";
  const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (lock < 0) return system_error(lock_path + ": cannot use the recording directory", errno);
  JournalDirectory out(path, lock);
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) {
      return fail(Errc::unavailable, path,
                  ": another daemon records into this directory; stop it or set another one in [recording]");
    }
    return system_error(lock_path + ": cannot lock", errno);
  }
  return out;
}

JournalDirectory::~JournalDirectory() {
  if (lock_ >= 0) ::close(lock_);
}

Result<std::vector<JournalDirectory::Repaired>> JournalDirectory::repair_all() const {
  std::vector<Repaired> out;
  std::error_code error;
  std::filesystem::directory_iterator at(path_, error);
  for (; !error && at != std::filesystem::directory_iterator(); at.increment(error)) {
    std::error_code ignored;
    if (at->path().extension() != ".mcap" || !at->is_regular_file(ignored)) continue;
    const std::string file = at->path().string();
    auto unfinished = is_unfinished(file);
    if (!unfinished)
      out.push_back({file, 0, std::move(unfinished).assume_error().context, false});
    else if (unfinished.assume_value())
      out.push_back(repair_one(file));
  }
  if (error) return system_error(path_ + ": cannot list the recording directory", error.value());
  std::sort(out.begin(), out.end(), [](const Repaired& a, const Repaired& b) { return a.file < b.file; });
  return out;
}

std::string JournalDirectory::file_path(std::string_view device, std::int64_t realtime_ns, std::uint32_t number) const {
  const std::time_t seconds = realtime_ns / 1'000'000'000;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  char stamp[40];
  const std::size_t length = std::strftime(stamp, sizeof stamp, "%Y%m%dT%H%M%SZ", &parts);
  char counter[16];
  std::snprintf(counter, sizeof counter, "%03u", number);
  return path_ + '/' + std::string(device) + '-' + std::string(stamp, length) + '-' + counter + ".mcap";
}

Result<std::uint64_t> JournalDirectory::free_bytes() const {
  struct statvfs facts {};
  if (::statvfs(path_.c_str(), &facts) != 0) return system_error(path_ + ": cannot ask for the free space", errno);
  return std::uint64_t{facts.f_bavail} * facts.f_frsize;
}

Result<void> JournalDirectory::sync() const {
  const int directory = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return system_error(path_ + ": cannot open the recording directory", errno);
  const int result = ::fsync(directory);
  const int error = errno;
  ::close(directory);
  if (result != 0) return system_error(path_ + ": cannot sync the recording directory", error);
  return success();
}

} // namespace scansion
