// Seeded random numbers that are the same on every machine and with every standard library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace scansion {

/// xoshiro256** 1.0 (Blackman and Vigna), state filled by splitmix64. Thread-bound.
class Random {
public:
  /// Independent streams for each (seed, line, purpose), so that one fault switched on leaves all other draws as they were.
  Random(std::uint64_t seed, std::uint64_t line, std::uint64_t purpose) noexcept;

  [[nodiscard]] std::uint64_t next() noexcept;
  /// In [0, 1), 53 bits.
  [[nodiscard]] double uniform() noexcept;
  /// In [0, bound), bound at least 1 and below 2^32.
  [[nodiscard]] std::uint32_t below(std::uint32_t bound) noexcept;
  /// Normal distribution, mean 0, sigma 1 (polar method).
  [[nodiscard]] double normal() noexcept;

private:
  std::array<std::uint64_t, 4> state_{};
  double spare_ = 0.0;
  bool has_spare_ = false;
};

} // namespace scansion
