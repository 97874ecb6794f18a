// Coordinates of the vertices of one level, predicted from coarser levels and the line before (docs/FORMAT.md, "Level").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/group_state.hpp"

#include <algorithm>
#include <bit>

namespace scansion {

/// How the coordinates of one axis are predicted in a level; stored in the payload.
enum class LevelMode : std::uint8_t {
  chord = 0, ///< on the chord between the known neighbours
  left = 1,  ///< the value of the left neighbour
  bend = 2,  ///< on the chord, plus what the line before bends away from its own chord over the same points
  rise = 3,  ///< the value of the left neighbour, plus what the line before rises from there
  above = 4, ///< the value of the line before
};
inline constexpr std::size_t kLevelModes = 5;
using LevelGuess = std::array<std::int32_t, kLevelModes>;

// Contexts: end points, runs without one above, then by how far two ways to predict lie apart, separately for vertices that go
// on.
inline constexpr std::uint32_t kEndContext = 0;
inline constexpr std::uint32_t kNothingAbove = 1;
inline constexpr std::uint32_t kDoubts = 2;
inline constexpr std::uint32_t kDoubtSizes = 20;

/// The polyline of a level at any point of a run. It walks from where it was asked last, which is mostly near.
class Curve {
public:
  Curve(const GroupState& s, std::size_t axis) noexcept : vertices_(s.vertices), u_(s.u[axis]) {}
  /// `i` is a point of the run asked for; the first and last points of a run are vertices.
  [[nodiscard]] std::int64_t at(PointIndex i) noexcept {
    while (vertices_[right_] < i) ++right_;
    while (right_ > 0 && vertices_[right_ - 1] >= i) --right_;
    const PointIndex right = vertices_[right_];
    if (right == i) return u_[i];
    const PointIndex left = vertices_[right_ - 1];
    return between(u_[left], u_[right], i, left, right);
  }

private:
  const std::vector<PointIndex>& vertices_;
  const std::vector<std::int32_t>& u_;
  std::size_t right_ = 0;
};

/// What is told of an even axis before its runs.
struct EvenStart {
  std::int32_t first = 0;   ///< of the first run
  std::int32_t advance = 0; ///< from run to run
  std::int32_t step = 0;    ///< from point to point
};

/// Visits the first and last points of all runs on an even axis: a run is expected to begin `advance` behind the one before and
/// to go on in its steps. `code(point, guess, context)` must make u[point] true before it returns.
template <class Code>
void visit_even_ends(std::span<const Run> runs, std::span<const std::int32_t> u, const EvenStart& start, Code&& code) {
  std::int32_t first = wrap(std::int64_t{start.first} - start.advance);
  std::int64_t step = start.step;
  for (const Run& run : runs) {
    code(run.first, wrap(std::int64_t{first} + start.advance), 0U);
    first = u[run.first];
    if (run.count < 2) continue;
    code(run.first + run.count - 1, wrap(first + step * (run.count - 1)), 1U);
    step = even_step(run, u);
  }
}

/// Visits the points of a level in coding order, for one axis that is not even. `code(point, guess, context)` must make
/// u[axis][point] true before it returns.
template <class Code>
void visit_level(const GroupState& s, std::span<const Run> runs, std::size_t axis, bool coarsest, Code&& code) {
  const auto& u = s.u[axis];
  Curve curve(s, axis);
  Curve far(s, axis); // at the far ends of chords
  std::size_t f = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const PointIndex first = runs[r].first;
    const PointIndex last = first + runs[r].count - 1;
    const RunAbove& above = s.above[r];
    if (coarsest) {
      LevelGuess guess;
      guess.fill(above.exists ? u[above.first] : r == 0 ? 0 : u[runs[r - 1].first]);
      code(first, guess, kEndContext);
      guess.fill(above.exists ? u[above.last] : u[first]);
      if (last != first) code(last, guess, kEndContext);
    }
    PointIndex right = first;
    std::int64_t right_above = 0;
    PointIndex before = last; // the point coded last, and what lies above it
    std::int64_t before_above = 0;
    std::size_t v = s.run_vertices[r] + 1; // the vertex to come
    for (; f < s.fresh.size() && s.fresh[f].point < last; ++f, ++v) {
      const Fresh& at = s.fresh[f];
      while (s.vertices[v] != at.point) ++v;
      const PointIndex left = s.vertices[v - 1];
      if (right <= at.point) {
        // The next vertex that a coarser level holds; in lod0 the end of the run.
        std::size_t w = v + 1;
        while (s.added[w] != 0) ++w;
        right = s.vertices[w];
        if (above.exists) right_above = far.at(s.beside[right]);
      }
      const std::int64_t straight = between(u[left], u[right], at.point, left, right);
      LevelGuess guess;
      guess.fill(wrap(straight));
      guess[1] = u[left];
      std::uint32_t context = kNothingAbove;
      if (above.exists) {
        const PointIndex l = s.beside[left];
        const PointIndex b = s.beside[right];
        const PointIndex i = s.beside[at.point];
        const std::int64_t here = curve.at(i);
        const std::int64_t left_above = left == before ? before_above : curve.at(l);
        const std::int64_t bend = l < i && i < b ? here - between(left_above, right_above, i, l, b) : 0;
        guess[2] = wrap(straight + bend);
        guess[3] = wrap(u[left] + here - left_above);
        guess[4] = wrap(here);
        const std::int64_t doubt = here - straight - bend;
        const auto size = static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint64_t>(doubt < 0 ? -doubt : doubt)));
        context = kDoubts + (at.matched ? kDoubtSizes : 0) + std::min(size, kDoubtSizes - 1);
        before = at.point;
        before_above = here;
      }
      code(at.point, guess, context);
    }
  }
}

} // namespace scansion
