// Temporary name, then rename.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/new_recording.hpp"

#include "pipeline/record/metadata.hpp"
#include "pipeline/record/pending_file.hpp"

#include <unistd.h>

namespace scansion {
namespace {

constexpr int kMaxTries = 100;

/// `folder/name` to `folder/.name.PID-N.part`: hidden, in the same file system, and plainly ours if it is ever left behind.
std::string temporary_name(const std::string& path, int attempt) {
  const std::size_t slash = path.rfind('/');
  const std::size_t name_at = slash == std::string::npos ? 0 : slash + 1;
  return path.substr(0, name_at) + "." + path.substr(name_at) + "." + std::to_string(::getpid()) + "-" +
         std::to_string(attempt) + ".part";
}

} // namespace

Result<NewRecording> NewRecording::create(const std::string& path, const RecordingFacts& facts) {
  SCANSION_TRY(check_facts(facts));
  if (::access(path.c_str(), F_OK) == 0) return fail(Errc::exists, path, ": exists already; choose another name or remove it");
  for (int attempt = 0; attempt < kMaxTries; ++attempt) {
    const std::string temporary = temporary_name(path, attempt);
    auto file = File::create(temporary);
    if (!file) {
      if (file.error().code == Errc::exists) continue;
      return std::move(file).error();
    }
    auto appender = Appender::start(std::move(file).value(), facts, ChunkRule::many_groups);
    if (!appender) {
      ::unlink(temporary.c_str());
      return std::move(appender).error();
    }
    remember_pending(temporary);
    return NewRecording(path, temporary, std::move(appender).value());
  }
  return fail(Errc::cannot_create, path, ": no free temporary name beside it; remove old .part files");
}

NewRecording::~NewRecording() {
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  forget_pending(temporary_);
}

Result<void> NewRecording::commit() {
  SCANSION_TRY(rename_to_new(temporary_, path_));
  forget_pending(temporary_);
  temporary_.clear();
  return sync_directory_of(path_);
}

} // namespace scansion
