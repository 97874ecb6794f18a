// Exact comparison of distances to a chord on the integer lattice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"

#include <cmath>
#include <cstdint>

namespace scansion::exact {

__extension__ using U128 = unsigned __int128;

/// The squared distance of a point to a segment in counts, as numerator over denominator; the denominator is 1 for points beyond
/// an end of the segment. All operands come from runs that span less than kMaxRunSpan, so nothing overflows:
/// numerator < 2^124, denominator < 2^62.
struct Squared {
  U128 numerator = 0;
  std::uint64_t denominator = 1;
};

/// a < b, a == b, a > b as a negative, zero or positive number; `chord` is the squared length of the chord both are measured
/// against, so that a denominator is either 1 or `chord`.
[[nodiscard]] inline int compare(const Squared& a, const Squared& b, std::uint64_t chord) noexcept {
  const U128 x = a.denominator == b.denominator || a.denominator != 1 ? a.numerator : a.numerator * chord;
  const U128 y = a.denominator == b.denominator || b.denominator != 1 ? b.numerator : b.numerator * chord;
  return x < y ? -1 : x > y ? 1 : 0;
}

/// D in mm: sqrt(RN(numerator) / RN(denominator)) * num / den, each step rounded once to double.
[[nodiscard]] inline double millimetres(const Squared& d, Rational resolution) noexcept {
  const double ratio = static_cast<double>(d.numerator) / static_cast<double>(d.denominator);
  return std::sqrt(ratio) * static_cast<double>(resolution.num) / static_cast<double>(resolution.den);
}

} // namespace scansion::exact
