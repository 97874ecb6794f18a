// Coordinates of the vertices of one level, predicted from coarser levels and the line before (docs/FORMAT.md, "Level").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/group_state.hpp"

#include <algorithm>

namespace scansion {

/// How the coordinates of one axis are predicted in a level; stored in the payload.
enum class LevelMode : std::uint8_t {
  chord = 0, ///< on the chord between the known neighbours
  left = 1,  ///< the value of the left neighbour
  bend = 2,  ///< on the chord, plus what the line before bends away from its own chord over the same indexes
};
inline constexpr std::size_t kLevelModes = 3;

/// A point to be predicted, with its neighbours: `left` is known at this level, `right` at a coarser one.
struct LevelPlace {
  PointIndex point = 0;
  PointIndex left = 0;
  PointIndex right = 0;
  std::uint32_t above = 0;      ///< first point of the run before ...
  std::uint32_t above_last = 0; ///< ... and its last; above > above_last: there is none
  PointIndex run_first = 0;
};

[[nodiscard]] inline std::int64_t predict(const GroupState& s, std::size_t axis, LevelMode mode,
                                          const LevelPlace& at) noexcept {
  const auto& u = s.u[axis];
  if (mode == LevelMode::left) return u[at.left];
  const std::int64_t straight = between(u[at.left], u[at.right], at.point, at.left, at.right);
  if (mode == LevelMode::chord || at.above > at.above_last) return straight;
  const auto& chord = s.chord[axis];
  const auto over = [&](PointIndex i) { return std::min(at.above + (i - at.run_first), at.above_last); };
  const PointIndex a = over(at.left);
  const PointIndex b = over(at.right);
  const PointIndex i = over(at.point);
  if (a >= b) return straight;
  return straight + (chord[i] - between(chord[a], chord[b], i, a, b));
}

/// Visits the points of the level in coding order, for one axis. `code(place)` must make u[axis][place.point] true before it
/// returns.
/// `coarsest`: the level is lod0, so runs begin with their end points, which `code_end(point, previous)` handles:
/// `previous` is the same end of the run before, or the point itself when there is none.
/// On the way the chord of that axis over each run is brought to the level just coded; `state.known` must hold the coarser
/// vertices.
template <class Code, class CodeEnd>
void visit_level(GroupState& s, std::span<const Run> runs, std::size_t axis, bool coarsest, Code&& code, CodeEnd&& code_end) {
  std::size_t k = 0; // into known
  std::size_t f = 0; // into fresh
  std::vector<PointIndex> vertices;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const PointIndex first = runs[r].first;
    const PointIndex last = first + runs[r].count - 1;
    const bool has_above = r > 0;
    const PointIndex above = has_above ? runs[r - 1].first : 1;
    const PointIndex above_last = has_above ? above + runs[r - 1].count - 1 : 0;
    vertices.clear();
    if (coarsest) {
      code_end(first, has_above ? above : first);
      if (last != first) code_end(last, has_above ? above_last : last);
      ++f;
      vertices.push_back(first);
    } else {
      vertices.push_back(s.known[k++]);
    }
    while (vertices.back() != last) {
      // The right neighbour: the next coarser vertex; in lod0 the end of the run.
      const PointIndex right = coarsest ? last : s.known[k];
      while (f < s.fresh.size() && s.fresh[f] < right) {
        code(LevelPlace{s.fresh[f], vertices.back(), right, above, above_last, first});
        vertices.push_back(s.fresh[f++]);
      }
      vertices.push_back(right);
      if (coarsest)
        ++f;
      else
        ++k;
    }
    fill_chord(vertices, s.u[axis], s.chord[axis]);
  }
}

} // namespace scansion
