// MCAP values to and from bytes.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/mcap.hpp"

#include "pipeline/codec/endian.hpp"

#include <algorithm>
#include <cstring>
#include <zlib.h>

static_assert(sizeof(z_off_t) == 8, "recordings are larger than 2 GiB");

namespace scansion::mcap {

void Builder::u8(std::uint8_t v) {
  append_le(*out_, v);
}
void Builder::u16(std::uint16_t v) {
  append_le(*out_, v);
}
void Builder::u32(std::uint32_t v) {
  append_le(*out_, v);
}
void Builder::u64(std::uint64_t v) {
  append_le(*out_, v);
}

void Builder::raw(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::size_t at = out_->size();
  out_->resize(at + bytes.size());
  std::memcpy(out_->data() + at, bytes.data(), bytes.size());
}

void Builder::string(std::string_view text) {
  u32(static_cast<std::uint32_t>(text.size()));
  raw(text);
}

void Builder::entries(const Entries& map) {
  const std::size_t length_at = out_->size();
  u32(0);
  for (const auto& [key, value] : map) {
    string(key);
    string(value);
  }
  store_le(out_->data() + length_at, static_cast<std::uint32_t>(out_->size() - length_at - 4));
}

std::size_t Builder::begin(Opcode opcode) {
  u8(static_cast<std::uint8_t>(opcode));
  u64(0);
  return out_->size();
}

void Builder::end(std::size_t begun) {
  store_le(out_->data() + begun - 8, static_cast<std::uint64_t>(out_->size() - begun));
}

void Builder::begin_sized(Opcode opcode, std::uint64_t length) {
  u8(static_cast<std::uint8_t>(opcode));
  u64(length);
}

ByteView Cursor::take(std::uint64_t count) noexcept {
  if (!ok_ || count > bytes_.size()) {
    ok_ = false;
    return {};
  }
  const ByteView taken = bytes_.first(count);
  bytes_ = bytes_.subspan(count);
  return taken;
}

std::uint8_t Cursor::u8() noexcept {
  const ByteView b = take(1);
  return ok_ ? load_le<std::uint8_t>(b.data()) : std::uint8_t{0};
}
std::uint16_t Cursor::u16() noexcept {
  const ByteView b = take(2);
  return ok_ ? load_le<std::uint16_t>(b.data()) : std::uint16_t{0};
}
std::uint32_t Cursor::u32() noexcept {
  const ByteView b = take(4);
  return ok_ ? load_le<std::uint32_t>(b.data()) : 0;
}
std::uint64_t Cursor::u64() noexcept {
  const ByteView b = take(8);
  return ok_ ? load_le<std::uint64_t>(b.data()) : 0;
}

std::string Cursor::string() {
  return std::string(text_of(take(u32())));
}

Entries Cursor::entries() {
  Cursor inner(take(u32()));
  Entries map;
  while (ok_ && inner.ok() && !inner.at_end()) {
    std::string key = inner.string();
    std::string value = inner.string();
    map.emplace_back(std::move(key), std::move(value));
  }
  ok_ = ok_ && inner.ok();
  if (!ok_) map.clear();
  return map;
}

RecordHead record_head(ByteView bytes) noexcept {
  if (bytes.size() < kRecordHead) return {};
  return {load_le<std::uint8_t>(bytes.data()), load_le<std::uint64_t>(bytes.data() + 1)};
}

std::uint32_t crc32(std::uint32_t crc, ByteView bytes) noexcept {
  if (bytes.empty()) return crc; // zlib answers 0 for a null pointer
  return static_cast<std::uint32_t>(::crc32_z(crc, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::uint32_t crc32_joined(std::uint32_t first, std::uint32_t second, std::uint64_t second_length) noexcept {
  return static_cast<std::uint32_t>(::crc32_combine(first, second, static_cast<z_off_t>(second_length)));
}

bool same(ByteView a, ByteView b) noexcept {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size()) == 0);
}

std::size_t same_bytes(ByteView a, ByteView b) noexcept {
  const std::size_t count = std::min(a.size(), b.size());
  if (same(a.first(count), b.first(count))) return count;
  return static_cast<std::size_t>(std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(count), b.begin()).first -
                                  a.begin());
}

} // namespace scansion::mcap
