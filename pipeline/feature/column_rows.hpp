// The rows around one row of columns, laid out for walks up and down a column.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/steps.hpp"

#include <cstdint>
#include <vector>

namespace scansion {

struct ColumnRow {
  double c = 0.0;                ///< mm
  const float* height = nullptr; ///< of each column; not a number: none
  const float* bend = nullptr;
};

/// Rows are counted from the oldest one. Points into rows that belong to someone else.
class ColumnRows {
public:
  void clear() noexcept { rows_.clear(); }
  void add(const ColumnRow& row) { rows_.push_back(row); }
  [[nodiscard]] std::int64_t size() const noexcept { return static_cast<std::int64_t>(rows_.size()); }
  [[nodiscard]] const ColumnRow& operator[](std::int64_t row) const noexcept { return rows_[static_cast<std::size_t>(row)]; }

  /// Whether the interval from this row to the next one is the first of a wall that is a step.
  [[nodiscard]] bool starts_step(std::int64_t row, std::size_t column, const WallTest& test) const;
  /// Whether it is a steep one of a wall that is a step.
  [[nodiscard]] bool is_of_step(std::int64_t row, std::size_t column, const WallTest& test) const {
    const double size = std::abs(rise(row, column));
    return size > test.strong && size > WallTest::kSlope * run(row) && is_of_wall(row, column, test);
  }

private:
  [[nodiscard]] bool has(std::int64_t row) const noexcept { return row >= 0 && row + 1 < size(); }
  /// From this row to the next one.
  [[nodiscard]] double run(std::int64_t row) const noexcept { return (*this)[row + 1].c - (*this)[row].c; }
  [[nodiscard]] double rise(std::int64_t row, std::size_t column) const noexcept {
    return static_cast<double>((*this)[row + 1].height[column]) - static_cast<double>((*this)[row].height[column]);
  }
  [[nodiscard]] double rise_if_any(std::int64_t row, std::size_t column) const noexcept;
  [[nodiscard]] bool grows(std::int64_t row, std::size_t column, bool rising, const WallTest& test) const noexcept;
  [[nodiscard]] bool is_of_wall(std::int64_t row, std::size_t column, const WallTest& test) const;
  [[nodiscard]] bool is_step(std::int64_t low, std::int64_t high, std::size_t column, const WallTest& test) const;

  std::vector<ColumnRow> rows_;
};

} // namespace scansion
