// Goes through the points of the rest, one axis at a time (docs/FORMAT.md, "Rest").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/rest_model.hpp"

namespace scansion {

/// Decodes one fitted axis: `cursor.next(context)` gives residuals. `u` holds the vertices and gets the other points.
template <class Cursor>
void decode_fitted(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours& neighbours,
                   const Weights& weights, RestAxis& axis, std::span<std::int32_t> u, Cursor& cursor) {
  std::size_t v = 0;
  std::size_t r = 0;
  for (const RestLine& line : neighbours.lines) {
    axis.weigh_above(line, neighbours, u, weights);
    const std::int64_t* sum = axis.above_sum.data() - line.first;
    const std::int32_t* beside = axis.above_size.data() - line.first;
    for (; r < group.runs.size() && group.runs[r].first < line.end; ++r) {
      const PointIndex last = group.runs[r].first + group.runs[r].count - 1;
      const Weights w = weights;
      std::array<std::int32_t, kLeft> left{}; // deviations of the points to the left, the nearest first
      std::int32_t size1 = 0;
      std::int32_t size2 = 0;
      const auto move_on = [&](std::int32_t deviation, std::int32_t size) {
        for (std::size_t k = kLeft; --k > 0;) left[k] = left[k - 1];
        left[0] = deviation;
        size2 = size1;
        size1 = size;
      };
      for (PointIndex i = vertices[v];; ++i) {
        axis.deviation[i] = axis.size[i] = 0;
        move_on(0, 0);
        if (i == last) break;
        const PointIndex end = vertices[++v];
        for (++i; i < end; ++i) {
          std::int64_t weighed = sum[i] + (std::int64_t{1} << (kWeightBits - 1));
          for (std::size_t k = kLeft; k-- > 0;)
            weighed += std::int64_t{w[k]} * left[k]; // the one that is known last comes last
          const std::int32_t residual = cursor.next(rest_context(size1, size2, beside[i], line.has_above));
          const std::int32_t deviation = wrap((weighed >> kWeightBits) + residual);
          u[i] = wrap(std::int64_t{axis.chord[i]} + deviation);
          axis.deviation[i] = deviation;
          move_on(deviation, size_of(residual));
          axis.size[i] = size1;
        }
        --i;
      }
      ++v;
    }
  }
}

/// Residuals of one fitted axis, 0 at vertices, and the sizes of them.
void fitted_residuals(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours& neighbours,
                      const Weights& weights, std::span<const std::int32_t> u, RestAxis& axis, std::span<std::int32_t> residual,
                      std::span<std::uint8_t> context);

/// What an axis that is not fitted predicts; needs no context.
[[nodiscard]] inline std::int32_t predict_plain(RestMode mode, const Neighbours& neighbours, const RestLine& line,
                                                std::span<const std::int32_t> u, std::span<const std::int32_t> chord,
                                                PointIndex run_first, PointIndex i) noexcept {
  // A run's first and last points are never in the rest, so there is always a point to the left.
  switch (mode) {
    case RestMode::slope: return i >= run_first + 2 ? wrap(2 * std::int64_t{u[i - 1]} - u[i - 2]) : u[i - 1];
    case RestMode::above: return line.has_above ? u[neighbours.of(line, i)] : chord[i];
    case RestMode::fitted:
    case RestMode::left: break;
  }
  return u[i - 1];
}

/// Visits the stretches of points that are no vertices: code(line, first point of the run, first point, end).
template <class Code>
void visit_rest(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours& neighbours, Code&& code) {
  std::size_t v = 0;
  std::size_t r = 0;
  for (const RestLine& line : neighbours.lines)
    for (; r < group.runs.size() && group.runs[r].first < line.end; ++r, ++v) {
      const PointIndex first = group.runs[r].first;
      for (const PointIndex last = first + group.runs[r].count - 1; vertices[v] != last; ++v)
        if (vertices[v] + 1 < vertices[v + 1]) code(line, first, vertices[v] + 1, vertices[v + 1]);
    }
}

} // namespace scansion
