// Checksums made right.
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/recording_reseal.hpp"

#include "pipeline/codec/crc32c.hpp"
#include "pipeline/codec/endian.hpp"
#include "pipeline/codec/payload.hpp"
#include "pipeline/record/mcap.hpp"

#include <algorithm>
#include <cstring>

namespace scansion::fuzz {
namespace {

using Span = std::span<std::byte>;

void reseal_payloads(Span file) {
  constexpr std::size_t kChecksum = 9; // in a payload
  for (std::size_t at = 0; at + kShortestPayloadHeader <= file.size(); ++at) {
    const auto header = parse_payload_header(file.subspan(at));
    if (!header) continue;
    const Span payload = file.subspan(at, payload_size(header.value()));
    const std::uint32_t head = crc32c(0, payload.first(kChecksum));
    store_le(payload.data() + kChecksum, crc32c(head, payload.subspan(kChecksum + 4)));
  }
}

/// content: name, length of the map, entries; the last entry is crc32c with eight digits.
void reseal_metadata(Span content) {
  constexpr std::size_t kLast = 4 + 6 + 4 + 8;
  if (content.size() < 4) return;
  const std::size_t entries_at = 8 + std::size_t{load_le<std::uint32_t>(content.data())};
  if (entries_at > content.size() || content.size() - entries_at < kLast) return;
  std::uint32_t crc = crc32c(0, content.subspan(entries_at, content.size() - entries_at - kLast));
  for (std::size_t k = 8; k-- > 0; crc >>= 4U)
    content[content.size() - 8 + k] = static_cast<std::byte>("0123456789abcdef"[crc & 15U]);
}

} // namespace

void reseal(Span file) {
  reseal_payloads(file);
  std::size_t summary = 0;
  for (std::size_t at = mcap::kMagic.size(); at + mcap::kRecordHead <= file.size();) {
    const mcap::RecordHead head = mcap::record_head(file.subspan(at));
    if (head.length > file.size() - at - mcap::kRecordHead) break;
    const Span content = file.subspan(at + mcap::kRecordHead, head.length);
    if (mcap::is(head, mcap::Opcode::metadata)) reseal_metadata(content);
    if (mcap::is(head, mcap::Opcode::chunk) && content.size() >= 40)
      store_le(content.data() + 24, mcap::crc32(0, content.subspan(40)));
    if (mcap::is(head, mcap::Opcode::data_end) && content.size() == 4) {
      store_le(content.data(), mcap::crc32(0, file.first(at)));
      summary = at + mcap::kDataEnd;
    }
    if (mcap::is(head, mcap::Opcode::footer) && content.size() == 20 && summary != 0)
      store_le(content.data() + 16, mcap::crc32(0, file.subspan(summary, at + mcap::kRecordHead + 16 - summary)));
    at += mcap::kRecordHead + head.length;
  }
}

} // namespace scansion::fuzz
