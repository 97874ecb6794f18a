// The header that every binary payload of a recording carries (docs/FORMAT.md, "Payload header").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scansion {

using Bytes = std::vector<std::byte>;
using ByteView = std::span<const std::byte>;

inline constexpr std::array<std::uint8_t, 8> kPayloadMark{0x89, 'S', 'C', 'N', 'G', 'R', 'P', 0x0A};
inline constexpr std::uint8_t kPayloadVersion = 1;
/// The log time of a line without a realtime stamp is its index times this.
inline constexpr std::uint64_t kNominalLineNs = 1'000'000;
/// Headers are between these many bytes long.
inline constexpr std::size_t kShortestPayloadHeader = 27;
inline constexpr std::size_t kLongestPayloadHeader = 84;

enum class PayloadKind : std::uint8_t { lines = 0, level = 1, rest = 2 };

/// Its bytes are in docs/FORMAT.md; how many they are follows from the values.
struct PayloadHeader {
  PayloadKind kind = PayloadKind::lines;
  std::uint8_t level = 0;  ///< 0 for lines; k for lod<k>; n for rest
  std::uint8_t levels = 0; ///< n: how many lod channels the recording has
  std::uint32_t stream = 0;
  std::uint32_t group = 0;
  std::uint16_t line_count = 0;
  std::uint16_t epoch = 0;
  std::uint64_t first_line = 0;
  std::uint64_t first_time_ns = 0; ///< log time of the first line
  std::uint64_t last_time_ns = 0;  ///< log time of the last line
  double tolerance = 0.0;          ///< mm: d_(k+1) of this level; 0 for lines and rest
  double left_out = 0.0;    ///< mm: exact largest distance left out when this and all coarser levels are read; 0 for rest; for
                            ///< lines: the largest finite D of the group
  std::uint32_t points = 0; ///< points in this payload; for lines: in the group
  std::uint32_t body_size = 0; ///< bytes after the header

  friend bool operator==(const PayloadHeader&, const PayloadHeader&) = default;
};

/// How many bytes the header takes, and the payload with it.
[[nodiscard]] std::size_t header_size(const PayloadHeader& header) noexcept;
[[nodiscard]] inline std::size_t payload_size(const PayloadHeader& header) noexcept {
  return header_size(header) + header.body_size;
}

/// out := header and body; sets body_size and the checksum (CRC-32C over all bytes but its own).
void seal_payload(PayloadHeader header, ByteView body, Bytes& out);

/// Reads a header from the start of `bytes` without looking at the body. Fails with damaged when mark, version or a field is
/// impossible or the body would reach beyond `bytes`.
[[nodiscard]] Result<PayloadHeader> parse_payload_header(ByteView bytes);
/// The same where only the start is at hand: `available` is how many bytes, header included, the payload may have.
[[nodiscard]] Result<PayloadHeader> parse_payload_header(ByteView start, std::uint64_t available);

/// parse_payload_header and the checksum over exactly header + body. `bytes` may be longer than the payload.
[[nodiscard]] Result<PayloadHeader> check_payload(ByteView bytes);

/// One group, encoded: payloads[0] the line table, then lod0 .. lod<n-1>, then rest.
struct EncodedGroup {
  std::uint32_t number = 0;
  std::uint64_t first_line = 0;
  std::uint32_t line_count = 0;
  std::uint64_t first_time_ns = 0;
  std::uint64_t last_time_ns = 0;
  std::vector<Bytes> payloads;
};

} // namespace scansion
