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

/// Makes room for at least so many values; what is behind those asked for is memory. Groups are of different sizes, and what
/// resize() takes away it has to clear when it gives it back.
template <class T>
void grow(std::vector<T>& values, std::size_t count) {
  if (values.size() < count) values.resize(count);
}

/// Where a run looks for points like its own: a run of the line before, and by how much indexes differ there.
struct RunAbove {
  std::uint32_t run = 0; ///< its index in the group
  PointIndex first = 0, last = 0;
  std::int64_t shift = 0;
  bool exists = false;

  [[nodiscard]] PointIndex beside(PointIndex i) const noexcept {
    const std::int64_t j = std::int64_t{i} + shift;
    return j < first ? first : j > last ? last : static_cast<PointIndex>(j);
  }
};

/// A run with its place in the line, in samples.
struct RunPlace {
  const Run* run = nullptr;
  std::int64_t first_sample = 0;
};

/// A point that a level adds.
struct Fresh {
  PointIndex point = 0;
  bool matched = false; ///< it continues a vertex of the line before
};

/// Coordinates of a group in steps of its axis scales, and the vertices of the levels coded so far.
struct GroupState {
  std::array<std::vector<std::int32_t>, 3> u; ///< steps, see axis(); meaningful where the alpha-width is not above the level
  std::size_t points = 0;                     ///< of the group
  std::vector<RunAbove> above;                ///< per run
  std::vector<PointIndex> beside;             ///< of vertices of runs with one above: the point there that is compared with it
  std::vector<PointIndex> known;              ///< vertices of all coarser levels, ascending
  std::vector<Fresh> fresh;                   ///< inner points that the level being coded adds, ascending
  std::vector<RunPlace> places_here, places_above; ///< scratch of align_runs()
  // The coarser vertices and this level's together, run by run as the positions become known.
  std::vector<PointIndex> vertices;        ///< ascending
  std::vector<std::uint8_t> added;         ///< beside each: 1 when this level adds it
  std::vector<std::uint32_t> run_vertices; ///< where each run's vertices begin, and the end of the last

  void reset(std::size_t count) {
    points = count;
    for (auto& axis : u) grow(axis, count);
    grow(beside, count);
    known.clear();
    fresh.clear();
  }
  [[nodiscard]] std::span<std::int32_t> axis(std::size_t a) noexcept { return std::span(u[a]).first(points); }
  /// Before the positions of a level are coded.
  void begin_level();
  /// When those of a run are: `fresh` and `known` reach beyond it from these indexes on.
  void end_run(const Run& run, std::size_t& f, std::size_t& k);
  /// All of that for a level without points.
  void pass_level(std::span<const Run> runs);
  /// known := vertices.
  void end_level() { known.swap(vertices); }
};

[[nodiscard]] constexpr std::int32_t wrap(std::int64_t v) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(v)));
}

/// Value at index i of the straight line from (a, va) to (b, vb), rounded down; a < b.
[[nodiscard]] inline std::int64_t between(std::int64_t va, std::int64_t vb, std::int64_t i, std::int64_t a,
                                          std::int64_t b) noexcept {
  const std::int64_t product = (vb - va) * (i - a);
  const std::int64_t length = b - a;
  const std::int64_t quotient = product / length;
  return va + quotient - (product % length < 0 ? 1 : 0);
}

/// The whole number nearest to offset / step, halves upwards; step is not 0.
[[nodiscard]] constexpr std::int64_t nearest_steps(std::int64_t offset, std::int64_t step) noexcept {
  const std::int64_t over = step < 0 ? -2 * offset - step : 2 * offset + step;
  const std::int64_t under = step < 0 ? -2 * step : 2 * step;
  return over / under - (over % under < 0 ? 1 : 0);
}

/// Finds the run above of every run: in the last line before that has points, the first run that does not end left of the
/// middle of this one, counting samples, valid or not, from the start of the line. Where an axis is even with the same step in
/// both, its values say the shift, to the nearest point.
void align_runs(const LineGroup& group, const AxisScales& scales, GroupState& state);

/// Fills an even axis between the ends of its runs.
void fill_even(std::span<const Run> runs, std::span<std::int32_t> u) noexcept;
/// The step of a run on an even axis.
[[nodiscard]] inline std::int64_t even_step(const Run& run, std::span<const std::int32_t> u) noexcept {
  if (run.count < 2) return 0;
  return (std::int64_t{u[run.first + run.count - 1]} - u[run.first]) / (run.count - 1);
}

} // namespace scansion
