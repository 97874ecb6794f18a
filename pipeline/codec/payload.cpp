// The header of every binary payload.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/payload.hpp"

#include "pipeline/codec/crc32c.hpp"
#include "pipeline/codec/endian.hpp"
#include "pipeline/model/alpha_set.hpp"
#include "pipeline/model/scan_line.hpp"

#include <cassert>
#include <cmath>
#include <cstring>

namespace scansion {
namespace {

// Byte offsets; docs/FORMAT.md has the same table.
enum Offset : std::size_t {
  kMark = 0,
  kVersion = 8,
  kKind = 9,
  kLevel = 10,
  kLevels = 11,
  kStream = 12,
  kGroup = 16,
  kLineCount = 20,
  kEpoch = 22,
  kFirstLine = 24,
  kFirstTime = 32,
  kLastTime = 40,
  kTolerance = 48,
  kLeftOut = 56,
  kPoints = 64,
  kBodySize = 68,
  kChecksum = 72,
};
static_assert(kChecksum + 4 == kPayloadHeaderSize);

std::uint32_t checksum(ByteView payload) noexcept {
  const std::uint32_t head = crc32c(0, payload.first(kChecksum));
  return crc32c(head, payload.subspan(kPayloadHeaderSize));
}

bool plausible(const PayloadHeader& h) noexcept {
  const bool level_fits = h.kind == PayloadKind::lines   ? h.level == 0
                          : h.kind == PayloadKind::level ? h.level < h.levels
                                                         : h.level == h.levels;
  return level_fits && h.levels >= 1 && h.levels <= kMaxLevels && h.line_count >= 1 && h.line_count <= kGroupLines &&
         h.points <= kMaxLinePoints && std::isfinite(h.tolerance) && h.tolerance >= 0 && std::isfinite(h.left_out) &&
         h.left_out >= 0;
}

} // namespace

void seal_payload(PayloadHeader header, Bytes& payload) {
  assert(payload.size() >= kPayloadHeaderSize);
  std::byte* p = payload.data();
  header.body_size = static_cast<std::uint32_t>(payload.size() - kPayloadHeaderSize);
  std::memcpy(p + kMark, kPayloadMark.data(), kPayloadMark.size());
  store_le(p + kVersion, kPayloadVersion);
  store_le(p + kKind, static_cast<std::uint8_t>(header.kind));
  store_le(p + kLevel, header.level);
  store_le(p + kLevels, header.levels);
  store_le(p + kStream, header.stream);
  store_le(p + kGroup, header.group);
  store_le(p + kLineCount, header.line_count);
  store_le(p + kEpoch, header.epoch);
  store_le(p + kFirstLine, header.first_line);
  store_le(p + kFirstTime, header.first_time_ns);
  store_le(p + kLastTime, header.last_time_ns);
  store_le(p + kTolerance, std::bit_cast<std::uint64_t>(header.tolerance));
  store_le(p + kLeftOut, std::bit_cast<std::uint64_t>(header.left_out));
  store_le(p + kPoints, header.points);
  store_le(p + kBodySize, header.body_size);
  store_le(p + kChecksum, checksum(payload));
}

Result<PayloadHeader> parse_payload_header(ByteView bytes) {
  return parse_payload_header(bytes, bytes.size());
}

Result<PayloadHeader> parse_payload_header(ByteView bytes, std::uint64_t available) {
  if (bytes.size() < kPayloadHeaderSize || available < kPayloadHeaderSize)
    return fail(Errc::damaged, "payload is shorter than its header");
  const std::byte* p = bytes.data();
  if (std::memcmp(p + kMark, kPayloadMark.data(), kPayloadMark.size()) != 0)
    return fail(Errc::damaged, "payload mark is missing");
  const auto version = load_le<std::uint8_t>(p + kVersion);
  if (version != kPayloadVersion)
    return fail(Errc::damaged, "payload version ", std::to_string(version), " is not known to this program");
  const auto kind = load_le<std::uint8_t>(p + kKind);
  if (kind > static_cast<std::uint8_t>(PayloadKind::rest)) return fail(Errc::damaged, "payload kind is not known");
  PayloadHeader h;
  h.kind = static_cast<PayloadKind>(kind);
  h.level = load_le<std::uint8_t>(p + kLevel);
  h.levels = load_le<std::uint8_t>(p + kLevels);
  h.stream = load_le<std::uint32_t>(p + kStream);
  h.group = load_le<std::uint32_t>(p + kGroup);
  h.line_count = load_le<std::uint16_t>(p + kLineCount);
  h.epoch = load_le<std::uint16_t>(p + kEpoch);
  h.first_line = load_le<std::uint64_t>(p + kFirstLine);
  h.first_time_ns = load_le<std::uint64_t>(p + kFirstTime);
  h.last_time_ns = load_le<std::uint64_t>(p + kLastTime);
  h.tolerance = std::bit_cast<double>(load_le<std::uint64_t>(p + kTolerance));
  h.left_out = std::bit_cast<double>(load_le<std::uint64_t>(p + kLeftOut));
  h.points = load_le<std::uint32_t>(p + kPoints);
  h.body_size = load_le<std::uint32_t>(p + kBodySize);
  if (!plausible(h)) return fail(Errc::damaged, "payload header holds impossible values");
  if (h.body_size > available - kPayloadHeaderSize) return fail(Errc::damaged, "payload is cut short");
  return h;
}

Result<PayloadHeader> check_payload(ByteView bytes) {
  SCANSION_TRY(header, parse_payload_header(bytes));
  const ByteView payload = bytes.first(kPayloadHeaderSize + header.body_size);
  if (load_le<std::uint32_t>(payload.data() + kChecksum) != checksum(payload))
    return fail(Errc::damaged, "payload checksum is wrong");
  return header;
}

} // namespace scansion
