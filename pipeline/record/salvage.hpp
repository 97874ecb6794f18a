// Finds whole groups by the marks of their payloads alone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/group_check.hpp"
#include "pipeline/record/window.hpp"

namespace scansion {

/// Bytes that may be read in vain. A recording's false starts cost little; a file made of nothing else would cost hours.
class WorkBudget {
public:
  explicit WorkBudget(std::uint64_t file_size) noexcept : left_(16 * file_size + (std::uint64_t{64} << 20U)) {}
  /// Fails with damaged when the work is used up.
  [[nodiscard]] Result<void> spend(std::uint64_t bytes, const File& file);

private:
  std::uint64_t left_;
};

struct Salvaged {
  std::uint64_t grouped = 0;  ///< payload bytes of the whole groups
  std::uint64_t last_end = 0; ///< where the last whole group ends; `from` when there is none
};

/// Tells `found` each whole group that stands in [from, to): all its payloads, each with the right checksum, in order.
/// Copies one group at a time, kMaxChunk bytes at most.
[[nodiscard]] Result<Salvaged> salvage_groups(Window& window, const RecordingFacts& facts, std::uint64_t from, std::uint64_t to,
                                              WorkBudget& budget, const std::function<Result<void>(const FoundGroup&)>& found);

} // namespace scansion
