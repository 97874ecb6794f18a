// Goes through the points of the rest, one axis at a time (docs/FORMAT.md, "Rest").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/rest_model.hpp"
#include "pipeline/codec/symbols.hpp"

#include <type_traits>

namespace scansion {

/// Residuals of one run and their contexts, scratch.
struct RunResiduals {
  std::vector<std::int32_t> residual;
  std::vector<std::uint8_t> context;
};

/// Puts the residuals of one fitted axis. Without `neighbours` the line before is left alone.
void put_fitted(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours* neighbours,
                const Weights& weights, std::span<const std::int32_t> u, RestAxis& axis, RunResiduals& scratch,
                SymbolWriter& to);

/// Takes the residuals that put_fitted() put; `u` holds the vertices and gets the other points. With `neighbours` the axis'
/// chord must stand. `from` must have room for every point.
void take_fitted(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours* neighbours,
                 const Weights& weights, std::span<std::int32_t> u, RestAxis& axis, SymbolReader& from);

/// What an axis that is not fitted predicts; needs no context.
[[nodiscard]] inline std::int32_t predict_plain(RestMode mode, const Neighbours& neighbours, const RestLine& line,
                                                std::span<const std::int32_t> u, std::span<const std::int32_t> chord,
                                                PointIndex run_first, PointIndex i) noexcept {
  // A run's first and last points are never in the rest, so there is always a point to the left.
  switch (mode) {
    case RestMode::slope: return i >= run_first + 2 ? wrap(2 * std::int64_t{u[i - 1]} - u[i - 2]) : u[i - 1];
    case RestMode::above: return line.has_above ? u[neighbours.of(line, i)] : chord[i];
    case RestMode::fitted:
    case RestMode::line:
    case RestMode::left: break;
  }
  return u[i - 1];
}

/// Visits the stretches of points that are no vertices: code(line, first point of the run, first point, end). A false from it
/// ends that.
template <class Code>
void visit_rest(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours& neighbours, Code&& code) {
  std::size_t v = 0;
  std::size_t r = 0;
  for (const RestLine& line : neighbours.lines)
    for (; r < group.runs.size() && group.runs[r].first < line.end; ++r, ++v) {
      const PointIndex first = group.runs[r].first;
      for (const PointIndex last = first + group.runs[r].count - 1; vertices[v] != last; ++v)
        if (vertices[v] + 1 < vertices[v + 1]) {
          const auto visit = [&] { return code(line, first, vertices[v] + 1, vertices[v + 1]); };
          if constexpr (std::is_same_v<decltype(visit()), bool>) {
            if (!visit()) return;
          } else {
            visit();
          }
        }
    }
}

} // namespace scansion
