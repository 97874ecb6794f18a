// Variable-length integers and a reader that never leaves its bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/payload.hpp"

#include <cstdint>
#include <limits>

namespace scansion {

[[nodiscard]] constexpr std::uint64_t zigzag(std::int64_t v) noexcept {
  return (static_cast<std::uint64_t>(v) << 1U) ^ (v < 0 ? ~std::uint64_t{0} : 0);
}
[[nodiscard]] constexpr std::int64_t unzigzag(std::uint64_t v) noexcept {
  return static_cast<std::int64_t>((v >> 1U) ^ (~(v & 1U) + 1U));
}

/// a + b, held at the ends of the range: hostile residuals must not overflow, and no valid coordinate is near the ends.
[[nodiscard]] constexpr std::int64_t saturating_sum(std::int64_t a, std::int64_t b) noexcept {
  std::int64_t sum = 0;
  if (!__builtin_add_overflow(a, b, &sum)) return sum;
  return b < 0 ? std::numeric_limits<std::int64_t>::min() : std::numeric_limits<std::int64_t>::max();
}

/// LEB128: seven bits a byte, least significant first, the top bit says that more follow.
inline void put_varint(Bytes& to, std::uint64_t value) {
  while (value >= 0x80U) {
    to.push_back(static_cast<std::byte>(value | 0x80U));
    value >>= 7U;
  }
  to.push_back(static_cast<std::byte>(value));
}
inline void put_signed(Bytes& to, std::int64_t value) {
  put_varint(to, zigzag(value));
}

/// Reads a byte string front to back. After the first impossible read `ok()` is false and every value is 0.
class ByteReader {
public:
  explicit ByteReader(ByteView bytes) noexcept : rest_(bytes) {}

  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] bool at_end() const noexcept { return ok_ && rest_.empty(); }
  [[nodiscard]] std::size_t left() const noexcept { return rest_.size(); }
  [[nodiscard]] ByteView rest() const noexcept { return rest_; }

  [[nodiscard]] ByteView bytes(std::uint64_t count) noexcept {
    if (!ok_ || count > rest_.size()) {
      ok_ = false;
      return {};
    }
    const ByteView taken = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(static_cast<std::size_t>(count));
    return taken;
  }
  [[nodiscard]] std::uint8_t byte() noexcept {
    const ByteView one = bytes(1);
    return one.empty() ? std::uint8_t{0} : static_cast<std::uint8_t>(one[0]);
  }
  [[nodiscard]] std::uint64_t varint() noexcept {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const std::uint8_t b = byte();
      if (!ok_) return 0;
      if (shift == 63 && b > 1) break;
      value |= static_cast<std::uint64_t>(b & 0x7FU) << shift;
      if (b < 0x80U) return value;
    }
    ok_ = false;
    return 0;
  }
  [[nodiscard]] std::int64_t signed_varint() noexcept { return unzigzag(varint()); }

private:
  ByteView rest_;
  bool ok_ = true;
};

} // namespace scansion
