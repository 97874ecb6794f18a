// A temporary file without a name: gone when closed, whatever happens.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/unique_fd.hpp"
#include "pipeline/model/result.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace scansion {

/// Reads up to `out.size()` bytes at `offset`; fewer only at the end of the file. `name` is for the error.
[[nodiscard]] Result<std::size_t> read_at(int fd, std::uint64_t offset, std::span<std::byte> out, const std::string& name);

/// Append-only scratch space in $TMPDIR (or /tmp). The file is made by the first append.
class TempFile {
public:
  [[nodiscard]] Result<void> append(std::span<const std::byte> bytes);
  /// Fails unless all of `out` can be read.
  [[nodiscard]] Result<void> read(std::uint64_t offset, std::span<std::byte> out) const;
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] int fd() const noexcept { return fd_.get(); }

private:
  UniqueFd fd_;
  std::uint64_t size_ = 0;
};

} // namespace scansion
