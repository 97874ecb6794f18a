// The header of every binary payload.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/payload.hpp"

#include "pipeline/codec/crc32c.hpp"
#include "pipeline/codec/endian.hpp"
#include "pipeline/codec/varint.hpp"
#include "pipeline/model/alpha_set.hpp"
#include "pipeline/model/scan_line.hpp"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

namespace scansion {
namespace {

// Where the bytes stand that do not move; docs/FORMAT.md has the same table.
enum Offset : std::size_t {
  kVersion = 8,
  kChecksum = 9,
  kChecked = 13, ///< the checksum covers what stands before it and from here on
  kLevels = 13,
  kPlace = 14, ///< 0 the line table, k + 1 level k, levels + 1 the rest
  kStream = 15,
  kNumbers = 19,
};

bool has_tolerance(const PayloadHeader& h) noexcept {
  return h.kind == PayloadKind::level;
}
bool has_left_out(const PayloadHeader& h) noexcept {
  return h.kind != PayloadKind::rest;
}

std::size_t varint_size(std::uint64_t value) noexcept {
  return (static_cast<std::size_t>(std::bit_width(value | 1U)) + 6) / 7;
}
// Times are told from what they are without stamps.
std::uint64_t nominal_start(const PayloadHeader& h) noexcept {
  return h.first_line * kNominalLineNs;
}
std::uint64_t nominal_duration(const PayloadHeader& h) noexcept {
  return (h.line_count - std::uint64_t{1}) * kNominalLineNs;
}
std::uint64_t start_told(const PayloadHeader& h) noexcept {
  return zigzag(static_cast<std::int64_t>(h.first_time_ns - nominal_start(h)));
}
std::uint64_t duration_told(const PayloadHeader& h) noexcept {
  return zigzag(static_cast<std::int64_t>(h.last_time_ns - h.first_time_ns - nominal_duration(h)));
}

std::uint32_t checksum(ByteView payload) noexcept {
  return crc32c(crc32c(0, payload.first(kChecksum)), payload.subspan(kChecked));
}

// A number that its field cannot hold spoils the reader.
template <class T>
void take(ByteReader& from, T& to, bool& fits) noexcept {
  const std::uint64_t value = from.varint();
  to = static_cast<T>(value);
  fits = fits && to == value;
}

double take_double(ByteReader& from) noexcept {
  const ByteView raw = from.bytes(sizeof(double));
  return raw.empty() ? 0.0 : std::bit_cast<double>(load_le<std::uint64_t>(raw.data()));
}

bool plausible(const PayloadHeader& h) noexcept {
  return h.levels >= 1 && h.levels <= kMaxLevels && h.line_count >= 1 && h.line_count <= kGroupLines &&
         h.points <= kMaxLinePoints && std::isfinite(h.tolerance) && h.tolerance >= 0 && std::isfinite(h.left_out) &&
         h.left_out >= 0;
}

} // namespace

std::size_t header_size(const PayloadHeader& h) noexcept {
  std::size_t size = kNumbers + (has_tolerance(h) ? sizeof(double) : 0) + (has_left_out(h) ? sizeof(double) : 0);
  for (const std::uint64_t value : {std::uint64_t{h.group}, std::uint64_t{h.line_count}, std::uint64_t{h.epoch}, h.first_line,
                                    start_told(h), duration_told(h), std::uint64_t{h.points}, std::uint64_t{h.body_size}})
    size += varint_size(value);
  return size;
}

void seal_payload(PayloadHeader h, ByteView body, Bytes& out) {
  h.body_size = static_cast<std::uint32_t>(body.size());
  const auto mark = std::as_bytes(std::span(kPayloadMark));
  out.assign(mark.begin(), mark.end());
  append_le(out, kPayloadVersion);
  append_le(out, std::uint32_t{0}); // the checksum, below
  append_le(out, h.levels);
  append_le(out, static_cast<std::uint8_t>(h.kind == PayloadKind::lines ? 0 : h.level + 1));
  append_le(out, h.stream);
  put_varint(out, h.group);
  put_varint(out, h.line_count);
  put_varint(out, h.epoch);
  put_varint(out, h.first_line);
  put_varint(out, start_told(h));
  put_varint(out, duration_told(h));
  if (has_tolerance(h)) append_le(out, std::bit_cast<std::uint64_t>(h.tolerance));
  if (has_left_out(h)) append_le(out, std::bit_cast<std::uint64_t>(h.left_out));
  put_varint(out, h.points);
  put_varint(out, h.body_size);
  assert(out.size() == header_size(h));
  out.insert(out.end(), body.begin(), body.end());
  store_le(out.data() + kChecksum, checksum(out));
}

Result<PayloadHeader> parse_payload_header(ByteView bytes) {
  return parse_payload_header(bytes, bytes.size());
}

Result<PayloadHeader> parse_payload_header(ByteView start, std::uint64_t available) {
  if (start.size() < kNumbers) return fail(Errc::damaged, "payload is shorter than its header");
  const std::byte* p = start.data();
  if (std::memcmp(p, kPayloadMark.data(), kPayloadMark.size()) != 0) return fail(Errc::damaged, "payload mark is missing");
  const auto version = load_le<std::uint8_t>(p + kVersion);
  if (version != kPayloadVersion)
    return fail(Errc::damaged, "payload version ", std::to_string(version), " is not known to this program");
  PayloadHeader h;
  h.levels = load_le<std::uint8_t>(p + kLevels);
  const auto place = load_le<std::uint8_t>(p + kPlace);
  if (place > h.levels + 1) return fail(Errc::damaged, "payload kind is not known");
  h.kind = place == 0 ? PayloadKind::lines : place <= h.levels ? PayloadKind::level : PayloadKind::rest;
  h.level = static_cast<std::uint8_t>(place == 0 ? 0 : place - 1);
  h.stream = load_le<std::uint32_t>(p + kStream);
  ByteReader from(start.subspan(kNumbers));
  bool fits = true;
  std::uint64_t begins = 0;
  std::uint64_t lasts = 0;
  take(from, h.group, fits);
  take(from, h.line_count, fits);
  take(from, h.epoch, fits);
  take(from, h.first_line, fits);
  take(from, begins, fits);
  take(from, lasts, fits);
  h.first_time_ns = nominal_start(h) + static_cast<std::uint64_t>(unzigzag(begins));
  h.last_time_ns = h.first_time_ns + nominal_duration(h) + static_cast<std::uint64_t>(unzigzag(lasts));
  if (has_tolerance(h)) h.tolerance = take_double(from);
  if (has_left_out(h)) h.left_out = take_double(from);
  take(from, h.points, fits);
  take(from, h.body_size, fits);
  if (!from.ok()) return fail(Errc::damaged, "payload is shorter than its header");
  // Values have one form: a number with more bytes than it needs is none of ours.
  if (!fits || !plausible(h) || start.size() - from.left() != header_size(h))
    return fail(Errc::damaged, "payload header holds impossible values");
  if (payload_size(h) > available) return fail(Errc::damaged, "payload is cut short");
  return h;
}

Result<PayloadHeader> check_payload(ByteView bytes) {
  SCANSION_TRY(header, parse_payload_header(bytes));
  const ByteView payload = bytes.first(payload_size(header));
  if (load_le<std::uint32_t>(payload.data() + kChecksum) != checksum(payload))
    return fail(Errc::damaged, "payload checksum is wrong");
  return header;
}

} // namespace scansion
