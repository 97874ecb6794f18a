// Sums and numbers of SCIP 2: what sensor and host both compute.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace scansion::scip {

inline constexpr std::size_t kBlock = 64; ///< data characters a line
inline constexpr char kEchoMark = '&';    ///< in front of a further echo of the same step
inline constexpr std::int64_t kClockPeriodMs = std::int64_t{1} << 24U;

/// The character that closes a line: low six bits of the sum of the bytes before it, plus 0x30.
[[nodiscard]] constexpr char sum_of(std::string_view text) noexcept {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3FU) + 0x30U);
}

/// Six bits a character, most significant first; nothing when a character is out of 0x30..0x6F. At most 5 characters.
[[nodiscard]] constexpr std::optional<std::int32_t> decode_number(std::string_view text) noexcept {
  std::uint32_t value = 0;
  for (const char c : text) {
    const unsigned bits = static_cast<unsigned>(static_cast<unsigned char>(c)) - 0x30U;
    if (bits > 0x3FU) return std::nullopt;
    value = (value << 6U) | bits;
  }
  return static_cast<std::int32_t>(value);
}

/// `value` in `width` characters at the end of `text`.
inline void encode_number(std::string& text, std::uint32_t value, unsigned width) {
  for (unsigned i = width; i-- > 0;) text += static_cast<char>(((value >> (6U * i)) & 0x3FU) + 0x30U);
}

} // namespace scansion::scip
