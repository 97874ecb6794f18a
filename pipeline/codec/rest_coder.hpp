// Coordinates of the points that are in no level, predicted from the polyline, the points to the left and the line before
// (docs/FORMAT.md, "Rest").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/group_state.hpp"

#include <cstdlib>

namespace scansion {

/// How one axis is predicted in the rest; stored in the payload.
enum class RestMode : std::uint8_t {
  fitted = 0, ///< chord + weighted deviations of neighbours from their chords
  left = 1,   ///< the value of the point before
  slope = 2,  ///< straight on from the two points before
  above = 3,  ///< the value of the point beside it in the line before
};
inline constexpr std::size_t kRestModes = 4;

/// Deviations from the chord that the fitted mode weighs: four points to the left, three beside it in the line before.
inline constexpr std::size_t kNeighbours = 7;
inline constexpr int kWeightBits = 12;
using Weights = std::array<std::int16_t, kNeighbours>; ///< in units of 2^-kWeightBits

struct RestPlace {
  PointIndex point = 0;
  PointIndex run_first = 0;
  bool has_above = false;
  PointIndex above = 0; ///< the point beside this one in the line before, and that line's points
  PointIndex above_first = 0, above_last = 0;
};

using Deviations = std::array<std::int64_t, kNeighbours>;

[[nodiscard]] inline Deviations deviations(const GroupState& s, std::size_t axis, const RestPlace& at) noexcept {
  const auto& u = s.u[axis];
  const auto& chord = s.chord[axis];
  Deviations d{};
  for (std::size_t k = 0; k < 4; ++k) {
    if (at.point < at.run_first + k + 1) break;
    const std::size_t i = at.point - k - 1;
    d[k] = std::int64_t{u[i]} - chord[i];
  }
  if (!at.has_above) return d;
  const auto off = [&](PointIndex i) { return std::int64_t{u[i]} - chord[i]; };
  d[4] = off(at.above);
  if (at.above < at.above_last) d[5] = off(at.above + 1);
  if (at.above > at.above_first) d[6] = off(at.above - 1);
  return d;
}

[[nodiscard]] inline std::int64_t predict(const GroupState& s, std::size_t axis, RestMode mode, const Weights& weights,
                                          const RestPlace& at) noexcept {
  const auto& u = s.u[axis];
  // A run's first and last points are never in the rest, so there is always a point to the left.
  switch (mode) {
    case RestMode::left: return u[at.point - 1];
    case RestMode::slope:
      return at.point >= at.run_first + 2 ? 2 * std::int64_t{u[at.point - 1]} - u[at.point - 2] : u[at.point - 1];
    case RestMode::above: return at.has_above ? u[at.above] : s.chord[axis][at.point];
    case RestMode::fitted: break;
  }
  const Deviations d = deviations(s, axis, at);
  std::int64_t sum = std::int64_t{1} << (kWeightBits - 1);
  for (std::size_t k = 0; k < kNeighbours; ++k) sum += d[k] * weights[k];
  return s.chord[axis][at.point] + (sum >> kWeightBits);
}

/// Visits the points of `state.fresh` (the rest) in order, each with the point beside it in the line before: the one whose
/// chord is nearest on `main_axis`, found by walking from the last one. `code(place)` must make u[axis][place.point] true.
template <class Code>
void visit_rest(const GroupState& s, const LineGroup& group, std::size_t main_axis, Code&& code) {
  constexpr int kMaxWalk = 8; // points a step: bounds the work on hostile or folded lines
  const auto& main = s.chord[main_axis];
  std::size_t f = 0;
  PointIndex above_first = 0;
  PointIndex above_end = 0;
  for (const ScanLine& line : group.lines) {
    PointIndex beside = above_first;
    const auto runs = group.runs_of(line);
    for (const Run& run : runs) {
      for (; f < s.fresh.size() && s.fresh[f] < run.first + run.count; ++f) {
        RestPlace at{s.fresh[f], run.first, above_first < above_end, 0, above_first, 0};
        if (at.has_above) {
          at.above_last = above_end - 1;
          const std::int64_t here = main[at.point];
          const auto away = [&](PointIndex i) { return std::abs(here - main[i]); };
          for (int walk = 0; walk < kMaxWalk && beside < at.above_last && away(beside + 1) <= away(beside); ++walk) ++beside;
          for (int walk = 0; walk < kMaxWalk && beside > above_first && away(beside - 1) < away(beside); ++walk) --beside;
          at.above = beside;
        }
        code(at);
      }
    }
    if (runs.empty()) continue;
    above_first = runs.front().first;
    above_end = runs.back().first + runs.back().count;
  }
}

} // namespace scansion
