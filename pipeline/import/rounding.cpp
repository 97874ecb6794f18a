// The nearest lattice point of a number.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/rounding.hpp"

#include <bit>
#include <cmath>

namespace scansion {
namespace {

__extension__ using uint128 = unsigned __int128;

constexpr std::int64_t kMaxTotal = std::int64_t{1} << 62;

/// |value| as numerator / denominator; both factors still lack the resolution's.
struct Fraction {
  std::uint64_t numerator = 0; ///< below 2^63
  uint128 denominator = 1;     ///< below 2^74
};

std::optional<Fraction> fraction_of_decimal(const Number& n) noexcept {
  const auto magnitude = static_cast<std::uint64_t>(n.mantissa < 0 ? -n.mantissa : n.mantissa);
  Fraction f{magnitude, 1};
  if (n.exponent >= 0) {
    std::int64_t scaled = 0;
    if (scale(static_cast<std::int64_t>(magnitude), n.exponent, scaled) != Scaled::ok) return std::nullopt;
    f.numerator = static_cast<std::uint64_t>(scaled);
    return f;
  }
  constexpr int kMost = 22; // 10^22 is below 2^74
  if (n.exponent < -kMost) return std::nullopt;
  for (int e = n.exponent; e < 0; ++e) f.denominator *= 10;
  return f;
}

std::optional<Fraction> fraction_of_ieee(double magnitude) noexcept {
  if (magnitude == 0.0) return Fraction{};
  int exponent = 0;
  const double part = std::frexp(magnitude, &exponent);
  auto mantissa = static_cast<std::uint64_t>(std::ldexp(part, 53));
  exponent -= 53;
  const int zeros = std::countr_zero(mantissa);
  mantissa >>= static_cast<unsigned>(zeros);
  exponent += zeros;
  if (exponent >= 0) {
    if (static_cast<int>(std::bit_width(mantissa)) + exponent > 62) return std::nullopt;
    return Fraction{mantissa << static_cast<unsigned>(exponent), 1};
  }
  if (exponent < -73) return std::nullopt;
  return Fraction{mantissa, uint128{1} << static_cast<unsigned>(-exponent)};
}

std::optional<Rounded> round_fraction(Fraction f, Rational resolution) noexcept {
  const uint128 numerator = static_cast<uint128>(f.numerator) * static_cast<std::uint64_t>(resolution.den); // below 2^116
  const uint128 denominator = f.denominator * static_cast<std::uint64_t>(resolution.num);                   // below 2^127
  uint128 quotient = numerator / denominator;
  const uint128 rest = numerator % denominator;
  const bool up = rest >= denominator - rest;
  quotient += up ? 1 : 0;
  if (quotient > static_cast<uint128>(kMaxTotal)) return std::nullopt;
  const uint128 off = up ? denominator - rest : rest;
  return Rounded{static_cast<std::int64_t>(quotient), static_cast<double>(off) / static_cast<double>(denominator)};
}

std::optional<Rounded> round_roughly(double magnitude, Rational resolution) noexcept {
  const long double counts =
      static_cast<long double>(magnitude) * static_cast<long double>(resolution.den) / static_cast<long double>(resolution.num);
  if (!(counts < static_cast<long double>(kMaxTotal))) return std::nullopt;
  const long double nearest = std::round(counts);
  return Rounded{static_cast<std::int64_t>(nearest), static_cast<double>(std::fabs(counts - nearest))};
}

} // namespace

std::optional<Rounded> round_to(const Number& number, Rational resolution) noexcept {
  const bool decimal = number.kind == NumberKind::decimal;
  const double value = to_double(number);
  const auto fraction = decimal ? fraction_of_decimal(number) : fraction_of_ieee(std::fabs(value));
  auto rounded = fraction ? round_fraction(*fraction, resolution) : round_roughly(std::fabs(value), resolution);
  const bool negative = decimal ? number.mantissa < 0 : value < 0.0;
  if (rounded && negative) rounded->total = -rounded->total;
  return rounded;
}

std::optional<std::int64_t> count_with_bits(const Number& ieee, const Lattice& lattice, int decimals) noexcept {
  const double value = ieee.bits_value();
  const std::int64_t power = kPowersOfTen[static_cast<std::size_t>(decimals)];
  // Below 2^51 the product errs by less than 1/4, and the only count whose double is `value` lies within 1/8 of it.
  double counts = value * static_cast<double>(power);
  std::int64_t total = 0;
  if (std::fabs(counts) < 0x1p51) {
    total = std::llround(counts);
  } else {
    const long double wide = static_cast<long double>(value) * static_cast<long double>(power);
    if (!(std::fabs(wide) < static_cast<long double>(kMaxTotal))) return std::nullopt;
    total = std::llround(wide);
  }
  if (std::bit_cast<std::uint64_t>(lattice_value(lattice, total)) != std::bit_cast<std::uint64_t>(value)) return std::nullopt;
  return total;
}

} // namespace scansion
