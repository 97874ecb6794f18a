// An output that appears under its name only when it is whole: a temporary file, renamed at the end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <string>
#include <string_view>

namespace scansion {

/// Move only; an unfinished file is removed. "-" is standard output; a pipe or device is written to directly.
class OutputFile {
public:
  /// Fails with exists when `path` is there and `force` is not set.
  [[nodiscard]] static Result<OutputFile> create(const std::string& path, bool force);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  OutputFile(const OutputFile&) = delete;
  ~OutputFile();

  /// Writes all of `text` or fails.
  [[nodiscard]] Result<void> write(std::string_view text);
  /// Closes the file and gives it its name.
  [[nodiscard]] Result<void> finish();

private:
  OutputFile(int fd, std::string path, std::string temporary, bool force) noexcept
      : fd_(fd), path_(std::move(path)), temporary_(std::move(temporary)), force_(force) {}

  int fd_ = -1;
  std::string path_;
  std::string temporary_; // empty: written in place
  bool force_ = false;
};

} // namespace scansion
