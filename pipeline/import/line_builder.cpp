// Samples on the lattice to a scan line with runs.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/line_builder.hpp"

#include "pipeline/import/number.hpp"

#include <algorithm>

namespace scansion {
namespace {

__extension__ using int128 = __int128;

/// The limit in counts, from the decimal that the caller wrote: a step of exactly that length must not count as longer.
long double gap_in_counts(double gap_mm, Rational resolution_mm) {
  const Number gap = shortest_decimal(Number::ieee(NumberKind::float64, gap_mm));
  long double counts = static_cast<long double>(gap.mantissa) * static_cast<long double>(resolution_mm.den);
  long double divisor = static_cast<long double>(resolution_mm.num);
  for (int e = gap.exponent; e > 0; --e) counts *= 10;
  for (int e = gap.exponent; e < 0; ++e) divisor *= 10;
  return counts / divisor;
}

} // namespace

LineBuilder::LineBuilder(bool exact, std::optional<double> gap_mm, Rational resolution_mm) : exact_(exact) {
  if (!gap_mm) return;
  const long double gap = gap_in_counts(*gap_mm, resolution_mm);
  gap_squared_ = gap * gap;
}

void LineBuilder::begin(LineBuffer& line) noexcept {
  line.clear();
  line_ = &line;
  samples_ = 0;
  invalid_ = 0;
  run_open_ = false;
}

LineBuilder::Added LineBuilder::add(const std::array<std::int32_t, 3>& counts, const std::array<std::int64_t, 3>& ulps) {
  if (samples_ == kMaxLinePoints) return Added::line_too_long;
  if (run_open_ && gap_squared_ && is_gap(counts)) run_open_ = false;
  if (!run_open_) start_run();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    line_->xyz[axis].push_back(counts[axis]);
    if (exact_) line_->ulp[axis].push_back(ulps[axis]);
  }
  last_ = counts;
  ++line_->runs.back().count;
  ++samples_;
  return Added::ok;
}

void LineBuilder::start_run() {
  line_->runs.push_back(Run{.first = static_cast<std::uint32_t>(line_->points()), .count = 0, .invalid_before = invalid_});
  invalid_ = 0;
  run_open_ = true;
}

bool LineBuilder::is_gap(const std::array<std::int32_t, 3>& counts) const noexcept {
  int128 squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t step = std::int64_t{counts[axis]} - last_[axis];
    squared += static_cast<int128>(step) * step;
  }
  return static_cast<long double>(squared) > *gap_squared_;
}

LineBuilder::Added LineBuilder::add_invalid() noexcept {
  if (samples_ == kMaxLinePoints) return Added::line_too_long;
  run_open_ = false;
  ++invalid_;
  ++samples_;
  return Added::ok;
}

void LineBuilder::finish() noexcept {
  line_->invalid_after = invalid_;
}

} // namespace scansion
