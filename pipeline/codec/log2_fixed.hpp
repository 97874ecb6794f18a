// Logarithms in whole numbers, the same on every machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace scansion {

inline constexpr unsigned kLogBits = 12;

/// log2(1 + i / 256) by repeated squaring: integers only, so every compiler makes the same table.
inline constexpr auto kLogTable = [] {
  std::array<std::uint16_t, 257> table{};
  for (std::uint64_t i = 0; i <= 256; ++i) {
    std::uint64_t x = (256 + i) << 22U; // 1.0 is 2^30
    std::uint32_t log = 0;
    if (i == 256) {
      table[i] = 1U << kLogBits;
      continue;
    }
    for (unsigned bit = 0; bit < kLogBits; ++bit) {
      x = (x * x) >> 30U;
      log <<= 1U;
      if (x >= std::uint64_t{2} << 30U) {
        x >>= 1U;
        log |= 1U;
      }
    }
    table[i] = static_cast<std::uint16_t>(log);
  }
  return table;
}();

/// log2(x) in units of 2^-kLogBits, x > 0.
[[nodiscard]] constexpr std::uint32_t log2_fixed(std::uint32_t x) noexcept {
  const auto octave = static_cast<unsigned>(std::bit_width(x)) - 1;
  // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): x > 0
  const std::uint32_t mantissa = x << (31U - octave) >> 23U; // its nine leading bits
  return (octave << kLogBits) + kLogTable[mantissa - 256];
}

} // namespace scansion
