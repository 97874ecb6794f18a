// Reads a recording, finished or not, group by group and level by level; memory follows the group, not the file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/codec.hpp"
#include "pipeline/feature/feature_line.hpp"
#include "pipeline/record/recording.hpp"

#include <memory>
#include <string>
#include <vector>

namespace scansion {

/// Where the payloads of one group stand in the file.
struct GroupEntry {
  struct Place {
    std::uint64_t offset = 0; ///< of the payload (its mark), from the start of the file
    std::uint32_t size = 0;
  };
  std::uint32_t number = 0;
  std::vector<Place> payloads; ///< lines, lod0, ..., as many as are stored
};

/// Where a message about feature lines or patches stands.
struct NoteEntry {
  std::uint64_t offset = 0;
  std::uint32_t size = 0;
  bool patches = false; ///< else feature lines
};

class RecordingReader {
public:
  /// Opens without repair. A file that was cut or killed opens as far as its last whole group, chunk and
  /// message indexes. Fails with not_found,
  /// permission, undecodable (no recording of ours) or damaged (the head cannot be trusted: try recover).
  [[nodiscard]] static Result<RecordingReader> open(const std::string& path);
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;
  ~RecordingReader();

  [[nodiscard]] const RecordingFacts& facts() const noexcept;
  [[nodiscard]] bool complete() const noexcept;                          ///< has its end, summary and footer
  [[nodiscard]] const std::optional<RecordingEnd>& end() const noexcept; ///< empty while unfinished
  [[nodiscard]] const std::vector<GroupEntry>& groups() const noexcept;
  [[nodiscard]] const std::vector<Gap>& gaps() const noexcept;
  [[nodiscard]] const std::vector<NoteEntry>& notes() const noexcept; ///< in the order of writing
  [[nodiscard]] std::uint64_t bytes() const noexcept;                 ///< of the file

  /// Reads group i: the line table and lod0 .. lod<level> (level = n: rest too; capped at what is stored). Touches no other
  /// payload byte of the file.
  [[nodiscard]] Result<void> read_group(std::size_t i, std::uint32_t level, DecodedGroup& out);
  /// Only the line table.
  [[nodiscard]] Result<void> read_lines(std::size_t i, DecodedGroup& out);
  /// The header of one payload, without its body (the checksum is not looked at).
  [[nodiscard]] Result<PayloadHeader> read_header(std::size_t i, std::size_t payload);
  /// The raw bytes of one payload, header included.
  [[nodiscard]] Result<void> read_payload(std::size_t i, std::size_t payload, Bytes& out);

  /// Adds what message i of notes() says to `report`. Fails with damaged.
  [[nodiscard]] Result<void> read_note(std::size_t i, FeatureReport& report);

private:
  struct Impl;
  explicit RecordingReader(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

} // namespace scansion
