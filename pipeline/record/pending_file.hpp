// A file that gets its name only when it is complete.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <string>

namespace scansion {

/// A name beside `path` for a file that is renamed to `path` when it is complete; removed again unless commit() was called.
class PendingFile {
public:
  /// Fails with exists when `path` is there and not `force`, with cannot_create or permission when its folder cannot take a
  /// file.
  [[nodiscard]] static Result<PendingFile> create(const std::string& path, bool force);
  PendingFile(PendingFile&& other) noexcept;
  PendingFile& operator=(PendingFile&& other) noexcept;
  ~PendingFile();

  [[nodiscard]] const std::string& name() const noexcept { return pending_; } ///< of the pending file; does not exist yet
  /// Renames the pending file to its final name; without `force` an output that appeared meanwhile is not replaced.
  [[nodiscard]] Result<void> commit();

private:
  PendingFile(std::string path, std::string pending, bool force)
      : path_(std::move(path)), pending_(std::move(pending)), force_(force) {}
  std::string path_, pending_;
  bool force_ = false;
};

/// The error of a file that cannot be created: permission or cannot_create.
[[nodiscard]] Error creation_error(const std::string& path, int number);

/// Enters and removes a name in the list of files that unlink_pending_files() removes. The list is short; a name too many is
/// left out.
void remember_pending(const std::string& name) noexcept;
void forget_pending(const std::string& name) noexcept;

/// Removes the pending files of this process, and the temporary files made beside them. Safe to call in a signal handler: a
/// program that is told to stop leaves nothing behind.
void unlink_pending_files() noexcept;

} // namespace scansion
