// Lattice arithmetic: exact fractions, correctly rounded values, distances in units of least precision.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/model/lattice.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>

namespace scansion {
namespace {

__extension__ using int128 = __int128;
__extension__ using uint128 = unsigned __int128;

constexpr std::int64_t kExactDouble = std::int64_t{1} << 53; ///< integers up to here are exact as doubles

struct UnitEntry {
  Unit unit;
  std::string_view text;
  Rational mm;
};

constexpr std::array<UnitEntry, 5> kUnits{{{Unit::m, "m", {1000, 1}},
                                           {Unit::mm, "mm", {1, 1}},
                                           {Unit::um, "um", {1, 1000}},
                                           {Unit::in, "in", {127, 5}},
                                           {Unit::ft, "ft", {1524, 5}}}};

const UnitEntry& entry_of(Unit unit) noexcept {
  for (const UnitEntry& entry : kUnits)
    if (entry.unit == unit) return entry;
  return kUnits[1];
}

int bit_width(uint128 v) noexcept {
  const auto high = static_cast<std::uint64_t>(v >> 64U);
  return high != 0 ? 64 + static_cast<int>(std::bit_width(high))
                   : static_cast<int>(std::bit_width(static_cast<std::uint64_t>(v)));
}

/// numerator / denominator rounded once to `precision` bits, ties to even. The result is always a normal number of either
/// source type: the numerator stays below 2^116 and the denominator below 2^53.
double divide_rounded(uint128 numerator, std::uint64_t denominator, int precision) noexcept {
  if (numerator == 0) return 0.0;
  const int have = bit_width(numerator) - bit_width(denominator);
  const int shift = have < precision + 2 ? precision + 2 - have : 0; // the quotient then has at least precision + 2 bits
  const uint128 scaled = numerator << static_cast<unsigned>(shift);
  uint128 quotient = scaled / denominator;
  const bool sticky = scaled % denominator != 0;
  const int drop = std::max(bit_width(quotient) - precision, 1); // at least 2, in fact
  const uint128 half = uint128{1} << static_cast<unsigned>(drop - 1);
  const uint128 rest = quotient & (2 * half - 1);
  quotient >>= static_cast<unsigned>(drop);
  if (rest > half || (rest == half && (sticky || (quotient & 1U) != 0))) ++quotient;
  return std::ldexp(static_cast<double>(static_cast<std::uint64_t>(quotient)), drop - shift);
}

/// Position of a value among all values of its type, in order; -0.0 stands one below +0.0.
std::int64_t ordinal(Source source, double value) noexcept {
  if (source == Source::float32) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    const auto magnitude = static_cast<std::int64_t>(bits & 0x7FFFFFFFU);
    return (bits >> 31U) != 0 ? ~magnitude : magnitude;
  }
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto magnitude = static_cast<std::int64_t>(bits & 0x7FFFFFFFFFFFFFFFU);
  return (bits >> 63U) != 0 ? ~magnitude : magnitude;
}

double value_at(Source source, std::int64_t position) noexcept {
  const bool negative = position < 0;
  const auto magnitude = static_cast<std::uint64_t>(negative ? ~position : position);
  if (source == Source::float32) {
    const auto bits = (static_cast<std::uint32_t>(magnitude) & 0x7FFFFFFFU) | (negative ? 0x80000000U : 0U);
    return static_cast<double>(std::bit_cast<float>(bits));
  }
  return std::bit_cast<double>(magnitude | (negative ? 0x8000000000000000U : 0U));
}

/// The digits of a decimal number: mantissa * 10^exponent.
struct Decimal {
  uint128 mantissa = 0;
  int exponent = 0;
};

bool read_exponent(std::string_view text, int& exponent) noexcept {
  bool negative = false;
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) {
    negative = text[0] == '-';
    text.remove_prefix(1);
  }
  if (text.empty() || text.size() > 4) return false;
  int value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return false;
    value = value * 10 + (c - '0');
  }
  exponent += negative ? -value : value;
  return true;
}

bool read_decimal(std::string_view text, Decimal& out) noexcept {
  int digits = 0;
  bool point = false;
  std::size_t i = !text.empty() && text[0] == '+' ? 1 : 0;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '.' && !point) {
      point = true;
    } else if (c >= '0' && c <= '9') {
      if (out.mantissa > (~uint128{0} - 9) / 10) return false;
      out.mantissa = out.mantissa * 10 + static_cast<unsigned>(c - '0');
      out.exponent -= point ? 1 : 0;
      ++digits;
    } else {
      break;
    }
  }
  if (digits == 0) return false;
  if (i == text.size()) return true;
  return (text[i] == 'e' || text[i] == 'E') && read_exponent(text.substr(i + 1), out.exponent);
}

