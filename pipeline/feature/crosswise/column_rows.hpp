// The rows around one row of columns, laid out for walks up and down a column.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/fit/steps.hpp"

#include <cstdint>
#include <vector>

namespace scansion {

struct ColumnRow {
  double c = 0.0;                ///< mm
  const float* height = nullptr; ///< of each column; not a number: none
  const float* bend = nullptr;   ///< over the least window
  const float* wide = nullptr;   ///< over the wide one
};

/// Rows are counted from the oldest one. Points into rows that belong to someone else. Thread-bound.
class ColumnRows {
public:
  /// What a wall is from now on.
  void set_test(const WallTest& test) noexcept { test_ = test; }
  void add(const ColumnRow& row);
  /// What is known of a row that was added.
  void set(std::int64_t row, const ColumnRow& now) noexcept { rows_[static_cast<std::size_t>(row)] = now; }
  void drop_oldest();
  void clear() noexcept;
  [[nodiscard]] std::int64_t size() const noexcept { return static_cast<std::int64_t>(rows_.size()); }
  [[nodiscard]] const ColumnRow& operator[](std::int64_t row) const noexcept { return rows_[static_cast<std::size_t>(row)]; }
  [[nodiscard]] std::span<const double> places() const noexcept { return places_; } ///< c of each row
  [[nodiscard]] std::span<const float* const> heights() const noexcept { return heights_; }

  /// Whether the interval from this row to the next one is a steep one of a wall that is a step.
  [[nodiscard]] bool is_of_step(std::int64_t row, std::size_t column) const {
    return std::abs(rise(row, column)) > test_.steep_rise(run(row)) && is_of_wall(row, column);
  }
  /// Whether it is the first of a wall that is a step; asked of intervals that rise or fall.
  [[nodiscard]] bool starts_step(std::int64_t row, std::size_t column) const;

private:
  [[nodiscard]] bool has(std::int64_t row) const noexcept { return row >= 0 && row + 1 < size(); }
  [[nodiscard]] double run(std::int64_t row) const noexcept { return (*this)[row + 1].c - (*this)[row].c; }
  [[nodiscard]] double rise(std::int64_t row, std::size_t column) const noexcept {
    return static_cast<double>((*this)[row + 1].height[column]) - static_cast<double>((*this)[row].height[column]);
  }
  [[nodiscard]] double mean_rise(std::int64_t low, std::int64_t high, std::size_t column) const noexcept;
  [[nodiscard]] double rise_if_any(std::int64_t row, std::size_t column) const noexcept;
  [[nodiscard]] bool grows(std::int64_t row, std::size_t column, bool rising) const noexcept;
  [[nodiscard]] bool is_of_wall(std::int64_t row, std::size_t column) const;
  [[nodiscard]] bool is_step(std::int64_t low, std::int64_t high, std::size_t column) const;

  WallTest test_{FitScale{}};
  std::vector<ColumnRow> rows_;
  std::vector<double> places_;
  std::vector<const float*> heights_;
};

/// One column around a row, without its holes. Points into the rows it was taken from. Thread-bound.
class Column {
public:
  void take(const ColumnRows& rows, std::int64_t row, std::int64_t reach, std::size_t column, double base);
  [[nodiscard]] Heights heights() const noexcept { return {s_, w_}; }
  [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(w_.size()); }
  /// The sample of a row, or the first one beyond it.
  [[nodiscard]] std::uint32_t index(std::int64_t row) const noexcept {
    const auto at = static_cast<std::uint32_t>(row - first_);
    return index_.empty() ? at : index_[at];
  }

private:
  void leave_out_holes();

  std::int64_t first_ = 0; // row
  std::span<const double> s_;
  std::vector<double> w_, places_;
  std::vector<std::uint32_t> index_; // of each row; empty: there are no holes
};

} // namespace scansion
