// Exact comparison of distances to a chord on the integer lattice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>

namespace scansion::exact {

__extension__ using U128 = unsigned __int128;
__extension__ using I128 = __int128;
using U256 = boost::multiprecision::uint256_t; // fixed size, never allocates

/// Nearest double, ties to even.
[[nodiscard]] inline double nearest_double(U128 value) noexcept {
  return static_cast<double>(value);
}
[[nodiscard]] inline double nearest_double(std::uint64_t value) noexcept {
  return static_cast<double>(value);
}
[[nodiscard]] inline double nearest_double(const U256& value) {
  if (value == 0 || msb(value) < 128) return nearest_double(value.convert_to<U128>());
  // The top 128 bits, the last of them set when anything was cut off: enough for one correct rounding.
  const unsigned cut = msb(value) - 127;
  auto top = U256(value >> cut).convert_to<U128>();
  if (U256(value & ((U256(1) << cut) - 1)) != 0) top |= 1;
  return std::ldexp(nearest_double(top), static_cast<int>(cut));
}

/// The squared distance of a point to a segment in counts, as numerator over denominator; the denominator is 1 for points
/// beyond an end of the segment, else the squared length of the chord.
template <class Number, class Length>
struct Squared {
  Number numerator{};
  Length denominator{1};
};

/// a < b, a == b, a > b as a negative, zero or positive number; both are measured against a chord of squared length `chord`.
template <class Number, class Length>
[[nodiscard]] int compare(const Squared<Number, Length>& a, const Squared<Number, Length>& b, const Length& chord) {
  const Number x = a.denominator == b.denominator || a.denominator != 1 ? a.numerator : Number(a.numerator * chord);
  const Number y = a.denominator == b.denominator || b.denominator != 1 ? b.numerator : Number(b.numerator * chord);
  return x < y ? -1 : x > y ? 1 : 0;
}

/// D in mm: sqrt(RN(numerator) / RN(denominator)) * num / den, each step rounded once to double.
template <class Number, class Length>
[[nodiscard]] double millimetres(const Squared<Number, Length>& d, Rational resolution) {
  const double ratio = nearest_double(d.numerator) / nearest_double(d.denominator);
  return std::sqrt(ratio) * static_cast<double>(resolution.num) / static_cast<double>(resolution.den);
}

} // namespace scansion::exact
