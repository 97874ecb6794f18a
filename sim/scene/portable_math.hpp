// Elementary functions that give the same bits on every machine: nothing but IEEE + - * / and sqrt.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace scansion {

struct SinCos {
  double sin = 0.0, cos = 1.0;
};

/// Sine of `radians`, error below 1e-11 for |radians| up to 1e4.
[[nodiscard]] double portable_sin(double radians) noexcept;

/// Sine and cosine of an angle in degrees; multiples of 90 degrees give exact 0 and 1.
[[nodiscard]] SinCos portable_sincos_degrees(double degrees) noexcept;

/// Natural logarithm of a positive, normal `value`, relative error below 1e-13.
[[nodiscard]] double portable_log(double value) noexcept;

/// e to the power -`value`, for value >= 0, relative error below 1e-10.
[[nodiscard]] double portable_exp_minus(double value) noexcept;

/// The nearest whole number, halves upwards. |value| stays below 2^51.
[[nodiscard]] std::int64_t round_half_up(double value) noexcept;

} // namespace scansion
