// Frequencies of tokens.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/frequencies.hpp"

#include "pipeline/codec/varint.hpp"

#include <algorithm>
#include <cstdlib>

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

// n log2 n of small counts.
constexpr std::uint32_t kSmall = 512;
const auto kSmallProducts = [] {
  std::array<std::uint32_t, kSmall> products{};
  for (std::uint32_t n = 1; n < kSmall; ++n) products[n] = n * log2_fixed(n);
  return products;
}();

std::uint64_t times_its_log(std::uint32_t n) noexcept {
  return n < kSmall ? kSmallProducts[n] : std::uint64_t{n} * log2_fixed(n);
}

// What a table costs, roughly: its start, and a few bits a token.
constexpr std::uint64_t kTableCost = std::uint64_t{24} << kLogBits;
constexpr std::uint64_t kTokenCost = std::uint64_t{2} << kLogBits;

} // namespace

std::uint32_t log2_fixed(std::uint32_t x) noexcept {
  const auto octave = static_cast<unsigned>(std::bit_width(x)) - 1;
  const std::uint32_t mantissa = octave >= 8 ? x >> (octave - 8) : x << (8 - octave);
  return (octave << kLogBits) + kLogTable[mantissa - 256];
}

std::uint64_t coded_cost(std::span<const std::uint32_t> counts) noexcept {
  std::uint64_t sum = 0;
  std::uint64_t own = 0;
  std::uint64_t used = 0;
  for (const std::uint32_t n : counts) {
    sum += n;
    own += times_its_log(n);
    used += n != 0 ? 1U : 0U;
  }
  if (sum == 0) return 0;
  return sum * log2_fixed(static_cast<std::uint32_t>(sum)) - own + kTableCost + used * kTokenCost;
}

namespace {

// The class whose weight is nearest to scaled = count / (largest count) * (largest weight), at least 1.
std::uint8_t class_of(std::uint64_t scaled) noexcept {
  if (scaled < 4) return 1;
  const auto octave = static_cast<unsigned>(std::bit_width(scaled)) - 3;
  return static_cast<std::uint8_t>(
      std::min<std::uint64_t>(kMaxClass, std::uint64_t{4} * octave + ((scaled >> octave) & 3U) + 1));
}

// Of each token a few classes: none, those around the one that its count and its neighbours' ask for, its own.
constexpr int kAround = 2;
constexpr std::size_t kChoices = 1 + (2 * kAround + 1) + 1;

struct Choice {
  std::uint8_t k;
  std::uint8_t before; // index of the choice of the token before
  std::uint64_t cost;
};
using Choices = std::array<Choice, kChoices>;

constexpr auto kWeightLogs = [] {
  std::array<std::uint32_t, kMaxClass + 1> logs{};
  for (std::uint8_t k = 1; k <= kMaxClass; ++k)
    logs[k] = ((k - 1U) / 4U + 2U) * (1U << kLogBits) + kLogTable[std::size_t{(k - 1U) % 4U} * 64U];
  return logs;
}();

// Bits of the gamma code of a step to a class, from a class.
constexpr auto kStepBits = [] {
  std::array<std::array<std::uint8_t, kMaxClass + 1>, kMaxClass + 1> bits{};
  for (int from = 0; from <= kMaxClass; ++from)
    for (int to = 0; to <= kMaxClass; ++to)
      bits[static_cast<std::size_t>(to)][static_cast<std::size_t>(from)] =
          static_cast<std::uint8_t>(2 * std::bit_width(fold(to - from) + 1) - 1);
  return bits;
}();

} // namespace

// The classes for which table and tokens together are cheapest, by dynamic programming along the tokens: where there are few
// counts, a table that follows their every step costs more than it gives.
Classes classes_of(const TokenCounts& counts) noexcept {
  Classes out{};
  std::size_t used = kTokens;
  while (used > 0 && counts[used - 1] == 0) --used;
  std::uint64_t top = 0;
  std::uint64_t sum = 0;
  for (const std::uint32_t n : counts) {
    top = std::max<std::uint64_t>(top, n);
    sum += n;
  }
  if (top == 0) return out;
  constexpr std::uint64_t kTopWeight = weight(kMaxClass) + weight(kMaxClass) / 16; // rounds in the middle of a class
  const std::uint64_t total = sum * kTopWeight / top;                              // about the sum of all weights
  constexpr std::uint64_t kPerNat = 5909;                                          // 2^kLogBits / ln 2
  constexpr std::uint64_t kPlenty = 8192; // tokens that make the table's own cost small
  if (sum >= kPlenty) {
    for (std::size_t t = 0; t < used; ++t)
      if (counts[t] != 0) out[t] = class_of(counts[t] * kTopWeight / top);
    return out;
  }
  std::array<Choices, kTokens> steps;
  std::size_t choices = 0; // of the token before
  const auto smooth = [&](std::size_t t) {
    const auto n = [&](std::size_t back, std::size_t on) {
      return std::uint64_t{t >= back && t + on < kTokens + back ? counts[t + on - back] : 0};
    };
    return n(2, 0) + 2 * n(1, 0) + 3 * n(0, 0) + 2 * n(0, 1) + n(0, 2);
  };
  // Quotients by the same numbers, as products; 32 and 10 bits keep all of what matters.
  const std::uint64_t to_weight = (kTopWeight << 32U) / (9 * top);
  const std::uint64_t others = (sum * kPerNat << 10U) / total;
  constexpr std::uint64_t kNever = ~std::uint64_t{0} >> 8U;
  const auto consider = [&](std::size_t t, std::size_t c, int k) {
    Choice& choice = steps[t][c];
    choice.k = static_cast<std::uint8_t>(k);
    choice.before = 0;
    const auto& step_bits = kStepBits[choice.k];
    std::uint64_t least = std::uint64_t{step_bits[kMaxClass]} << kLogBits;
    if (t > 0) {
      least = kNever;
      for (std::size_t b = 0; b < choices; ++b) {
        const Choice& from = steps[t - 1][b];
        const std::uint64_t cost = from.cost + (std::uint64_t{step_bits[from.k]} << kLogBits);
        choice.before = cost < least ? static_cast<std::uint8_t>(b) : choice.before;
        least = std::min(least, cost);
      }
    }
    // Less weight makes the token itself dear, more weight all others.
    choice.cost =
        least + counts[t] * std::uint64_t{kWeightLogs[kMaxClass] - kWeightLogs[choice.k]} + (weight(choice.k) * others >> 10U);
  };
  constexpr std::uint64_t kFew = 256;
  const int around = sum < kFew ? kAround : 1; // with many tokens the best is near
  for (std::size_t t = 0; t < used; ++t) {
    const int middle = class_of(smooth(t) * to_weight >> 32U);
    const int exact = class_of(std::uint64_t{9} * counts[t] * to_weight >> 32U);
    std::size_t c = 0;
    if (counts[t] == 0) consider(t, c++, 0);
    for (int k = std::max(1, middle - around); k <= std::min<int>(kMaxClass, middle + around); ++k) consider(t, c++, k);
    if (std::abs(exact - middle) > around) consider(t, c++, exact);
    choices = c;
  }
  std::size_t best = 0;
  for (std::size_t c = 1; c < choices; ++c)
    if (steps[used - 1][c].cost < steps[used - 1][best].cost) best = c;
  for (std::size_t t = used; t-- > 0; best = steps[t][best].before) out[t] = steps[t][best].k;
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
