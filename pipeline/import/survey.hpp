// Finding a lattice on which all values of an input have a place.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/import.hpp"
#include "pipeline/import/sample.hpp"

namespace scansion {

/// Takes valid points in any order: the lattice depends on the set of values only.
class Survey {
public:
  /// `options` outlives the survey.
  explicit Survey(const ImportOptions& options);

  enum class Verdict : std::uint8_t { ok, too_far, too_fine };
  /// too_far: beyond kMaxMillimetres; too_fine: more than 2^62 counts of the given resolution from zero.
  [[nodiscard]] Verdict add(const Number& number, std::size_t axis) noexcept;
  [[nodiscard]] bool any() const noexcept { return kinds_ != 0; }

  [[nodiscard]] Lattice choose() const;
  /// The lattice that keeps every bit of each value as IEEE.
  [[nodiscard]] Lattice exact() const;
  /// The same with all values as `source`, into which they must fit.
  [[nodiscard]] Lattice exact(Source source) const;
  [[nodiscard]] bool only_decimals() const noexcept;

private:
  enum class Mode : std::uint8_t { decimals, bits, given };

  void add_decimal(const Number& number, std::size_t axis) noexcept;
  void add_ieee(const Number& number, std::size_t axis) noexcept;
  void add_bits(double value, std::size_t axis) noexcept;
  void add_total(std::int64_t total, std::size_t axis) noexcept;
  void refine(int decimals) noexcept;
  void give_up_decimals() noexcept;
  [[nodiscard]] Lattice base() const noexcept;
  [[nodiscard]] Lattice exact_between(Source source, const std::array<double, 3>& low, const std::array<double, 3>& high) const;

  const ImportOptions& options_;
  double farthest_; ///< input units
  Mode mode_;
  std::uint8_t kinds_ = 0;                       ///< bit NumberKind: one was seen
  int decimals_ = 0;                             ///< mode decimals: totals are multiples of 10^-decimals_
  std::array<std::int64_t, 3> least_{}, most_{}; ///< totals; modes decimals and given
  std::array<double, 3> low_{}, high_{};         ///< mode bits
  std::array<bool, 3> seen_{};
};

} // namespace scansion
