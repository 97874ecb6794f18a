// Walks a recording from front to back, also where it is broken: intact blocks, groups found by their mark in broken stretches,
// and the stretches themselves.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/group_check.hpp"
#include "pipeline/record/window.hpp"

#include <optional>

namespace scansion {

/// Told what stands in the data section, in file order. Any Error ends the walk and becomes its result.
class WalkVisitor {
public:
  WalkVisitor() = default;
  WalkVisitor(const WalkVisitor&) = delete;
  WalkVisitor& operator=(const WalkVisitor&) = delete;
  virtual ~WalkVisitor() = default;

  /// A whole group whose every checksum is right; a block may hold several.
  [[nodiscard]] virtual Result<void> on_group(const FoundGroup& group) = 0;
  /// An intact block with a gap message.
  [[nodiscard]] virtual Result<void> on_gap(const Gap& gap, const ChunkEntry& entry) = 0;
  /// An intact block with a message about feature lines or patches.
  [[nodiscard]] virtual Result<void> on_note(const ChunkEntry& /*entry*/, ByteView /*text*/) { return success(); }
  /// An intact block was passed (after on_group, on_gap or on_note); `crc` is the CRC-32 of its `size` bytes.
  virtual void on_block(const ChunkEntry& /*entry*/, std::uint64_t /*size*/, std::uint32_t /*crc*/) {}
  /// An intact copy of the facts.
  virtual void on_copy(std::uint64_t /*offset*/, ByteView /*record*/) {}
  /// Bytes [from, to) are not what a recording holds; `at` is the first wrong byte as far as it is known. Groups found in
  /// there by their marks were told before, `grouped` bytes of payloads in all.
  struct Damage {
    std::uint64_t from = 0, to = 0, at = 0;
    std::uint64_t grouped = 0;
    std::size_t groups = 0;           ///< how many
    std::uint64_t last_group_end = 0; ///< where the last of these groups ends, or `from`
    std::uint64_t chunk_end = 0;      ///< where the chunk that starts at `from` says it ends; 0: none starts there
    std::string what;
  };
  [[nodiscard]] virtual Result<void> on_damage(const Damage& damage) = 0;
};

struct WalkEnd {
  std::uint64_t offset = 0;        ///< of the end metadata, or the size of the file
  std::optional<RecordingEnd> end; ///< empty when the file has no intact end metadata
};

/// Walks from `from` (the end of the head, or 0 when the head is broken). Fails with damaged when a hostile file costs
/// more work than any recording would.
[[nodiscard]] Result<WalkEnd> walk(Window& window, const RecordingFacts& facts, std::uint64_t from, WalkVisitor& visitor);

} // namespace scansion
