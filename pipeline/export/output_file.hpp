// An output that appears whole or not at all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <string>
#include <string_view>
#include <vector>

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

/// Buffered text or binary output to a PendingFile, or to standard output for "-". Bytes may be patched before the end, so
/// output to "-" is held in an unlinked temporary file until commit() when `patching` is set.
class OutputFile {
public:
  [[nodiscard]] static Result<OutputFile> create(const std::string& path, bool force, bool patching);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  [[nodiscard]] Result<void> append(std::string_view bytes);
  /// Room for up to `size` bytes at the end of the buffer; write there, then call advance().
  [[nodiscard]] Result<char*> reserve(std::size_t size);
  void advance(std::size_t written) noexcept { used_ += written; }
  /// Overwrites bytes that were appended before.
  [[nodiscard]] Result<void> patch(std::uint64_t offset, std::string_view bytes);
  /// Flushes, checks, closes, and gives the file its name.
  [[nodiscard]] Result<void> commit();

private:
  OutputFile(int fd, std::string shown) : fd_(fd), shown_(std::move(shown)), buffer_(kBuffer) {}
  [[nodiscard]] Result<void> flush();
  static constexpr std::size_t kBuffer = std::size_t{1} << 20;

  int fd_ = -1;
  bool spooled_ = false;
  std::string shown_;
  std::vector<PendingFile> pending_; ///< none or one
  std::vector<char> buffer_;
  std::size_t used_ = 0;
};

/// Writes the whole file `path` to standard output.
[[nodiscard]] Result<void> copy_to_stdout(const std::string& path);

/// The folder for temporary files: $TMPDIR, or /tmp.
[[nodiscard]] std::string temporary_folder();

} // namespace scansion