Result<Rational> out_of_limits(std::string_view what) {
  return fail(Errc::out_of_range, what, ": is no fraction of two whole numbers below 2^53; use a value with fewer digits");
}

} // namespace

Result<Unit> parse_unit(std::string_view text) {
  for (const UnitEntry& entry : kUnits)
    if (entry.text == text) return entry.unit;
  return fail(Errc::usage, "unknown unit \"", text, "\"; use m, mm, um, in or ft");
}

std::string_view name(Unit unit) noexcept {
  return entry_of(unit).text;
}

Rational millimetres(Unit unit) noexcept {
  return entry_of(unit).mm;
}

Result<Rational> make_rational(std::int64_t num, std::int64_t den) {
  const std::string what = std::to_string(num) + "/" + std::to_string(den);
  if (num <= 0 || den <= 0)
    return fail(Errc::out_of_range, what, ": a resolution must be greater than zero; use a positive value");
  const std::int64_t common = std::gcd(num, den);
  const Rational r{num / common, den / common};
  if (r.num >= kExactDouble || r.den >= kExactDouble) return out_of_limits(what);
  return r;
}

Result<Rational> multiply(Rational a, Rational b) {
  const std::int64_t ab = std::gcd(a.num, b.den);
  const std::int64_t ba = std::gcd(b.num, a.den);
  const int128 num = static_cast<int128>(a.num / ab) * (b.num / ba);
  const int128 den = static_cast<int128>(a.den / ba) * (b.den / ab);
  if (num >= kExactDouble || den >= kExactDouble)
    return out_of_limits(std::to_string(a.num) + "/" + std::to_string(a.den) + " * " + std::to_string(b.num) + "/" +
                         std::to_string(b.den));
  return make_rational(static_cast<std::int64_t>(num), static_cast<std::int64_t>(den));
}

Result<Rational> parse_rational(std::string_view text) {
  Decimal decimal;
  if (!read_decimal(text, decimal))
    return fail(Errc::usage, "\"", text, "\" is no decimal number; write it like 0.005 or 1e-3");
  if (decimal.mantissa == 0) return fail(Errc::out_of_range, "\"", text, "\": must be greater than zero; use a positive value");
  uint128 num = decimal.mantissa;
  uint128 den = 1;
  for (; decimal.exponent > 0; --decimal.exponent) {
    if (num >= static_cast<uint128>(kExactDouble)) return out_of_limits(text);
    num *= 10;
  }
  for (; decimal.exponent < 0; ++decimal.exponent)
    for (const unsigned prime : {2U, 5U}) {
      if (num % prime == 0) {
        num /= prime;
      } else {
        den *= prime;
        if (den >= static_cast<uint128>(kExactDouble)) return out_of_limits(text);
      }
    }
  if (num >= static_cast<uint128>(kExactDouble)) return out_of_limits(text);
  return make_rational(static_cast<std::int64_t>(num), static_cast<std::int64_t>(den));
}

Result<Rational> resolution_mm(const Lattice& lattice) {
  return multiply(lattice.resolution, millimetres(lattice.unit));
}

double lattice_value(const Lattice& lattice, std::int64_t total) noexcept {
  const Rational r = lattice.resolution;
  const int128 product = static_cast<int128>(total) * r.num;
  const bool single = lattice.source == Source::float32;
  if (product < kExactDouble && product > -kExactDouble) {
    // Both operands are exact, so this division rounds once.
    const double value = static_cast<double>(static_cast<std::int64_t>(product)) / static_cast<double>(r.den);
    if (!single) return value;
    // A second rounding can only err where the first one landed half-way between two singles.
    constexpr std::uint64_t kDropped = (std::uint64_t{1} << 29U) - 1;
    if ((std::bit_cast<std::uint64_t>(value) & kDropped) != std::uint64_t{1} << 28U)
      return static_cast<double>(static_cast<float>(value));
  }
  const auto magnitude = product < 0 ? static_cast<uint128>(-product) : static_cast<uint128>(product);
  const double value = divide_rounded(magnitude, static_cast<std::uint64_t>(r.den), single ? 24 : 53);
  return product < 0 ? -value : value;
}

std::int64_t ulps_between(Source source, double from, double to) noexcept {
  // Unsigned, so that the distance between the far ends of the double range wraps round instead of overflowing.
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(ordinal(source, to)) -
                                   static_cast<std::uint64_t>(ordinal(source, from)));
}

double step_ulps(Source source, double from, std::int64_t ulps) noexcept {
  return value_at(
      source, static_cast<std::int64_t>(static_cast<std::uint64_t>(ordinal(source, from)) + static_cast<std::uint64_t>(ulps)));
}

} // namespace scansion
