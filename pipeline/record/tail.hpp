// The end of a finished recording: totals, data end, summary and footer, made from what the data section holds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/layout.hpp"
#include "pipeline/record/window.hpp"

#include <functional>
#include <vector>

namespace scansion {

/// Everything the tail is a function of.
struct TailFacts {
  const RecordingFacts* facts = nullptr;
  const std::vector<ChunkEntry>* chunks = nullptr;
  const std::vector<std::uint64_t>* copies = nullptr; ///< offsets of the Metadata records `scansion`, the head's first
  RecordingEnd end;
  std::uint64_t offset = 0;   ///< where the tail starts: the end of the last block or copy
  std::uint32_t data_crc = 0; ///< CRC-32 of everything before `offset`
};

/// Takes bytes in file order.
using ByteSink = std::function<Result<void>(ByteView)>;

/// Makes the tail in blocks of at most about 1 MiB.
[[nodiscard]] Result<void> make_tail(const TailFacts& tail, const ByteSink& sink);

/// What a summary whose checksum is right says.
struct Summary {
  std::vector<std::uint64_t> chunks;     ///< offsets of chunk records, in file order
  std::vector<std::uint64_t> chunk_ends; ///< where they end
  std::uint64_t end_offset = 0;          ///< of the Metadata record `scansion.end`
  std::uint64_t end_length = 0;
};

/// True when the file ends with a footer and the magic (which proves nothing about what is before).
[[nodiscard]] Result<bool> ends_with_footer(Window& window);

/// Fails with damaged when there is none or its checksum or a record in it is wrong.
[[nodiscard]] Result<Summary> read_summary(Window& window);

} // namespace scansion
