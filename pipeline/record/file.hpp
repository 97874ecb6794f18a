// A file descriptor with whole reads and whole writes; every failure is a value that names the file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/payload.hpp"
#include "pipeline/model/result.hpp"

#include <cstdint>
#include <span>
#include <string>

namespace scansion {

/// Owns one open file. Move only. No position of its own: every call says where.
class File {
public:
  /// For reading. Fails with undecodable when `path` is no regular file.
  [[nodiscard]] static Result<File> open_read(const std::string& path);
  /// For reading and writing an existing file. Fails with unavailable while another process writes it.
  [[nodiscard]] static Result<File> open_update(const std::string& path);
  /// A new file, mode 0644. Fails with exists when it is there. Holds the writer's lock until it is closed.
  [[nodiscard]] static Result<File> create(const std::string& path);

  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File();

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] Result<std::uint64_t> size() const;
  /// Fills `into` from `offset`, or fails.
  [[nodiscard]] Result<void> read_at(std::uint64_t offset, std::span<std::byte> into) const;
  /// Writes all pieces one after the other, in one call of the operating system unless it takes less than asked for.
  [[nodiscard]] Result<void> write_at(std::uint64_t offset, std::span<const ByteView> pieces) const;
  [[nodiscard]] Result<void> truncate(std::uint64_t size) const;
  /// fdatasync.
  [[nodiscard]] Result<void> sync() const;

private:
  File(int fd, std::string path) noexcept : fd_(fd), path_(std::move(path)) {}
  int fd_ = -1;
  std::string path_;
};

/// Makes the directory entry of `path` durable. File systems that cannot do it are not an error.
[[nodiscard]] Result<void> sync_directory_of(const std::string& path);

/// Renames a complete temporary file; fails with exists when `to` is there.
[[nodiscard]] Result<void> rename_to_new(const std::string& from, const std::string& to);

} // namespace scansion
