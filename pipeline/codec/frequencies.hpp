// Frequencies of tokens: counted, made coarse, sent, and scaled to the coder's total (docs/FORMAT.md, "Coded").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/bits.hpp"
#include "pipeline/codec/log2_fixed.hpp"
#include "pipeline/codec/tokens.hpp"

#include <span>

namespace scansion {

inline constexpr unsigned kTotalBits = 12;
inline constexpr std::uint32_t kTotal = 1U << kTotalBits;

using TokenCounts = std::array<std::uint32_t, kTokens>;
using Frequencies = std::array<std::uint16_t, kTokens>; ///< sum kTotal; 0 for tokens that do not occur
/// Each frequency as a coarse logarithm, which is what is sent: 0 for none, else 1 to kMaxClass.
using Classes = std::array<std::uint8_t, kTokens>;
inline constexpr std::uint8_t kMaxClass = 48;
/// Classes are a quarter of an octave wide: (4 + m) * 2^e for class 4 e + m + 1.
[[nodiscard]] constexpr std::uint32_t weight_of(std::uint8_t k) noexcept {
  return k == 0 ? 0 : (4U + (k - 1U) % 4U) << ((k - 1U) / 4U);
}

/// The classes for which table and tokens together are about the cheapest.
[[nodiscard]] Classes classes_of(const TokenCounts& counts) noexcept;
/// False when no token occurs.
[[nodiscard]] bool frequencies_of(const Classes& classes, Frequencies& out) noexcept;

void write_classes(const Classes& classes, BitWriter& to);
[[nodiscard]] bool read_classes(BitReader& from, Classes& out) noexcept;

} // namespace scansion
