// Walls of a column that seed themselves and grow, as in steps.cpp, but row by row.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/crosswise/column_rows.hpp"

#include "pipeline/feature/fit/pair.hpp"
#include "pipeline/feature/passes/fastest.hpp"

#include <algorithm>
#include <limits>

namespace scansion {

namespace {

using FloatPair = float __attribute__((vector_size(2 * sizeof(float))));

} // namespace

void ColumnRows::add(const ColumnRow& row) {
  rows_.push_back(row);
  places_.push_back(row.c);
  heights_.push_back(row.height);
}

void ColumnRows::drop_oldest() {
  rows_.erase(rows_.begin());
  places_.erase(places_.begin());
  heights_.erase(heights_.begin());
}

void ColumnRows::clear() noexcept {
  rows_.clear();
  places_.clear();
  heights_.clear();
}

// Not a number: one of the two rows has no height there.
double ColumnRows::rise_if_any(std::int64_t row, std::size_t column) const noexcept {
  return has(row) ? rise(row, column) : std::numeric_limits<double>::quiet_NaN();
}

// Whether a wall that rises or falls goes on from this row to the next one.
bool ColumnRows::grows(std::int64_t row, std::size_t column, bool rising) const noexcept {
  return has(row) && test_.grows(run(row), rise(row, column), rising);
}

// Mean rise of an interval between two rows; not a number: there is none.
double ColumnRows::mean_rise(std::int64_t low, std::int64_t high, std::size_t column) const noexcept {
  if (low < 0 || high >= size()) return std::numeric_limits<double>::quiet_NaN();
  const double rise = static_cast<double>((*this)[high].height[column]) - static_cast<double>((*this)[low].height[column]);
  return rise / static_cast<double>(high - low);
}

// Whether a wall that seeds itself between rows low and high is a step, and no slope with samples enough.
bool ColumnRows::is_step(std::int64_t low, std::int64_t high, std::size_t column) const {
  if (high - low <= static_cast<std::int64_t>(kMostIntervals)) {
    constexpr std::int64_t n = WallTest::kBeside;
    const double ds =
        (places_[static_cast<std::size_t>(high)] - places_[static_cast<std::size_t>(low)]) / static_cast<double>(high - low);
    return !test_.is_piece(ds, mean_rise(low, high, column), mean_rise(low - n, low, column),
                           mean_rise(high, high + n, column));
  }
  if (high - low > static_cast<std::int64_t>(kMostRounded)) return false;
  std::int64_t steepest = low;
  for (std::int64_t k = low + 1; k < high; ++k)
    if (std::abs(rise(k, column)) > std::abs(rise(steepest, column))) steepest = k;
  return test_.is_upright(run(steepest), rise(steepest, column), rise_if_any(steepest - 1, column),
                          rise_if_any(steepest + 1, column));
}

bool ColumnRows::starts_step(std::int64_t row, std::size_t column) const {
  const bool rising = rise(row, column) > 0.0;
  if (grows(row - 1, column, rising)) return false;
  bool seeded = false;
  std::int64_t k = row;
  do {
    seeded = seeded || (test_.may_seed(run(k), rise(k, column)) &&
                        test_.stands_out(run(k), rise(k, column), rise_if_any(k - 1, column), rise_if_any(k + 1, column)));
    ++k;
  } while (grows(k, column, rising) && k - row <= static_cast<std::int64_t>(kMostRounded));
  return seeded && is_step(row, k, column);
}

// Of a steep interval: whether the wall that it starts is a step.
bool ColumnRows::is_of_wall(std::int64_t row, std::size_t column) const {
  const double dw = rise(row, column);
  std::int64_t low = row, high = row + 1;
  const auto few = [&] { return high - low <= static_cast<std::int64_t>(kMostRounded); };
  while (few() && grows(low - 1, column, dw > 0.0)) --low;
  while (few() && grows(high, column, dw > 0.0)) ++high;
  return is_step(low, high, column);
}

namespace {

// The heights of one column into `w`, above `base`; returns their sum, which is no number if there are holes.
double gather(const float* const* from, std::size_t column, double base, double* w, std::size_t n) {
  Pair sum{};
  std::size_t k = 0;
  for (; k + 2 <= n; k += 2) {
    const Pair pair = __builtin_convertvector(FloatPair{from[k][column], from[k + 1][column]}, Pair) + base;
    w[k] = pair[0];
    w[k + 1] = pair[1];
    sum += pair;
  }
  for (; k < n; ++k) sum[0] += w[k] = static_cast<double>(from[k][column]) + base;
  return sum[0] + sum[1];
}

} // namespace

void Column::take(const ColumnRows& rows, std::int64_t row, std::int64_t reach, std::size_t column, double base) {
  first_ = std::max<std::int64_t>(0, row - reach);
  const auto n = static_cast<std::size_t>(std::min(rows.size() - 1, row + reach) - first_ + 1);
  w_.resize(n);
  const auto from = rows.heights().subspan(static_cast<std::size_t>(first_), n);
  const double sum = passes::fastest<gather>(from.data(), column, base, w_.data(), n);
  s_ = rows.places().subspan(static_cast<std::size_t>(first_), n);
  index_.clear();
  if (std::isnan(sum)) leave_out_holes();
}

void Column::leave_out_holes() {
  places_.clear();
  for (std::size_t k = 0; k < w_.size(); ++k) {
    const std::size_t kept = places_.size();
    index_.push_back(static_cast<std::uint32_t>(kept));
    if (std::isnan(w_[k])) continue;
    places_.push_back(s_[k]);
    w_[kept] = w_[k];
  }
  w_.resize(places_.size());
  s_ = places_;
}

} // namespace scansion
