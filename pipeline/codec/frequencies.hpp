// Frequencies of tokens: counted, made coarse, sent, and scaled to the coder's total (docs/FORMAT.md, "Coded").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/bits.hpp"
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

/// log2(x) in units of 1/4096, x > 0. The same on every machine.
[[nodiscard]] std::uint32_t log2_fixed(std::uint32_t x) noexcept;
inline constexpr unsigned kLogBits = 12;

/// What `counts`, by token, cost when coded with their own frequencies, table included, in units of 1/4096 bit.
[[nodiscard]] std::uint64_t coded_cost(std::span<const std::uint32_t> counts) noexcept;

[[nodiscard]] Classes classes_of(const TokenCounts& counts) noexcept;
/// False when no token occurs.
[[nodiscard]] bool frequencies_of(const Classes& classes, Frequencies& out) noexcept;

void write_classes(const Classes& classes, BitWriter& to);
[[nodiscard]] bool read_classes(BitReader& from, Classes& out) noexcept;

} // namespace scansion
