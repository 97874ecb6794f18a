// Reading decimal text and IEEE values exactly.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace scansion {
namespace {

bool is_digit(char c) noexcept {
  return static_cast<unsigned char>(c - '0') < 10;
}
char lower(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}

/// The end of `word` at `text` (any case), or null.
const char* match(const char* text, std::string_view word) noexcept {
  for (const char c : word)
    if (lower(*text++) != c) return nullptr;
  return text;
}

/// nan, nan(...), inf, infinity.
const char* parse_invalid(const char* text, Number& out) noexcept {
  out = Number::none();
  if (const char* end = match(text, "nan"); end != nullptr) {
    if (*end != '(') return end;
    const char* close = end + 1;
    while (is_digit(*close) || *close == '_' || (lower(*close) >= 'a' && lower(*close) <= 'z')) ++close;
    return *close == ')' ? close + 1 : end;
  }
  if (const char* end = match(text, "inf"); end != nullptr) {
    const char* longer = match(end, "inity");
    return longer != nullptr ? longer : end;
  }
  return nullptr;
}

/// Reads `e-5` at `p`; leaves `p` alone when no exponent stands there.
int parse_exponent(const char*& p) noexcept {
  const char* q = p + 1;
  const bool negative = *q == '-';
  if (*q == '-' || *q == '+') ++q;
  if (!is_digit(*q)) return 0;
  int value = 0;
  for (; is_digit(*q); ++q) value = std::min(kMaxExponent, value * 10 + (*q - '0'));
  p = q;
  return negative ? -value : value;
}

/// More digits than a mantissa surely holds: without the zeros at both ends it may still fit, else the nearest double serves.
/// `digits` to `digits_end` are digits with at most one point; `exponent` is that of the last digit.
void parse_long(const char* digits, const char* digits_end, const char* end, int exponent, bool negative,
                Number& out) noexcept {
  int significant = 0;
  int zeros = 0; // since the last digit that was none
  std::int64_t mantissa = 0;
  for (const char* p = digits; p != digits_end; ++p) {
    if (*p == '.') continue;
    if (*p == '0') {
      zeros += significant > 0 ? 1 : 0;
      continue;
    }
    significant += zeros + 1;
    for (int k = 0; k <= zeros && significant <= kMaxDigits; ++k) mantissa *= 10;
    mantissa += *p - '0';
    zeros = 0;
    if (significant > kMaxDigits) break;
  }
  if (significant <= kMaxDigits) {
    out = {negative ? -mantissa : mantissa, significant == 0 ? 0 : std::clamp(exponent + zeros, -kMaxExponent, kMaxExponent),
           NumberKind::decimal};
    return;
  }
  double value = 0.0;
  const auto read = std::from_chars(digits, end, value);
  if (read.ec == std::errc::result_out_of_range) {
    const char* const first = std::find_if(digits, digits_end, [](char c) { return c >= '1' && c <= '9'; });
    const auto from_first = (digits_end - first) - std::count(first, digits_end, '.');
    const bool huge = from_first + exponent > 0;
    out = huge ? Number{negative ? -1 : 1, kMaxExponent, NumberKind::decimal} : Number::whole(0);
    return;
  }
  out = Number::ieee(NumberKind::float64, negative && value != 0.0 ? -value : value);
}

} // namespace

Number Number::ieee(NumberKind kind, double value) noexcept {
  if (!std::isfinite(value)) return none();
  return {std::bit_cast<std::int64_t>(value), 0, kind};
}

const char* parse_number(const char* text, Number& out) noexcept {
  const char* p = text;
  const bool negative = *p == '-';
  if (*p == '-' || *p == '+') ++p;
  const char* const digits = p;
  std::uint64_t mantissa = 0;
  while (is_digit(*p)) mantissa = mantissa * 10 + static_cast<unsigned char>(*p++ - '0');
  auto count = p - digits;
  int exponent = 0;
  if (*p == '.') {
    const char* const fraction = ++p;
    while (is_digit(*p)) mantissa = mantissa * 10 + static_cast<unsigned char>(*p++ - '0');
    exponent = -static_cast<int>(p - fraction);
    count += p - fraction;
  }
  if (count == 0) return p == digits ? parse_invalid(p, out) : nullptr;
  const char* const digits_end = p;
  if ((*p | 0x20) == 'e') exponent += parse_exponent(p);
  if (count > kMaxDigits) {
    parse_long(digits, digits_end, p, exponent, negative, out);
    return p;
  }
  const auto magnitude = static_cast<std::int64_t>(mantissa);
  out = {negative ? -magnitude : magnitude, exponent, NumberKind::decimal};
  return p;
}

