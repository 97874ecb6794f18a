// The integer lattice all points live on: resolution, origin, units.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace scansion {

enum class Unit : std::uint8_t { m, mm, um, in, ft };

[[nodiscard]] Result<Unit> parse_unit(std::string_view text);
[[nodiscard]] std::string_view name(Unit unit) noexcept;

/// A positive fraction in lowest terms. Both parts stay below 2^53, so both are exact as doubles.
struct Rational {
  std::int64_t num = 1;
  std::int64_t den = 1;

  [[nodiscard]] double value() const noexcept { return static_cast<double>(num) / static_cast<double>(den); }
  friend bool operator==(const Rational&, const Rational&) = default;
};

/// Fails with out_of_range when a part leaves 2^53.
[[nodiscard]] Result<Rational> make_rational(std::int64_t num, std::int64_t den);
[[nodiscard]] Result<Rational> multiply(Rational a, Rational b);
/// A positive decimal such as "0.005" or "1e-3", exactly.
[[nodiscard]] Result<Rational> parse_rational(std::string_view text);
/// Millimetres in one `unit`: 1 m = 1000/1, 1 in = 127/5.
[[nodiscard]] Rational millimetres(Unit unit) noexcept;

/// What the values were before they became counts.
enum class Source : std::uint8_t {
  decimal, ///< decimal text: a count times the resolution is the value itself
  float32, ///< IEEE 754 single precision
  float64  ///< IEEE 754 double precision
};

/// Counts of one recording: coordinate = (origin + count) * resolution, in the input unit.
/// The resolution is one for all three axes.
struct Lattice {
  Rational resolution;                  ///< input units per count
  std::array<std::int64_t, 3> origin{}; ///< counts
  Unit unit = Unit::mm;                 ///< the input unit
  Source source = Source::decimal;
  bool exact = false; ///< groups carry IEEE residuals (see LineGroup::ulp), so that every bit of the source comes back

  friend bool operator==(const Lattice&, const Lattice&) = default;
};

/// Millimetres per count; fails with out_of_range when it is no fraction of two numbers below 2^53.
[[nodiscard]] Result<Rational> resolution_mm(const Lattice& lattice);

/// The value of a lattice point in the input unit: the nearest double (decimal, float64) or single (float32) of
/// total * num / den. `total` is origin + count.
[[nodiscard]] double lattice_value(const Lattice& lattice, std::int64_t total) noexcept;

/// Distance from `from` to `to` in representable values of the lattice's source type (float32 or float64), as stored in
/// LineGroup::ulp; `step_ulps` is its inverse. Infinite and NaN values are not allowed.
[[nodiscard]] std::int64_t ulps_between(Source source, double from, double to) noexcept;
[[nodiscard]] double step_ulps(Source source, double from, std::int64_t ulps) noexcept;

} // namespace scansion
