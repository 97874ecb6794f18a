// Walls of a column that seed themselves and grow, as in steps.cpp, but row by row.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/column_rows.hpp"

#include <limits>

namespace scansion {

// Not a number: one of the two rows has no height there.
double ColumnRows::rise_if_any(std::int64_t row, std::size_t column) const noexcept {
  return has(row) ? rise(row, column) : std::numeric_limits<double>::quiet_NaN();
}

// Whether a wall that rises or falls goes on from this row to the next one.
bool ColumnRows::grows(std::int64_t row, std::size_t column, bool rising, const WallTest& test) const noexcept {
  return has(row) && test.grows(run(row), rise(row, column), rising);
}

// Whether a wall that seeds itself between rows low and high is a step, and no slope with samples enough.
bool ColumnRows::is_step(std::int64_t low, std::int64_t high, std::size_t column, const WallTest& test) const {
  if (high - low <= static_cast<std::int64_t>(kMostIntervals)) return true;
  if (high - low > static_cast<std::int64_t>(kMostRounded)) return false;
  std::int64_t steepest = low;
  for (std::int64_t k = low + 1; k < high; ++k)
    if (std::abs(rise(k, column)) > std::abs(rise(steepest, column))) steepest = k;
  return test.is_upright(run(steepest), rise(steepest, column), rise_if_any(steepest - 1, column),
                         rise_if_any(steepest + 1, column));
}

bool ColumnRows::starts_step(std::int64_t row, std::size_t column, const WallTest& test) const {
  const bool rising = rise(row, column) > 0.0;
  if (grows(row - 1, column, rising, test)) return false;
  bool seeded = false;
  std::int64_t k = row;
  do {
    seeded = seeded || test.seeds(run(k), rise(k, column), rise_if_any(k - 1, column), rise_if_any(k + 1, column));
    ++k;
  } while (grows(k, column, rising, test) && k - row <= static_cast<std::int64_t>(kMostRounded));
  return seeded && is_step(row, k, column, test);
}

bool ColumnRows::is_of_wall(std::int64_t row, std::size_t column, const WallTest& test) const {
  const bool rising = rise(row, column) > 0.0;
  std::int64_t low = row, high = row + 1;
  const auto few = [&] { return high - low <= static_cast<std::int64_t>(kMostRounded); };
  while (few() && grows(low - 1, column, rising, test)) --low;
  while (few() && grows(high, column, rising, test)) ++high;
  return is_step(low, high, column, test);
}

} // namespace scansion
