// Hostile payloads with right checksums: the decoder must refuse or decode them, in bounded time and memory.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/codec.hpp"

#include <algorithm>
#include <cstring>

namespace {

// Bounds the work of one input: the line table may claim up to kMaxLinePoints points, which is legal and slow.
constexpr std::uint32_t kPoints = 1U << 16U;

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace scansion;
  // Input: for each payload two bytes of length, then header fields and body as they come.
  static GroupDecoder decoder;
  static DecodedGroup group;
  bool begun = false;
  while (size > 2) {
    const std::size_t length =
        std::min<std::size_t>(size - 2, static_cast<std::size_t>(data[0]) | static_cast<std::size_t>(data[1]) << 8U);
    const auto* bytes = reinterpret_cast<const std::byte*>(data + 2);
    Bytes payload(bytes, bytes + length);
    data += 2 + length;
    size -= 2 + length;
    auto header = parse_payload_header(payload);
    if (!header || header.value().points > kPoints) continue;
    const Bytes body(payload.begin() + static_cast<std::ptrdiff_t>(header_size(header.value())), payload.end());
    seal_payload(header.value(), body, payload);
    if (header.value().kind == PayloadKind::lines)
      begun = decoder.begin(payload, group).has_value();
    else if (begun)
      begun = decoder.add(payload, group).has_value();
  }
  return 0;
}
