// Numbers to counts on a chosen lattice.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/quantizer.hpp"

#include "pipeline/import/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {

double max_value(Unit unit) noexcept {
  return kMaxMillimetres / millimetres(unit).value();
}

Quantizer::Quantizer(const Lattice& lattice, double resolution_mm, bool rounds)
    : lattice_(lattice), resolution_mm_(resolution_mm), rounds_(rounds) {
  const double farthest = std::min(std::floor(kMaxMillimetres / resolution_mm), 0x1p62);
  const auto limit = static_cast<std::int64_t>(farthest);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    least_[axis] = std::max(lattice.origin[axis] + std::numeric_limits<std::int32_t>::min(), -limit);
    most_[axis] = std::min(lattice.origin[axis] + std::numeric_limits<std::int32_t>::max(), limit);
  }
  per_unit_ = 1.0 / lattice.resolution.value();
  if (!rounds && !lattice.exact)
    while (decimals_ < kMaxDigits && kPowersOfTen[static_cast<std::size_t>(decimals_)] < lattice.resolution.den) ++decimals_;
}

bool Quantizer::place(const Number& number, std::size_t axis, std::int32_t& count, std::int64_t& ulp) noexcept {
  std::int64_t total = 0;
  if (!(lattice_.exact ? exact_total_of(number, total, ulp) : total_of(number, total))) return false;
  if (total < least_[axis] || total > most_[axis]) return false;
  count = static_cast<std::int32_t>(total - lattice_.origin[axis]);
  return true;
}

bool Quantizer::total_of(const Number& number, std::int64_t& total) noexcept {
  const bool decimal = number.kind == NumberKind::decimal;
  if (decimal ? lattice_.source == Source::float32 : lattice_.source == Source::decimal) return false;
  if (number.kind == NumberKind::float64 && lattice_.source == Source::float32) return false;
  if (rounds_) {
    const auto rounded = round_to(number, lattice_.resolution);
    if (!rounded) return false;
    rounding_ = std::max(rounding_, rounded->error);
    total = rounded->total;
    return true;
  }
  if (decimal) return scale(number.mantissa, decimals_ + number.exponent, total) == Scaled::ok;
  const auto found = count_with_bits(number, lattice_, decimals_);
  total = found.value_or(0);
  return found.has_value();
}

bool Quantizer::exact_total_of(const Number& number, std::int64_t& total, std::int64_t& ulp) const noexcept {
  double value = to_double(number);
  if (lattice_.source == Source::float32 && number.kind != NumberKind::float32) {
    const auto single = number.kind == NumberKind::decimal ? as_single(number) : std::nullopt;
    if (!single) return false;
    value = static_cast<double>(*single);
  }
  const double counts = value * per_unit_;
  if (!(std::fabs(counts) < 0x1p62)) return false;
  total = std::llround(counts);
  ulp = ulps_between(lattice_.source, lattice_value(lattice_, total), value);
  return true;
}

} // namespace scansion
