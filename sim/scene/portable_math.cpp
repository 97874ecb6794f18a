// Elementary functions that give the same bits on every machine.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/portable_math.hpp"

#include <bit>
#include <cmath>

namespace scansion {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Taylor series up to r^15; |r| <= pi/2 leaves 6e-12.
double sin_series(double r) noexcept {
  const double q = r * r;
  double sum = -1.0 / 1307674368000.0;
  sum = sum * q + 1.0 / 6227020800.0;
  sum = sum * q - 1.0 / 39916800.0;
  sum = sum * q + 1.0 / 362880.0;
  sum = sum * q - 1.0 / 5040.0;
  sum = sum * q + 1.0 / 120.0;
  sum = sum * q - 1.0 / 6.0;
  return r + r * q * sum;
}

} // namespace

double portable_sin(double radians) noexcept {
  const double turns = std::floor(radians / kPi + 0.5);
  const double value = sin_series(radians - turns * kPi);
  const bool odd = turns - 2.0 * std::floor(turns / 2.0) > 0.5;
  return odd ? -value : value;
}

SinCos portable_sincos_degrees(double degrees) noexcept {
  const double quarter = std::floor(degrees / 90.0 + 0.5);
  const double rest = (degrees - 90.0 * quarter) * (kPi / 180.0);
  const double s = sin_series(rest);
  const double half = sin_series(rest / 2.0);
  const double c = 1.0 - 2.0 * half * half;
  switch (static_cast<int>(quarter - 4.0 * std::floor(quarter / 4.0))) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

double portable_log(double value) noexcept {
  constexpr double kLn2 = 0.69314718055994530942;
  constexpr double kSqrtHalf = 0.70710678118654752440;
  const auto bits = std::bit_cast<std::uint64_t>(value);
  auto exponent = static_cast<std::int64_t>((bits >> 52U) & 0x7ffU) - 1022;
  auto mantissa = std::bit_cast<double>((bits & 0x000fffffffffffffULL) | 0x3fe0000000000000ULL); // [0.5, 1)
  if (mantissa < kSqrtHalf) {
    mantissa *= 2.0;
    --exponent;
  }
  // log m = 2 atanh(s), |s| <= 0.1716: eight terms leave 4e-15.
  const double s = (mantissa - 1.0) / (mantissa + 1.0);
  const double q = s * s;
  double sum = 1.0 / 17.0;
  for (int k = 15; k >= 1; k -= 2) sum = sum * q + 1.0 / static_cast<double>(k);
  return static_cast<double>(exponent) * kLn2 + 2.0 * s * sum;
}

double portable_exp_minus(double value) noexcept {
  if (value > 700.0) return 0.0;
  const double x = -value / 1024.0; // |x| < 0.69: twelve terms leave 1e-15
  double sum = 1.0;
  for (int k = 13; k >= 1; --k) sum = 1.0 + sum * x / static_cast<double>(k);
  for (int k = 0; k < 10; ++k) sum *= sum;
  return sum;
}

std::int64_t round_half_up(double value) noexcept {
  return static_cast<std::int64_t>(std::floor(value + 0.5));
}

} // namespace scansion
