// One coordinate as the input states it: an exact decimal, an IEEE value, or nothing usable.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

namespace scansion {

enum class NumberKind : std::uint8_t { decimal, float32, float64, invalid };

/// decimal: mantissa * 10^exponent, |mantissa| < 10^18. float32, float64: the bits of the value as a double, always finite.
/// invalid: NaN or infinite.
struct Number {
  std::int64_t mantissa = 0;
  std::int32_t exponent = 0;
  NumberKind kind = NumberKind::decimal;

  [[nodiscard]] static Number whole(std::int64_t value) noexcept { return {value, 0, NumberKind::decimal}; }
  [[nodiscard]] static Number ieee(NumberKind kind, double value) noexcept;
  [[nodiscard]] static Number none() noexcept { return {0, 0, NumberKind::invalid}; }
  /// The IEEE value; only for float32 and float64.
  [[nodiscard]] double bits_value() const noexcept { return std::bit_cast<double>(mantissa); }
};

inline constexpr int kMaxDigits = 18; ///< decimal digits that always fit a mantissa
inline constexpr int kMaxExponent = 99999;

inline constexpr std::array<std::int64_t, kMaxDigits + 1> kPowersOfTen = [] {
  std::array<std::int64_t, kMaxDigits + 1> powers{};
  std::int64_t power = 1;
  for (auto& p : powers) {
    p = power;
    power = power <= INT64_MAX / 10 ? power * 10 : power;
  }
  return powers;
}();

/// Reads a number at `text`, which must end in a character that belongs to no number (the reader's row end). Returns the
/// character after it, or null when no number stands there. NaN and infinities are numbers of kind invalid; decimals of more
/// than kMaxDigits significant digits become the nearest double. -0 is 0.
[[nodiscard]] const char* parse_number(const char* text, Number& out) noexcept;

/// The nearest double; for kind invalid NaN.
[[nodiscard]] double to_double(const Number& number) noexcept;

/// Digits after the point that a decimal needs, trailing zeros left out.
[[nodiscard]] int decimals_of(const Number& decimal) noexcept;

/// A decimal with the value 0 or 1, however many zeros it is written with.
[[nodiscard]] bool is_zero_or_one(const Number& number) noexcept;

/// The shortest decimal that reads back as the same bits of its type.
[[nodiscard]] Number shortest_decimal(const Number& ieee) noexcept;

/// The single whose shortest decimal is this very number, so that text which was made from singles can be kept as singles.
[[nodiscard]] std::optional<float> as_single(const Number& decimal) noexcept;

enum class Scaled : std::uint8_t { ok, fraction, overflow };

/// mantissa * 10^shift as a whole number.
[[nodiscard]] inline Scaled scale(std::int64_t mantissa, int shift, std::int64_t& out) noexcept {
  if (shift == 0 || mantissa == 0) {
    out = mantissa;
    return Scaled::ok;
  }
  if (shift > 0) {
    if (shift > kMaxDigits) return Scaled::overflow;
    return __builtin_mul_overflow(mantissa, kPowersOfTen[static_cast<std::size_t>(shift)], &out) ? Scaled::overflow
                                                                                                 : Scaled::ok;
  }
  if (shift < -kMaxDigits) return Scaled::fraction;
  const std::int64_t power = kPowersOfTen[static_cast<std::size_t>(-shift)];
  out = mantissa / power;
  return out * power == mantissa ? Scaled::ok : Scaled::fraction;
}

} // namespace scansion
