// What encoder and decoder of a group both know at a given moment, so that both predict the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/line_table.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scansion {

/// Index of a point in its group.
using PointIndex = std::uint32_t;

/// Coordinates of a group in steps of its axis scales, and the polyline of the levels coded so far.
struct GroupState {
  std::array<std::vector<std::int32_t>, 3> u;     ///< steps; meaningful where width <= the level being coded
  std::array<std::vector<std::int32_t>, 3> chord; ///< per point: the polyline of the known vertices, at that index
  std::vector<PointIndex> known;                  ///< points of all coarser levels, ascending
  std::vector<PointIndex> fresh;                  ///< points of the level being coded, ascending

  void reset(std::size_t points) {
    for (auto& axis : u) axis.assign(points, 0);
    for (auto& axis : chord) axis.assign(points, 0);
    known.clear();
    fresh.clear();
  }
  /// known := known + fresh, fresh := empty.
  void merge_fresh();

private:
  std::vector<PointIndex> merged_;
};

/// Value at index i of the straight line from (a, va) to (b, vb), rounded down; a < b.
[[nodiscard]] inline std::int64_t between(std::int64_t va, std::int64_t vb, std::int64_t i, std::int64_t a,
                                          std::int64_t b) noexcept {
  const std::int64_t product = (vb - va) * (i - a);
  const std::int64_t length = b - a;
  const std::int64_t quotient = product / length;
  return va + quotient - (product % length < 0 ? 1 : 0);
}

/// Writes the polyline through the values at `vertices` (first and last point of the run among them) into `chord`.
void fill_chord(std::span<const PointIndex> vertices, std::span<const std::int32_t> u, std::span<std::int32_t> chord) noexcept;

} // namespace scansion
