// Lattice points as numbers of an output unit.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/value_format.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

namespace scansion {
namespace {

__extension__ using I128 = __int128;
__extension__ using U128 = unsigned __int128;

constexpr unsigned kMaxDigits = 18;

// Writes `value` * 10^-digits without trailing zeros.
char* write_decimal(char* to, I128 value, unsigned digits) noexcept {
  U128 rest = static_cast<U128>(value < 0 ? -value : value);
  if (value < 0) *to++ = '-';
  while (digits > 0 && rest % 10 == 0) {
    rest /= 10;
    --digits;
  }
  std::array<char, 48> reversed;
  std::size_t n = 0;
  const auto put = [&](unsigned digit) { reversed[n++] = static_cast<char>('0' + digit); };
  unsigned place = 0;
  // 64 bit division as soon as it is enough.
  while (rest > ~std::uint64_t{0}) {
    put(static_cast<unsigned>(rest % 10));
    rest /= 10;
    if (++place == digits) reversed[n++] = '.';
  }
  auto low = static_cast<std::uint64_t>(rest);
  do {
    put(static_cast<unsigned>(low % 10));
    low /= 10;
    if (++place == digits) reversed[n++] = '.';
  } while (low > 0 || place <= digits);
  while (n > 0) *to++ = reversed[--n];
  return to;
}

} // namespace

Result<ValueFormat> ValueFormat::make(const Lattice& lattice, Unit unit, bool single) {
  ValueFormat format;
  format.lattice_ = lattice;
  format.single_ = single;
  if (unit != lattice.unit) {
    const Rational out = millimetres(unit);
    SCANSION_TRY(change, multiply(millimetres(lattice.unit), Rational{out.den, out.num}));
    format.unit_change_ = change;
  }
  const auto step = multiply(lattice.resolution, format.unit_change_);
  if (lattice.exact || single || !step) return format;
  // A decimal fraction: the denominator has no prime factors but 2 and 5.
  std::int64_t den = step.value().den;
  unsigned twos = 0;
  unsigned fives = 0;
  for (; den % 2 == 0; den /= 2) ++twos;
  for (; den % 5 == 0; den /= 5) ++fives;
  const unsigned digits = std::max(twos, fives);
  if (den != 1 || digits > kMaxDigits) return format;
  I128 power = 1;
  for (unsigned i = 0; i < digits; ++i) power *= 10;
  const I128 multiplier = power / step.value().den * step.value().num;
  if (multiplier > (I128{1} << 62)) return format;
  format.decimal_ = true;
  format.digits_ = digits;
  format.multiplier_ = static_cast<std::int64_t>(multiplier);
  return format;
}

double ValueFormat::value(std::size_t axis, std::int32_t count, std::int64_t ulp) const noexcept {
  double v = lattice_value(lattice_, lattice_.origin[axis] + count);
  if (lattice_.exact) v = step_ulps(lattice_.source, v, ulp);
  if (unit_change_.num != unit_change_.den)
    v = v * static_cast<double>(unit_change_.num) / static_cast<double>(unit_change_.den);
  return single_ ? static_cast<double>(static_cast<float>(v)) : v;
}

char* ValueFormat::write(char* to, std::size_t axis, std::int32_t count, std::int64_t ulp) const noexcept {
  if (decimal_) return write_decimal(to, static_cast<I128>(lattice_.origin[axis] + count) * multiplier_, digits_);
  const double v = value(axis, count, ulp);
  const bool as_single = single_ || (lattice_.source == Source::float32 && unit_change_.num == unit_change_.den);
  return as_single ? std::to_chars(to, to + kMaxText, static_cast<float>(v)).ptr : std::to_chars(to, to + kMaxText, v).ptr;
}

} // namespace scansion
