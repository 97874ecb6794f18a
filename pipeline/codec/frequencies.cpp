// Frequencies of tokens.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/frequencies.hpp"

#include "pipeline/codec/varint.hpp"

#include <algorithm>

namespace scansion {
namespace {

// log2(1 + i / 256) by repeated squaring: integers only, so every compiler makes the same table.
constexpr auto kLogTable = [] {
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

// Classes are a quarter of an octave wide: (4 + m) * 2^e for class 4 e + m + 1.
constexpr std::uint32_t weight(std::uint8_t k) noexcept {
  return k == 0 ? 0 : (4U + (k - 1U) % 4U) << ((k - 1U) / 4U);
}

// What a table costs, roughly: its start, and a few bits a token.
constexpr std::uint64_t kTableCost = std::uint64_t{16} << kLogBits;
constexpr std::uint64_t kTokenCost = (std::uint64_t{5} << kLogBits) / 2;

} // namespace

std::uint32_t log2_fixed(std::uint32_t x) noexcept {
  const auto octave = static_cast<unsigned>(std::bit_width(x)) - 1;
  const std::uint32_t mantissa = octave >= 8 ? x >> (octave - 8) : x << (8 - octave);
  return (octave << kLogBits) + kLogTable[mantissa - 256];
}

std::uint64_t coded_cost(const TokenCounts& counts) noexcept {
  std::uint64_t sum = 0;
  std::uint64_t own = 0;
  std::uint64_t used = 0;
  for (const std::uint32_t n : counts) {
    if (n == 0) continue;
    sum += n;
    own += std::uint64_t{n} * log2_fixed(n);
    ++used;
  }
  if (sum == 0) return 0;
  return sum * log2_fixed(static_cast<std::uint32_t>(sum)) - own + kTableCost + used * kTokenCost;
}

Classes classes_of(const TokenCounts& counts) noexcept {
  Classes out{};
  const std::uint64_t top = *std::ranges::max_element(counts);
  if (top == 0) return out;
  for (std::size_t t = 0; t < kTokens; ++t) {
    if (counts[t] == 0) continue;
    // The nearest class below in the logarithm, rounded in the middle of a class.
    const std::uint64_t scaled = std::uint64_t{counts[t]} * (weight(kMaxClass) + weight(kMaxClass) / 16) / top;
    std::uint8_t k = 1;
    if (scaled >= 4) {
      const auto octave = static_cast<unsigned>(std::bit_width(scaled)) - 3;
      k = static_cast<std::uint8_t>(4 * octave + ((scaled >> octave) & 3U) + 1);
    }
    out[t] = std::min(k, kMaxClass);
  }
  return out;
}

bool frequencies_of(const Classes& classes, Frequencies& out) noexcept {
  std::uint32_t sum = 0;
  for (const std::uint8_t k : classes) sum += weight(k);
  if (sum == 0) return false;
  std::uint32_t total = 0;
  std::size_t first_largest = 0;
  for (std::size_t t = 0; t < kTokens; ++t) {
    const std::uint32_t w = weight(classes[t]);
    out[t] = static_cast<std::uint16_t>(w == 0 ? 0 : std::max(1U, static_cast<std::uint32_t>(std::uint64_t{w} * kTotal / sum)));
    total += out[t];
    if (classes[t] > classes[first_largest]) first_largest = t;
  }
  if (total <= kTotal) {
    out[first_largest] = static_cast<std::uint16_t>(out[first_largest] + kTotal - total);
    return true;
  }
  for (; total > kTotal; --total) --*std::ranges::max_element(out);
  return true;
}

void write_classes(const Classes& classes, BitWriter& to) {
  std::size_t used = kTokens;
  while (used > 0 && classes[used - 1] == 0) --used;
  to.put_gamma(static_cast<std::uint32_t>(used));
  std::uint8_t before = kMaxClass;
  for (std::size_t t = 0; t < used; ++t) {
    to.put_gamma(fold(classes[t] - before));
    before = classes[t];
  }
}

bool read_classes(BitReader& from, Classes& out) noexcept {
  out.fill(0);
  const std::uint32_t used = from.take_gamma();
  if (used > kTokens) return false;
  std::int64_t before = kMaxClass;
  for (std::size_t t = 0; t < used; ++t) {
    before += unfold(from.take_gamma());
    if (before < 0 || before > kMaxClass) return false;
    out[t] = static_cast<std::uint8_t>(before);
  }
  return from.ok();
}

} // namespace scansion
