// An output that appears whole or not at all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "pipeline/record/pending_file.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace scansion {

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