namespace {

/// Writes "mantissa e exponent"; returns the end.
char* write_scientific(const Number& decimal, std::array<char, 48>& text) noexcept {
  char* p = std::to_chars(text.data(), text.data() + 24, decimal.mantissa).ptr;
  *p++ = 'e';
  return std::to_chars(p, text.data() + text.size(), decimal.exponent).ptr;
}

Number without_zeros(Number decimal) noexcept {
  if (decimal.mantissa == 0) return Number::whole(0);
  for (; decimal.mantissa % 10 == 0; ++decimal.exponent) decimal.mantissa /= 10;
  return decimal;
}

} // namespace

double to_double(const Number& number) noexcept {
  if (number.kind == NumberKind::invalid) return std::numeric_limits<double>::quiet_NaN();
  if (number.kind != NumberKind::decimal) return number.bits_value();
  constexpr std::int64_t kExact = std::int64_t{1} << 53;
  const std::int64_t m = number.mantissa;
  if (number.exponent <= 0 && number.exponent >= -kMaxDigits && m <= kExact && m >= -kExact)
    return static_cast<double>(m) / static_cast<double>(kPowersOfTen[static_cast<std::size_t>(-number.exponent)]);
  if (m == 0) return 0.0;
  std::array<char, 48> text{};
  double value = 0.0;
  if (std::from_chars(text.data(), write_scientific(number, text), value).ec == std::errc::result_out_of_range &&
      number.exponent > 0)
    value = std::numeric_limits<double>::infinity();
  return number.exponent > 0 && m < 0 && value > 0 ? -value : value;
}

int decimals_of(const Number& decimal) noexcept {
  if (decimal.mantissa == 0) return 0;
  std::int64_t mantissa = decimal.mantissa;
  int exponent = decimal.exponent;
  for (; exponent < 0 && mantissa % 10 == 0; ++exponent) mantissa /= 10;
  return exponent < 0 ? -exponent : 0;
}

std::optional<float> as_single(const Number& decimal) noexcept {
  if (decimal.mantissa == 0) return 0.0F;
  const Number number = without_zeros(decimal);
  constexpr std::int64_t kSixDigits = 1000000;
  constexpr int kExactPower = 10; // 10^10 is the last power of ten that is a single
  if (number.mantissa < kSixDigits && number.mantissa > -kSixDigits && number.exponent <= 0 && number.exponent >= -kExactPower)
    // One division of exact singles rounds once, and six digits always survive a single.
    return static_cast<float>(number.mantissa) / static_cast<float>(kPowersOfTen[static_cast<std::size_t>(-number.exponent)]);
  std::array<char, 48> text{};
  float value = 0.0F;
  if (std::from_chars(text.data(), write_scientific(number, text), value).ec != std::errc()) return std::nullopt;
  const Number shortest = without_zeros(shortest_decimal(Number::ieee(NumberKind::float32, static_cast<double>(value))));
  if (shortest.mantissa != number.mantissa || shortest.exponent != number.exponent) return std::nullopt;
  return value;
}

bool is_zero_or_one(const Number& number) noexcept {
  if (number.kind != NumberKind::decimal) return false;
  if (number.mantissa == 0) return true;
  return number.exponent <= 0 && number.exponent >= -kMaxDigits &&
         number.mantissa == kPowersOfTen[static_cast<std::size_t>(-number.exponent)];
}

Number shortest_decimal(const Number& ieee) noexcept {
  std::array<char, 40> text{};
  const double value = ieee.bits_value();
  char* const last = text.data() + text.size() - 1;
  const auto written = ieee.kind == NumberKind::float32
                           ? std::to_chars(text.data(), last, static_cast<float>(value), std::chars_format::scientific)
                           : std::to_chars(text.data(), last, value, std::chars_format::scientific);
  *written.ptr = '\n';
  Number decimal;
  if (parse_number(text.data(), decimal) == nullptr) return Number::none();
  return decimal;
}

} // namespace scansion
