// Numbers to counts on a chosen lattice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/number.hpp"
#include "pipeline/model/lattice.hpp"

namespace scansion {

/// No coordinate may lie farther out: beyond that a unit is wrong or the file is damaged.
inline constexpr double kMaxMillimetres = 1e12;
[[nodiscard]] double max_value(Unit unit) noexcept; ///< the same in `unit`

class Quantizer {
public:
  Quantizer() = default;
  /// `rounds`: values may lie between lattice points (a resolution was given).
  Quantizer(const Lattice& lattice, double resolution_mm, bool rounds);

  /// The count of a valid number, and in an exact lattice its distance in units of least precision. False when it has no place.
  [[nodiscard]] bool place(const Number& number, std::size_t axis, std::int32_t& count, std::int64_t& ulp) noexcept;
  [[nodiscard]] double rounding_mm() const noexcept { return rounding_ * resolution_mm_; }

private:
  [[nodiscard]] bool total_of(const Number& number, std::int64_t& total) noexcept;
  [[nodiscard]] bool exact_total_of(const Number& number, std::int64_t& total, std::int64_t& ulp) const noexcept;

  Lattice lattice_;
  double resolution_mm_ = 1.0;
  bool rounds_ = false;
  int decimals_ = 0;                             ///< resolution is 10^-decimals_, unless rounds_ or exact
  double per_unit_ = 1.0;                        ///< counts in one input unit, a power of two; exact only
  double rounding_ = 0.0;                        ///< largest, counts
  std::array<std::int64_t, 3> least_{}, most_{}; ///< totals
};

} // namespace scansion
