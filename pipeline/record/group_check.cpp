// Whole groups.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/group_check.hpp"

namespace scansion {

bool belongs(const PayloadHeader& h, std::size_t index, const PayloadHeader& lines, const RecordingFacts& facts) noexcept {
  const PayloadKind kind = index == 0                   ? PayloadKind::lines
                           : index <= facts.level_count ? PayloadKind::level
                                                        : PayloadKind::rest;
  const std::uint32_t level = index == 0 ? 0 : static_cast<std::uint32_t>(index - 1);
  return h.kind == kind && h.level == level && h.levels == facts.level_count && h.stream == facts.stream &&
         h.first_line < kMaxLineIndex && h.group == lines.group && h.epoch == lines.epoch && h.line_count == lines.line_count &&
         h.first_line == lines.first_line && h.first_time_ns == lines.first_time_ns && h.last_time_ns == lines.last_time_ns;
}

Result<PayloadHeader> check_group(std::span<const ByteView> payloads, const RecordingFacts& facts) {
  PayloadHeader lines;
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    SCANSION_TRY(header, check_payload(payloads[i]));
    if (i == 0) lines = header;
    if (!belongs(header, i, lines, facts)) return fail(Errc::damaged, "payloads are not those of one group of this recording");
    if (payload_size(header) != payloads[i].size()) return fail(Errc::damaged, "bytes follow a payload");
  }
  return lines;
}

} // namespace scansion
