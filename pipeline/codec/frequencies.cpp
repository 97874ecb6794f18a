// Frequencies of tokens.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/frequencies.hpp"

#include "pipeline/codec/varint.hpp"

#include <algorithm>
#include <cstdlib>

namespace scansion {
namespace {

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

// What a table costs, roughly: its start, and for each token its class and what its frequency is beside its count.
constexpr std::uint64_t kTableCost = std::uint64_t{48} << kLogBits;
constexpr std::uint64_t kTokenCost = std::uint64_t{6} << kLogBits;

} // namespace

namespace {

template <class CountOf>
std::uint64_t cost_of(std::size_t tokens, CountOf&& count_of) noexcept {
  std::uint64_t sum = 0;
  std::uint64_t own = 0;
  std::uint64_t used = 0;
  for (std::size_t t = 0; t < tokens; ++t) {
    const std::uint32_t n = count_of(t);
    sum += n;
    own += times_its_log(n);
    used += n != 0 ? 1U : 0U;
  }
  if (sum == 0) return 0;
  return sum * log2_fixed(static_cast<std::uint32_t>(sum)) - own + kTableCost + used * kTokenCost;
}

} // namespace

std::uint64_t coded_cost(const TokenCounts& counts, std::size_t tokens) noexcept {
  return cost_of(tokens, [&](std::size_t t) { return counts[t]; });
}

std::uint64_t coded_cost(const TokenCounts& a, const TokenCounts& b, std::size_t tokens) noexcept {
  return cost_of(tokens, [&](std::size_t t) { return a[t] + b[t]; });
}

bool frequencies_of(const Classes& classes, Frequencies& out) noexcept {
  std::uint32_t sum = 0;
  for (const std::uint8_t k : classes) sum += weight_of(k);
  if (sum == 0) return false;
  std::uint32_t total = 0;
  std::size_t first_largest = 0;
  std::size_t end = 0; // of the tokens that occur
  out.fill(0);
  for (std::size_t t = 0; t < kTokens; ++t) {
    if (classes[t] == 0) continue;
    out[t] = static_cast<std::uint16_t>(std::max(1U, weight_of(classes[t]) * kTotal / sum));
    total += out[t];
    end = t + 1;
    if (classes[t] > classes[first_largest]) first_largest = t;
  }
  if (total <= kTotal) {
    out[first_largest] = static_cast<std::uint16_t>(out[first_largest] + kTotal - total);
    return true;
  }
  for (; total > kTotal; --total) --*std::ranges::max_element(std::span(out).first(end));
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
