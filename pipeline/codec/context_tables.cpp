// Which contexts share a table.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/context_tables.hpp"

#include "pipeline/codec/kernels.hpp"

#include <algorithm>

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

std::uint64_t coded_cost(std::uint64_t sum, std::uint64_t own, std::uint64_t used) noexcept {
  return sum * log2_fixed(static_cast<std::uint32_t>(sum)) - own + kTableCost + used * kTokenCost;
}

template <std::size_t kWords, class Visit>
void for_each_bit(const std::array<std::uint64_t, kWords>& words, Visit&& visit) {
  for (std::size_t w = 0; w < kWords; ++w)
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1)
      visit(64 * w + static_cast<std::size_t>(std::countr_zero(bits)));
}

} // namespace

void ContextTables::clear() noexcept {
  for (; used_ != 0; used_ &= used_ - 1) counts_[static_cast<std::size_t>(std::countr_zero(used_))].fill(0);
  last_token_ = 0;
  tables_ = 0;
}

void ContextTables::count(const std::uint8_t* contexts, const std::uint8_t* tokens, std::size_t n,
                          std::uint32_t last_token) noexcept {
  std::uint64_t used = 0;
  for (std::size_t i = 0; i < n; ++i) {
    used |= std::uint64_t{1} << contexts[i];
    ++counts_[contexts[i]][tokens[i]];
  }
  used_ |= used;
  last_token_ = last_token;
}

void ContextTables::measure(std::size_t context) noexcept {
  const TokenCounts& counts = counts_[context];
  Shared& s = shared_[context];
  s.used.words.fill(0);
  kernels::nonzero(counts.data(), last_token_ + 1, s.used.words.data());
  s.sum = 0;
  s.own = 0;
  std::uint64_t tokens = 0;
  for_each_bit(s.used.words, [&](std::size_t t) {
    s.sum += counts[t];
    s.own += own_[context][t] = times_its_log(counts[t]);
    ++tokens;
  });
  s.cost = coded_cost(s.sum, s.own, tokens);
  s.end = context + 1;
}

// Only tokens that both have make a sum of its own.
std::uint64_t ContextTables::together(std::size_t a, std::size_t b) const noexcept {
  const Shared& x = shared_[a];
  const Shared& y = shared_[b];
  std::uint64_t own = x.own + y.own;
  std::uint64_t tokens = 0;
  TokenSet both;
  for (std::size_t w = 0; w < both.words.size(); ++w) {
    both.words[w] = x.used.words[w] & y.used.words[w];
    tokens += static_cast<std::uint64_t>(std::popcount(x.used.words[w] | y.used.words[w]));
  }
  for_each_bit(both.words,
               [&](std::size_t t) { own += times_its_log(counts_[a][t] + counts_[b][t]) - own_[a][t] - own_[b][t]; });
  return coded_cost(x.sum + y.sum, own, tokens);
}

void ContextTables::join(std::size_t a, std::size_t b, std::uint64_t cost) noexcept {
  Shared& x = shared_[a];
  const Shared& y = shared_[b];
  for_each_bit(y.used.words, [&](std::size_t t) { own_[a][t] = times_its_log(counts_[a][t] += counts_[b][t]); });
  std::uint64_t tokens = 0;
  for (std::size_t w = 0; w < x.used.words.size(); ++w) {
    x.used.words[w] |= y.used.words[w];
    tokens += static_cast<std::uint64_t>(std::popcount(x.used.words[w]));
  }
  x.sum += y.sum;
  x.own = x.sum * log2_fixed(static_cast<std::uint32_t>(x.sum)) + kTableCost + tokens * kTokenCost - cost;
  x.cost = cost;
  x.end = y.end;
}

std::uint64_t ContextTables::plain_bits(std::size_t slot) const noexcept {
  std::uint64_t bits = 0;
  TokenSet over = shared_[slot].used;
  static_assert(kDirectTokens < 64);
  over.words[0] &= ~std::uint64_t{0} << kDirectTokens;
  for_each_bit(over.words, [&](std::size_t t) { bits += std::uint64_t{counts_[slot][t]} * kTokenRanges[t].bits; });
  return bits;
}

std::uint64_t ContextTables::choose() noexcept {
  std::array<std::int64_t, kMaxContexts> gain; // of each and the next behind it
  std::size_t n = 0;
  for (std::uint64_t used = used_; used != 0; used &= used - 1) {
    const auto context = static_cast<std::size_t>(std::countr_zero(used));
    measure(context);
    slot_[n++] = static_cast<std::uint8_t>(context);
  }
  const auto apart = [&](std::size_t s) { return shared_[slot_[s]].cost + shared_[slot_[s + 1]].cost; };
  const auto gain_of = [&](std::size_t s) { return static_cast<std::int64_t>(apart(s) - together(slot_[s], slot_[s + 1])); };
  for (std::size_t s = 0; s + 1 < n; ++s) gain[s] = gain_of(s);
  while (n > 1) {
    const auto best = static_cast<std::size_t>(std::max_element(gain.data(), gain.data() + n - 1) - gain.data());
    if (gain[best] < 0 && n <= kMaxTables) break;
    join(slot_[best], slot_[best + 1], apart(best) - static_cast<std::uint64_t>(gain[best]));
    for (std::size_t s = best + 1; s + 1 < n; ++s) slot_[s] = slot_[s + 1];
    for (std::size_t s = best + 1; s + 2 < n; ++s) gain[s] = gain[s + 1];
    --n;
    if (best + 1 < n) gain[best] = gain_of(best);
    if (best > 0) gain[best - 1] = gain_of(best - 1);
  }
  std::uint64_t cost = 0;
  std::size_t context = 0;
  for (std::size_t s = 0; s < n; ++s) {
    const Shared& shared = shared_[slot_[s]];
    cost += shared.cost + (plain_bits(slot_[s]) << kLogBits);
    while (context < shared.end) table_of_[context++] = static_cast<std::uint8_t>(s);
  }
  while (context < kMaxContexts) table_of_[context++] = static_cast<std::uint8_t>(n - 1);
  tables_ = n;
  return cost;
}

} // namespace scansion
