// Which classes the counts of a table are sent as: those for which table and tokens together are cheapest.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/frequencies.hpp"
#include "pipeline/model/avx2.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace scansion {
namespace {

constexpr std::uint64_t kPlenty = 8192; // tokens that make the table's own cost small
constexpr std::uint64_t kTopWeight = weight_of(kMaxClass) + weight_of(kMaxClass) / 16; // rounds in the middle of a class

// The class whose weight is nearest to scaled = count / (largest count) * (largest weight), at least 1.
std::uint8_t class_of(std::uint64_t scaled) noexcept {
  if (scaled < 4) return 1;
  const auto octave = static_cast<unsigned>(std::bit_width(scaled)) - 3;
  return static_cast<std::uint8_t>(
      std::min<std::uint64_t>(kMaxClass, std::uint64_t{4} * octave + ((scaled >> octave) & 3U) + 1));
}

// How much longer the code of a token is than with the largest class.
constexpr auto kBelowTop = [] {
  const auto log = [](int k) {
    return ((k - 1) / 4 + 2) * (1 << kLogBits) + kLogTable[static_cast<std::size_t>((k - 1) % 4 * 64)];
  };
  std::array<std::int32_t, kMaxClass + 1> logs{};
  for (int k = 1; k <= kMaxClass; ++k) logs[static_cast<std::size_t>(k)] = log(kMaxClass) - log(k);
  return logs;
}();

// Of each token a few classes: none, those around the one that its count and its neighbours' ask for, its own. Each has a lane.
constexpr int kAround = 2;
constexpr std::size_t kLanes = 8;
static_assert(1 + (2 * kAround + 1) + 1 <= kLanes);
using Lanes = std::int32_t __attribute__((vector_size(4 * kLanes)));
using FloatLanes = float __attribute__((vector_size(4 * kLanes)));
using Numbers = std::array<std::int32_t, kLanes>;

/// The choices of one token and the cheapest way to each of them. With less than kPlenty tokens in all, costs (in 2^-kLogBits
/// bits) stay below 2^30.
struct Step {
  Numbers k;
  Numbers cost;
  Numbers before; ///< choice of the token before
  std::size_t choices = 0;
};

// The cheapest ways to the choices of a token: the bits of the gamma code of the step between classes are 1 for none, else 3
// and 2 for each doubling of it. The exponent of a float says that without a bit scan.
__attribute__((always_inline)) inline void step_body(const Step& from, Step& to) noexcept {
  constexpr int kMantissa = 23;
  constexpr int kBias = 127;
  Lanes k;
  std::memcpy(&k, to.k.data(), sizeof k);
  Lanes least = Lanes{} + (1 << 30);
  Lanes before{};
  for (std::size_t b = 0; b < from.choices; ++b) {
    const Lanes off = k - from.k[b];
    const Lanes sign = off >> 31;
    const Lanes doubled = 2 * ((off ^ sign) - sign) + 1;
    const auto exponent = reinterpret_cast<Lanes>(__builtin_convertvector(doubled, FloatLanes)) >> kMantissa;
    const Lanes cost = (exponent << (kLogBits + 1)) + from.cost[b];
    const Lanes less = cost < least;
    before = (less & static_cast<std::int32_t>(b)) | (~less & before);
    least = (less & cost) | (~less & least);
  }
  least -= (kBias << (kLogBits + 1)) - (1 << kLogBits);
  std::memcpy(to.before.data(), &before, sizeof before);
  std::memcpy(to.cost.data(), &least, sizeof least);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void step_avx2(const Step& from, Step& to) noexcept {
  step_body(from, to);
}
void step(const Step& from, Step& to) noexcept {
  has_avx2() ? step_avx2(from, to) : step_body(from, to);
}
#else
void step(const Step& from, Step& to) noexcept {
  step_body(from, to);
}
#endif

} // namespace

// By dynamic programming along the tokens: where there are few counts, a table that follows their every step costs more than it
// gives.
Classes classes_of(const TokenCounts& counts) noexcept {
  Classes out{};
  std::size_t used = kTokens;
  while (used > 0 && counts[used - 1] == 0) --used;
  std::uint64_t top = 0;
  std::uint64_t sum = 0;
  for (const std::uint32_t n : std::span(counts).first(used)) {
    top = std::max<std::uint64_t>(top, n);
    sum += n;
  }
  if (top == 0) return out;
  if (sum >= kPlenty) {
    for (std::size_t t = 0; t < used; ++t)
      if (counts[t] != 0) out[t] = class_of(counts[t] * kTopWeight / top);
    return out;
  }
  // Quotients by the same numbers, as products; 32 and 10 bits keep all of what matters.
  const std::uint64_t to_weight = (kTopWeight << 32U) / (9 * top);
  constexpr std::uint64_t kPerNat = 5909;             // 2^kLogBits / ln 2
  const std::uint64_t total = sum * kTopWeight / top; // about the sum of all weights
  const std::uint64_t others = (sum * kPerNat << 10U) / total;
  std::array<std::int32_t, kMaxClass + 1> for_others; // what a token's weight costs all other tokens
  for (std::uint8_t k = 0; k <= kMaxClass; ++k) for_others[k] = static_cast<std::int32_t>(weight_of(k) * others >> 10U);

  constexpr std::uint64_t kFew = 256;
  const int around = sum < kFew ? kAround : 1;   // with many tokens the best is near
  std::array<std::uint32_t, kTokens + 4> wide{}; // with two zeros at either end
  std::ranges::copy(std::span(counts).first(used), wide.begin() + 2);
  std::array<Step, kTokens + 1> steps;
  steps[0].k[0] = kMaxClass;
  steps[0].cost[0] = 0;
  steps[0].choices = 1;
  for (std::size_t t = 0; t < used; ++t) {
    const std::uint32_t* n = wide.data() + t;
    const std::uint64_t smooth = std::uint64_t{n[0]} + n[4] + 2 * (std::uint64_t{n[1]} + n[3]) + 3 * std::uint64_t{n[2]};
    const int middle = class_of(smooth * to_weight >> 32U);
    const int exact = class_of(std::uint64_t{9} * counts[t] * to_weight >> 32U);
    Step& here = steps[t + 1];
    std::size_t c = 0;
    here.k = {};
    if (counts[t] == 0) ++c;
    for (int k = std::max(1, middle - around); k <= std::min<int>(kMaxClass, middle + around); ++k) here.k[c++] = k;
    if (std::abs(exact - middle) > around) here.k[c++] = exact;
    here.choices = c;
    step(steps[t], here);
    // Less weight makes the token itself dear, more weight all others.
    for (std::size_t l = 0; l < kLanes; ++l) {
      const auto k = static_cast<std::size_t>(here.k[l]);
      here.cost[l] += static_cast<std::int32_t>(counts[t]) * kBelowTop[k] + for_others[k];
    }
  }
  std::size_t best = 0;
  for (std::size_t c = 1; c < steps[used].choices; ++c)
    if (steps[used].cost[c] < steps[used].cost[best]) best = c;
  for (std::size_t t = used; t-- > 0; best = static_cast<std::size_t>(steps[t + 1].before[best]))
    out[t] = static_cast<std::uint8_t>(steps[t + 1].k[best]);
  return out;
}

} // namespace scansion
