// Finding a lattice on which all values of an input have a place.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/survey.hpp"

#include "pipeline/import/quantizer.hpp"
#include "pipeline/import/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {
namespace {

constexpr int kMaxDecimals = 15; ///< 10^15 is the last power of ten below 2^53

std::uint8_t bit_of(NumberKind kind) noexcept {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(kind));
}

Source source_of(std::uint8_t kinds) noexcept {
  if (kinds == bit_of(NumberKind::decimal)) return Source::decimal;
  if (kinds == bit_of(NumberKind::float32)) return Source::float32;
  return Source::float64;
}

std::uint64_t span_of(std::int64_t least, std::int64_t most) noexcept {
  return static_cast<std::uint64_t>(most) - static_cast<std::uint64_t>(least);
}

/// Zero when all totals then fit 32 bits, else the middle.
std::int64_t origin_of(std::int64_t least, std::int64_t most) noexcept {
  using Limits = std::numeric_limits<std::int32_t>;
  if (least >= Limits::min() && most <= Limits::max()) return 0;
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(least) + (span_of(least, most) + 1) / 2);
}

Rational power_of_two(int exponent) noexcept {
  const std::int64_t power = std::int64_t{1} << static_cast<unsigned>(exponent < 0 ? -exponent : exponent);
  return exponent < 0 ? Rational{1, power} : Rational{power, 1};
}

} // namespace

Survey::Survey(const ImportOptions& options)
    : options_(options), farthest_(max_value(options.unit)),
      mode_(std::holds_alternative<ResolutionGiven>(options.resolution)
                ? Mode::given
                : (std::holds_alternative<ResolutionExact>(options.resolution) ? Mode::bits : Mode::decimals)) {}

Survey::Verdict Survey::add(const Number& number, std::size_t axis) noexcept {
  if (!(std::fabs(to_double(number)) <= farthest_)) return Verdict::too_far;
  kinds_ = static_cast<std::uint8_t>(kinds_ | bit_of(number.kind));
  if (mode_ == Mode::given) {
    const auto rounded = round_to(number, std::get<ResolutionGiven>(options_.resolution).input_units);
    if (!rounded) return Verdict::too_fine;
    add_total(rounded->total, axis);
    return Verdict::ok;
  }
  if (mode_ == Mode::decimals) number.kind == NumberKind::decimal ? add_decimal(number, axis) : add_ieee(number, axis);
  // Either adding may have given the decimals up.
  if (mode_ == Mode::bits) add_bits(to_double(number), axis);
  return Verdict::ok;
}

void Survey::add_decimal(const Number& number, std::size_t axis) noexcept {
  if (-number.exponent > decimals_) refine(decimals_of(number));
  if (mode_ != Mode::decimals) return;
  std::int64_t total = 0;
  if (scale(number.mantissa, decimals_ + number.exponent, total) != Scaled::ok) return give_up_decimals();
  add_total(total, axis);
}

void Survey::add_ieee(const Number& number, std::size_t axis) noexcept {
  Lattice lattice = base();
  lattice.source = number.kind == NumberKind::float32 ? Source::float32 : Source::float64;
  lattice.resolution = {1, kPowersOfTen[static_cast<std::size_t>(decimals_)]};
  auto total = count_with_bits(number, lattice, decimals_);
  if (!total) {
    const double value = number.bits_value();
    if (value == 0.0) return give_up_decimals(); // -0.0
    refine(decimals_of(shortest_decimal(number)));
    if (mode_ != Mode::decimals) return;
    lattice.resolution = {1, kPowersOfTen[static_cast<std::size_t>(decimals_)]};
    total = count_with_bits(number, lattice, decimals_);
    if (!total) return give_up_decimals();
  }
  add_total(*total, axis);
}

void Survey::add_total(std::int64_t total, std::size_t axis) noexcept {
  least_[axis] = seen_[axis] ? std::min(least_[axis], total) : total;
  most_[axis] = seen_[axis] ? std::max(most_[axis], total) : total;
  seen_[axis] = true;
}

