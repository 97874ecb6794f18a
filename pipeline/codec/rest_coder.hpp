// Goes through the points of the rest, one axis at a time (docs/FORMAT.md, "Rest").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/rest_model.hpp"
#include "pipeline/codec/symbols.hpp"

#include <utility>

namespace scansion {

/// Decodes one run of a fitted axis; `vertices` begin with those of the run. With a line before, `sum` and `beside` are what it
/// adds, and the axis' chord must stand. Returns how many vertices the run has.
template <bool kAbove, class Cursor>
std::size_t decode_fitted_run(const Run& run, std::span<const PointIndex> vertices, const Weights& weights, RestAxis& axis,
                              const std::int64_t* sum, const std::int32_t* beside, std::span<std::int32_t> u, Cursor& cursor) {
  std::array<std::int64_t, kLineWeights> w; // as wide as the sums: nothing is widened point by point
  std::copy_n(weights.begin(), w.size(), w.begin());
  std::array<std::int64_t, kLeft> weighed{}; // what the points to the left add to the next, the one after it, ...
  RunningMeans means;
  std::int32_t size1 = 0; // of the points to the left
  std::int32_t size2 = 0;
  std::int32_t size3 = 0;
  const auto move_on = [&](std::int32_t deviation, std::int32_t size) {
    for (std::size_t k = 0; k + 1 < kLeft; ++k) weighed[k] = weighed[k + 1] + w[k] * deviation;
    weighed[kLeft - 1] = w[kLeft - 1] * deviation;
    size3 = std::exchange(size2, std::exchange(size1, size));
  };
  const PointIndex last = run.first + run.count - 1;
  std::size_t v = 0;
  for (PointIndex i = vertices[0]; i != last; ++v) {
    const PointIndex end = vertices[v + 1];
    const Chord chord(u, i, end);
    std::int64_t on_chord = std::int64_t{u[i]} * (std::int64_t{1} << Chord::kStepBits);
    move_on(0, size_of_rise(chord.rise()));
    if constexpr (kAbove) {
      axis.deviation[i] = 0;
      axis.size[i] = size1;
    }
    std::int32_t near = size1; // a vertex speaks for the points before it, too
    std::int32_t far = size1;
    for (++i; i < end; ++i) {
      const bool has_above = kAbove && beside != nullptr;
      const std::int32_t residual = cursor.next(rest_context(near, far, has_above ? beside[i] : 0, has_above));
      const std::int64_t others =
          (kAbove ? sum[i] : 0) + (std::int64_t{1} << (kWeightBits - 1)) + w[kLeft] * means.fast + w[kLeft + 1] * means.slow;
      const std::int32_t deviation = wrap(((others + weighed[0]) >> kWeightBits) + residual); // what is known last comes last
      on_chord += chord.step;
      u[i] = wrap((on_chord >> Chord::kStepBits) + deviation);
      means.add(deviation);
      move_on(deviation, size_of(residual));
      near = size2;
      far = size3;
      if constexpr (kAbove) {
        axis.deviation[i] = deviation;
        axis.size[i] = size1;
      }
    }
  }
  if constexpr (kAbove) axis.deviation[last] = axis.size[last] = 0;
  return v + 1;
}

/// Decodes one fitted axis that leaves the line before alone: `cursor.next(context)` gives residuals. `u` holds the vertices
/// and gets the other points.
template <class Cursor>
void decode_line_fitted(const LineGroup& group, std::span<const PointIndex> vertices, const Weights& weights, RestAxis& axis,
                        std::span<std::int32_t> u, Cursor& cursor) {
  for (const Run& run : group.runs)
    vertices = vertices.subspan(decode_fitted_run<false>(run, vertices, weights, axis, nullptr, nullptr, u, cursor));
}

/// Decodes one fitted axis whose chord stands.
template <class Cursor>
void decode_fitted(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours& neighbours,
                   const Weights& weights, RestAxis& axis, std::span<std::int32_t> u, Cursor& cursor) {
  std::size_t r = 0;
  for (const RestLine& line : neighbours.lines) {
    axis.weigh_above(line, neighbours, u, weights);
    const std::int64_t* sum = axis.above_sum.data() - line.first;
    const std::int32_t* beside = line.has_above ? axis.above_size.data() - line.first : nullptr;
    for (; r < group.runs.size() && group.runs[r].first < line.end; ++r)
      vertices = vertices.subspan(decode_fitted_run<true>(group.runs[r], vertices, weights, axis, sum, beside, u, cursor));
  }
}

/// Residuals of one run and their contexts, scratch.
struct RunResiduals {
  std::vector<std::int32_t> residual;
  std::vector<std::uint8_t> context;
};

/// Puts the residuals of one fitted axis. Without `neighbours` the line before is left alone.
void put_fitted(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours* neighbours,
                const Weights& weights, std::span<const std::int32_t> u, RestAxis& axis, RunResiduals& scratch,
                SymbolWriter& to);

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
