// Which contexts share a table: neighbours that are cheaper with one table than with two.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/frequencies.hpp"

#include <vector>

namespace scansion {

inline constexpr std::size_t kMaxContexts = 48;
inline constexpr std::size_t kMaxTables = 12;

/// How often each token was met in each context; then, with some contexts put together, what to make tables from. Contexts
/// stand in the order of growing residuals. One object, one thread; memory is used again.
class ContextTables {
public:
  void clear() noexcept;
  /// Raises the counts. Tokens are not above `last_token`, which is the largest so far.
  void count(const std::uint8_t* contexts, const std::uint8_t* tokens, std::size_t n, std::uint32_t last_token) noexcept;
  /// Puts contexts together until no two neighbours are cheaper with one table and there are at most kMaxTables. Needs counts,
  /// some of a token that is not 0. Returns what tables, tokens and plain bits cost, in units of 2^-kLogBits bits.
  std::uint64_t choose() noexcept;

  [[nodiscard]] std::size_t tables() const noexcept { return tables_; }
  /// Of a table, when chosen.
  [[nodiscard]] const TokenCounts& counts(std::size_t table) const noexcept { return counts_[slot_[table]]; }
  [[nodiscard]] std::uint8_t table_of(std::size_t context) const noexcept { return table_of_[context]; }

private:
  /// A set of tokens, a bit each.
  struct TokenSet {
    std::array<std::uint64_t, (kTokens + 63) / 64> words;
  };
  /// Neighbouring contexts that share a table; their counts stand at the slot of the first of them.
  struct Shared {
    TokenSet used;
    std::uint64_t sum; ///< of the counts
    std::uint64_t own; ///< of the counts times their logarithms
    std::uint64_t cost;
    std::size_t end; ///< contexts of the table end here
  };
  void measure(std::size_t context) noexcept;
  [[nodiscard]] std::uint64_t together(std::size_t a, std::size_t b) const noexcept;
  void join(std::size_t a, std::size_t b, std::uint64_t cost) noexcept;
  [[nodiscard]] std::uint64_t plain_bits(std::size_t slot) const noexcept;

  std::array<TokenCounts, kMaxContexts> counts_{};
  std::array<std::array<std::uint64_t, kTokens>, kMaxContexts> own_; ///< of each count in use: times its logarithm
  std::array<Shared, kMaxContexts> shared_;
  std::uint64_t used_ = 0;                        ///< contexts that have counts
  std::uint32_t last_token_ = 0;                  ///< the largest
  std::array<std::uint8_t, kMaxContexts> slot_{}; ///< by table
  std::array<std::uint8_t, kMaxContexts> table_of_{};
  std::size_t tables_ = 0;
};

} // namespace scansion