void Survey::add_bits(double value, std::size_t axis) noexcept {
  low_[axis] = seen_[axis] ? std::min(low_[axis], value) : value;
  high_[axis] = seen_[axis] ? std::max(high_[axis], value) : value;
  seen_[axis] = true;
}

void Survey::refine(int decimals) noexcept {
  if (decimals <= decimals_) return;
  if (decimals > kMaxDecimals) return give_up_decimals();
  std::array<std::int64_t, 3> least{};
  std::array<std::int64_t, 3> most{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (scale(least_[axis], decimals - decimals_, least[axis]) != Scaled::ok ||
        scale(most_[axis], decimals - decimals_, most[axis]) != Scaled::ok)
      return give_up_decimals();
  least_ = least;
  most_ = most;
  decimals_ = decimals;
}

void Survey::give_up_decimals() noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_[axis] = to_double({least_[axis], -decimals_, NumberKind::decimal});
    high_[axis] = to_double({most_[axis], -decimals_, NumberKind::decimal});
  }
  mode_ = Mode::bits;
}

Lattice Survey::base() const noexcept {
  Lattice lattice;
  lattice.unit = options_.unit;
  lattice.source = source_of(kinds_);
  return lattice;
}

Lattice Survey::choose() const {
  Lattice lattice = base();
  if (mode_ == Mode::bits) return exact();
  lattice.resolution = mode_ == Mode::given ? std::get<ResolutionGiven>(options_.resolution).input_units
                                            : Rational{1, kPowersOfTen[static_cast<std::size_t>(decimals_)]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool fits = span_of(least_[axis], most_[axis]) <= std::numeric_limits<std::uint32_t>::max();
    if (!fits && mode_ == Mode::decimals) return exact();
    lattice.origin[axis] = origin_of(least_[axis], most_[axis]);
  }
  if (mode_ == Mode::given) return lattice;
  // Singles among others have no decimals in common with them.
  const bool mixed = lattice.source == Source::float64 && (kinds_ & bit_of(NumberKind::float32)) != 0;
  return mixed || !resolution_mm(lattice) ? exact() : lattice;
}

Lattice Survey::exact() const {
  return exact(kinds_ == bit_of(NumberKind::float32) ? Source::float32 : Source::float64);
}

Lattice Survey::exact(Source source) const {
  Survey bits = *this;
  if (mode_ == Mode::decimals) bits.give_up_decimals();
  if (source == Source::float32)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bits.low_[axis] = static_cast<double>(static_cast<float>(bits.low_[axis]));
      bits.high_[axis] = static_cast<double>(static_cast<float>(bits.high_[axis]));
    }
  return exact_between(source, bits.low_, bits.high_);
}

Lattice Survey::exact_between(Source source, const std::array<double, 3>& low, const std::array<double, 3>& high) const {
  Lattice lattice = base();
  lattice.source = source;
  lattice.exact = true;
  constexpr int kFinest = -52;
  constexpr int kCoarsest = 52;
  const int digits = lattice.source == Source::float32 ? 23 : 52;
  int exponent = kFinest - 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double largest = std::max(std::fabs(low[axis]), std::fabs(high[axis]));
    const double span = high[axis] - low[axis];
    if (largest > 0.0) exponent = std::max(exponent, std::ilogb(largest) - digits);
    if (span > 0.0) {
      // A span of [2^29, 2^30) counts; rounding at both ends adds up to two.
      const int finest = std::ilogb(span) - 29;
      exponent = std::max(exponent, std::ldexp(span, -finest) > 0x1p30 - 4 ? finest + 1 : finest);
    }
  }
  const bool all_zero = exponent < kFinest && low == std::array<double, 3>{} && high == low;
  exponent = all_zero ? 0 : std::clamp(exponent, kFinest, kCoarsest);
  lattice.resolution = power_of_two(exponent);
  while (exponent < kCoarsest && !resolution_mm(lattice)) lattice.resolution = power_of_two(++exponent);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double resolution = lattice.resolution.value();
    lattice.origin[axis] = origin_of(std::llround(low[axis] / resolution), std::llround(high[axis] / resolution));
  }
  return lattice;
}

bool Survey::only_decimals() const noexcept {
  return kinds_ == bit_of(NumberKind::decimal);
}

} // namespace scansion
