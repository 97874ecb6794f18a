// Strings of bits, least significant bit of each byte first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/endian.hpp"
#include "pipeline/codec/payload.hpp"

#include <algorithm>
#include <cstring>

namespace scansion {

/// Appends bits to a byte string.
class BitWriter {
public:
  explicit BitWriter(Bytes& to) noexcept : to_(to) {}
  /// The `count` (0 to 32) low bits of `value`; higher bits must be 0.
  void put(std::uint32_t value, unsigned count) {
    waiting_ |= std::uint64_t{value} << filled_;
    filled_ += count;
    if (filled_ < 32) return;
    append_le(to_, static_cast<std::uint32_t>(waiting_));
    waiting_ >>= 32U;
    filled_ -= 32;
  }
  /// Elias-gamma code of value + 1; value below 2^31.
  void put_gamma(std::uint32_t value) {
    const auto more = static_cast<unsigned>(std::bit_width(value + 1)) - 1;
    put(0, more);
    put(1, 1);
    put((value + 1) & ((1U << more) - 1), more); // NOLINT(clang-analyzer-core.UndefinedBinaryOperatorResult): value + 1 > 0
  }
  void flush() {
    for (; filled_ > 0; filled_ -= std::min(filled_, 8U)) {
      to_.push_back(static_cast<std::byte>(waiting_));
      waiting_ >>= 8U;
    }
  }

private:
  Bytes& to_;
  std::uint64_t waiting_ = 0;
  unsigned filled_ = 0;
};

/// Reads bits. Beyond the end come zeros, and ok() is false.
class BitReader {
public:
  BitReader() = default;
  explicit BitReader(ByteView from) noexcept : next_(from.data()), end_(from.data() + from.size()) {}

  /// `count` is 0 to 32.
  [[nodiscard]] std::uint32_t take(unsigned count) noexcept {
    if (filled_ < count) refill(count);
    const auto value = static_cast<std::uint32_t>(waiting_ & ((std::uint64_t{1} << count) - 1));
    waiting_ >>= count;
    filled_ -= count;
    return value;
  }
  [[nodiscard]] std::uint32_t take_gamma() noexcept {
    unsigned more = 0;
    while (take(1) == 0)
      if (++more > 31) {
        ok_ = false;
        return 0;
      }
    return ((1U << more) | take(more)) - 1;
  }
  [[nodiscard]] bool ok() const noexcept { return ok_; }
  /// All bytes were needed, and the bits left over in the last are 0.
  [[nodiscard]] bool at_end() const noexcept { return ok_ && next_ == end_ && filled_ < 8 && waiting_ == 0; }
  /// Bytes that no bit has been taken from.
  [[nodiscard]] ByteView untouched() const noexcept {
    const std::byte* from = next_ - filled_ / 8;
    return {from, end_};
  }

private:
  void refill(unsigned wanted) noexcept {
    if (end_ - next_ >= 4) {
      waiting_ |= std::uint64_t{load_le<std::uint32_t>(next_)} << filled_;
      next_ += 4;
      filled_ += 32;
      return;
    }
    for (; next_ < end_; filled_ += 8) waiting_ |= std::uint64_t{static_cast<std::uint8_t>(*next_++)} << filled_;
    if (filled_ >= wanted) return;
    ok_ = false;
    waiting_ = 0;
    filled_ = wanted;
  }

  const std::byte* next_ = nullptr;
  const std::byte* end_ = nullptr;
  std::uint64_t waiting_ = 0;
  unsigned filled_ = 0;
  bool ok_ = true;
};

} // namespace scansion
