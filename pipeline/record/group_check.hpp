// What makes payloads a whole group of a recording, and the order groups stand in.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/layout.hpp"

#include <functional>

namespace scansion {

/// Counted from the line table of a group.
struct GroupCounts {
  std::uint64_t runs = 0;
  std::uint64_t invalid = 0;
};

/// Looks inside the payloads of one group with the codec. The container's code works above this function, so that it can be
/// tested with any bytes. It may keep scratch memory between calls: one object, one thread.
using GroupInspector = std::function<Result<GroupCounts>(std::span<const ByteView> payloads)>;

/// Decodes every level of a group.
[[nodiscard]] GroupInspector inspect_all_levels();
/// Decodes the line table alone.
[[nodiscard]] GroupInspector inspect_line_table();

/// A group as it stands in a file. Views are valid until the next step of whoever found it.
struct FoundGroup {
  PayloadHeader lines; ///< header of the line table
  std::span<const ByteView> payloads;
  std::uint64_t offset = 0;   ///< of the chunk when framed, else of the first payload
  bool framed = false;        ///< its block is intact, else only its payloads are
  bool behind_damage = false; ///< the first one found in a broken stretch, and not right where that starts

  [[nodiscard]] std::uint64_t last_line() const noexcept { return lines.first_line + lines.line_count - 1; }
};

/// Line indexes stay below this, so that sums of them cannot overflow.
inline constexpr std::uint64_t kMaxLineIndex = std::uint64_t{1} << 62U;

/// Whether payload `index` (0: line table) with this header belongs to the group of `lines` in this recording.
[[nodiscard]] bool belongs(const PayloadHeader& header, std::size_t index, const PayloadHeader& lines,
                           const RecordingFacts& facts) noexcept;

/// Every checksum, and that all payloads are of one group. Returns the line table's header.
[[nodiscard]] Result<PayloadHeader> check_group(std::span<const ByteView> payloads, const RecordingFacts& facts);

/// Groups stand in the order of their numbers and lines.
class GroupOrder {
public:
  [[nodiscard]] bool follows(const PayloadHeader& lines) const noexcept {
    return !any_ || (lines.group > number_ && lines.first_line >= next_line_);
  }
  void take(const PayloadHeader& lines) noexcept {
    any_ = true;
    number_ = lines.group;
    next_line_ = lines.first_line + lines.line_count;
  }
  [[nodiscard]] bool any() const noexcept { return any_; }
  [[nodiscard]] std::uint64_t next_line() const noexcept { return next_line_; } ///< 0 before the first group

private:
  bool any_ = false;
  std::uint32_t number_ = 0;
  std::uint64_t next_line_ = 0;
};

} // namespace scansion
