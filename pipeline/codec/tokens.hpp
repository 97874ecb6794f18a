// Residuals as tokens: what is entropy coded of a residual, and how many plain bits follow (docs/FORMAT.md, "Coded").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace scansion {

// Small residuals have tokens of their own; beyond that four tokens share an octave and the low bits are plain.
inline constexpr std::uint32_t kDirectTokens = 32;
inline constexpr std::size_t kTokens = kDirectTokens + 4 * 27;

[[nodiscard]] constexpr std::uint32_t fold(std::int32_t v) noexcept {
  return (static_cast<std::uint32_t>(v) << 1U) ^ static_cast<std::uint32_t>(v >> 31);
}
[[nodiscard]] constexpr std::int32_t unfold(std::uint32_t z) noexcept {
  return static_cast<std::int32_t>((z >> 1U) ^ (0U - (z & 1U)));
}

/// The token of a folded residual.
[[nodiscard]] constexpr std::uint32_t token_of(std::uint32_t folded) noexcept {
  if (folded < kDirectTokens) return folded;
  const auto octave = static_cast<std::uint32_t>(std::bit_width(folded)) - 1;
  return kDirectTokens + (octave - 5) * 4 + ((folded >> (octave - 2)) & 3U);
}

struct TokenRange {
  std::uint32_t first = 0; ///< the smallest folded residual of the token
  std::uint32_t bits = 0;  ///< plain bits
};

inline constexpr auto kTokenRanges = [] {
  std::array<TokenRange, kTokens> ranges{};
  for (std::uint32_t t = 0; t < kTokens; ++t) {
    const std::uint32_t over = t < kDirectTokens ? 0 : t - kDirectTokens;
    ranges[t] = t < kDirectTokens ? TokenRange{t, 0} : TokenRange{(4 + over % 4) << (over / 4 + 3), over / 4 + 3};
  }
  return ranges;
}();

} // namespace scansion
