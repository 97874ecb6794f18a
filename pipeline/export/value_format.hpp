// Lattice points as numbers of an output unit: exact decimals wherever the value has one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"

#include <cstdint>

namespace scansion {

/// Turns counts into text and doubles of one output unit. Reentrant.
class ValueFormat {
public:
  static constexpr std::size_t kMaxText = 48; ///< characters of one value

  /// `single`: values are rounded to IEEE single precision first.
  [[nodiscard]] static Result<ValueFormat> make(const Lattice& lattice, Unit unit, bool single);

  /// The value as double; exact lattices give back the very bits of the source.
  [[nodiscard]] double value(std::size_t axis, std::int32_t count, std::int64_t ulp) const noexcept;
  /// Writes the shortest text that is exactly the value: a decimal where the lattice is decimal in this unit, else the shortest
  /// decimal that reads back as the same double (or single). Returns the end.
  [[nodiscard]] char* write(char* to, std::size_t axis, std::int32_t count, std::int64_t ulp) const noexcept;

private:
  Lattice lattice_;
  Rational unit_change_{1, 1}; ///< output units per input unit
  bool decimal_ = false;       ///< value = total * multiplier_ / 10^digits_
  bool single_ = false;
  std::int64_t multiplier_ = 1;
  unsigned digits_ = 0;
};

} // namespace scansion
