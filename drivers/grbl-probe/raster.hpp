// Where the tip goes: the grid of a raster, the order of its points, and how high it must be lifted between two of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <cstdint>
#include <vector>

namespace scansion::grbl {

/// Micrometres in machine coordinates.
using Um = std::int64_t;

/// All in mm, as configured.
struct RasterArea {
  double x_from = 0, x_to = 0, y_from = 0, y_to = 0;
  double pitch = 1;   ///< from point to point of a row
  double spacing = 1; ///< from row to row
  double top = 0;     ///< the tip touches nothing at this height, wherever it is
  double bottom = 0;  ///< the tip never goes lower
  double clearance = 1;
  bool serpentine = true; ///< odd rows are probed backwards
};

/// Rows lie along x, one above the other in y. Values only.
class Raster {
public:
  static constexpr std::uint64_t kMostPoints = 1'000'000; ///< 20 MB of contacts and heights

  /// Fails with config when the area makes no raster.
  [[nodiscard]] static Result<Raster> create(const RasterArea& area);

  [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }
  [[nodiscard]] std::uint32_t columns() const noexcept { return columns_; }
  [[nodiscard]] Um x(std::uint32_t column) const noexcept;
  [[nodiscard]] Um y(std::uint32_t row) const noexcept;
  [[nodiscard]] Um top() const noexcept { return top_; }
  [[nodiscard]] Um bottom() const noexcept { return bottom_; }
  [[nodiscard]] Um clearance() const noexcept { return clearance_; }
  /// The column that is probed as the `step`-th of its row.
  [[nodiscard]] std::uint32_t column(std::uint32_t row, std::uint32_t step) const noexcept {
    return is_backward(row) ? columns_ - 1 - step : step;
  }
  [[nodiscard]] bool is_backward(std::uint32_t row) const noexcept { return serpentine_ && row % 2 == 1; }

private:
  double x_from_ = 0, y_from_ = 0, pitch_ = 0, spacing_ = 0;
  Um top_ = 0, bottom_ = 0, clearance_ = 0;
  std::uint32_t rows_ = 0, columns_ = 0;
  bool serpentine_ = true;
};

/// Surface heights met so far, and the lift they ask for.
class HeightMap {
public:
  explicit HeightMap(const Raster& raster);

  void put(std::uint32_t row, std::uint32_t column, Um z) noexcept;
  /// Height the tip must have to go straight from `column` to `target` of `row` (the last row's end stands above or below
  /// `column` when a row begins): clearance above the highest point known near the way, never above the top. The top itself
  /// when nothing is known near the target.
  [[nodiscard]] Um safe_height(std::uint32_t row, std::uint32_t column, std::uint32_t target) const noexcept;

private:
  static constexpr std::uint32_t kNear = 2; ///< rows and columns beside the way that count as near

  const Raster* raster_;
  std::vector<std::int32_t> heights_; ///< um, row after row
};

} // namespace scansion::grbl
