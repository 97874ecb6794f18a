// Range asymmetric numeral systems with sent frequencies: the entropy coder of residuals (docs/FORMAT.md, "Coded").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/frequencies.hpp"

#include <vector>

namespace scansion {

// 32-bit states in [2^16, 2^32) that take and give 16-bit words. In long arrays two states take turns, so that one waits less
// for the other; short ones save the bytes of the second.
inline constexpr std::uint32_t kRansLow = 1U << 16U;
inline constexpr std::size_t kShortStates = 1;
inline constexpr std::size_t kLongStates = 2;

/// How to encode each token of one table without a division.
struct RansEncodeTable {
  struct Entry {
    std::uint64_t reciprocal = 0; ///< ceil(2^64 / frequency)
    std::uint32_t frequency = 0;
    std::uint32_t start = 0;
  };
  std::array<Entry, kTokens> entries{};

  void set(const Frequencies& frequencies) noexcept {
    std::uint32_t start = 0;
    for (std::size_t t = 0; t < kTokens; ++t) {
      const std::uint32_t f = frequencies[t];
      // For frequency 1 the reciprocal is one short, which the start makes good.
      if (f != 0) entries[t] = {f == 1 ? ~std::uint64_t{0} : ~std::uint64_t{0} / f + 1, f, f == 1 ? start + kTotal - 1 : start};
      start += f;
    }
  }
};

[[nodiscard]] inline std::uint32_t high_product(std::uint64_t a, std::uint32_t b) noexcept {
  __extension__ using Wide = unsigned __int128;
  return static_cast<std::uint32_t>((Wide{a} * b) >> 64U);
}

/// Pushes one token; `at` moves down by a word when the state is full.
[[nodiscard]] inline std::uint32_t rans_push(std::uint32_t state, const RansEncodeTable::Entry& e, std::byte*& at) noexcept {
  // Nobody can tell beforehand when it is full: a shift by nothing is cheaper than a branch.
  const unsigned shift = state >> (32 - kTotalBits) >= e.frequency ? 16U : 0U;
  store_le(at - 2, static_cast<std::uint16_t>(state));
  at -= shift / 8;
  state >>= shift;
  return state + e.start + high_product(e.reciprocal, state) * (kTotal - e.frequency);
}

/// How to decode the tokens of one table.
struct RansDecodeTable {
  std::array<std::uint8_t, kTotal> token{}; ///< by slot
  struct Entry {
    std::uint16_t frequency = 0, start = 0;
  };
  std::array<Entry, kTokens> entries{};

  void set(const Frequencies& frequencies) noexcept {
    std::uint32_t start = 0;
    for (std::size_t t = 0; t < kTokens; ++t) {
      const std::uint32_t f = frequencies[t];
      if (f == 0) continue;
      entries[t] = {static_cast<std::uint16_t>(f), static_cast<std::uint16_t>(start)};
      std::memset(token.data() + start, static_cast<int>(t), f);
      start += f;
    }
  }
};

} // namespace scansion
