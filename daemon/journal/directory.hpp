// The recording directory: made, locked, tidied at start, and where file names come from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scansion {

/// Thread-safe after open(): nothing in it changes.
class JournalDirectory {
public:
  /// Makes the directory (mode 0750, parents too) when it is missing and locks it until destruction. Fails with unavailable
  /// when another daemon has it.
  [[nodiscard]] static Result<JournalDirectory> open(const std::string& path);
  JournalDirectory(JournalDirectory&& other) noexcept : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}
  JournalDirectory(const JournalDirectory&) = delete;
  JournalDirectory& operator=(const JournalDirectory&) = delete;
  JournalDirectory& operator=(JournalDirectory&&) = delete;
  ~JournalDirectory();

  struct Repaired {
    std::string file;
    std::uint64_t cut_bytes = 0;
    std::string problem;  ///< why it was left as it is; empty: it is complete now
    bool removed = false; ///< it held nothing but its head
  };
  /// Completes every recording that a killed daemon left behind. Complete ones are not touched. A file that cannot be
  /// completed stays as it is.
  [[nodiscard]] Result<std::vector<Repaired>> repair_all() const;

  /// <directory>/<device>-<YYYYmmddTHHMMSSZ>-<NNN>.mcap
  [[nodiscard]] std::string file_path(std::string_view device, std::int64_t realtime_ns, std::uint32_t number) const;
  /// For a user without special rights.
  [[nodiscard]] Result<std::uint64_t> free_bytes() const;
  /// Puts names of new files on the disk. Without it a power cut may lose a whole file whose data was synced.
  [[nodiscard]] Result<void> sync() const;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

private:
  JournalDirectory(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}

  std::string path_;
  int lock_;
};

} // namespace scansion
