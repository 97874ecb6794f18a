// Frequencies of tokens.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/frequencies.hpp"

#include "pipeline/codec/varint.hpp"

#include <algorithm>
#include <cstdlib>

namespace scansion {
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
