// The Metadata records `scansion` and `scansion.end`: facts and totals as text entries (docs/FORMAT.md, "Metadata").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/mcap.hpp"
#include "pipeline/record/recording.hpp"

namespace scansion {

inline constexpr std::string_view kFactsName = "scansion";
inline constexpr std::string_view kEndName = "scansion.end";
inline constexpr std::string_view kFormatVersion = "1";
/// A Metadata record of ours is never longer than this.
inline constexpr std::uint64_t kMaxMetadata = 64U << 10U;

/// Fails with usage when the facts cannot be written so that the same facts come back.
[[nodiscard]] Result<void> check_facts(const RecordingFacts& facts);

/// A whole Metadata record. Equal facts give equal bytes.
[[nodiscard]] Bytes facts_record(const RecordingFacts& facts);
[[nodiscard]] Bytes end_record(const RecordingEnd& end);

/// What the content of a Metadata record says (without its nine bytes of framing). Fails with damaged when it is none of ours,
/// its checksum is wrong or a value is missing or impossible; with undecodable when a newer program wrote it.
[[nodiscard]] Result<RecordingFacts> parse_facts(ByteView content);
[[nodiscard]] Result<RecordingEnd> parse_end(ByteView content);

} // namespace scansion
