// Residuals of the rest, as the encoder needs them: it knows all points, so nothing waits for anything.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/rest_coder.hpp"

#include "pipeline/codec/kernels.hpp"

namespace scansion {
namespace {

// `above` may be null: no line before is weighed.
void residuals_of_run(const Weights& w, const RestAxis& axis, const std::int64_t* above, PointIndex first, PointIndex last,
                      std::int32_t* residual) noexcept {
  const std::int32_t* const deviation = axis.deviation.data();
  const std::int64_t rounding = RunningMeans::rounding(w);
  const PointIndex begun = std::min<PointIndex>(last, first + kLeft);
  for (PointIndex i = first + 1; i < begun; ++i) {
    std::int64_t sum = (above != nullptr ? above[i] : 0) + rounding;
    for (std::size_t k = 0; k < i - first; ++k) sum += std::int64_t{w[k]} * deviation[i - k - 1];
    for (std::size_t k = 0; k < kMeans; ++k) sum += std::int64_t{w[kLeft + k]} * axis.means[k][i];
    residual[i] = wrap(deviation[i] - (sum >> kWeightBits));
  }
  if (begun >= last) return;
  const kernels::Left left{deviation + begun, axis.means[0].data() + begun, axis.means[1].data() + begun, rounding};
  kernels::residuals(w.data(), left, above == nullptr ? nullptr : above + begun, residual + begun, last - begun);
}

// `beside` may be null: no line before.
void contexts_of_run(std::span<const PointIndex> vertices, const std::int32_t* size, const std::int32_t* beside,
                     std::uint8_t* context) noexcept {
  const PointIndex first = vertices.front();
  const PointIndex last = vertices.back();
  const auto at = [&](PointIndex i, std::int32_t size2, std::int32_t size3) {
    const std::uint32_t doubt = rest_doubt(size2, size3, beside == nullptr ? 0 : beside[i], beside != nullptr);
    context[i] = static_cast<std::uint8_t>(rest_context(doubt));
  };
  if (last - first > 2) at(first + 2, size[first], 0);
  if (last - first > 3)
    kernels::contexts(size + first + 3, beside == nullptr ? nullptr : beside + first + 3, context + first + 3,
                      last - first - 3);
  for (const PointIndex v : vertices)
    if (v != last) at(v + 1, size[v], size[v]);
}

} // namespace

void put_fitted(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours* neighbours,
                const Weights& weights, std::span<const std::int32_t> u, RestAxis& axis, RunResiduals& scratch,
                SymbolWriter& to) {
  std::size_t v = 0;
  std::size_t line = 0;
  const std::int64_t* sum = nullptr;
  const std::int32_t* beside = nullptr;
  for (const Run& run : group.runs) {
    if (neighbours != nullptr && line < neighbours->lines.size() && neighbours->lines[line].first == run.first) {
      const RestLine& at = neighbours->lines[line++];
      axis.weigh_above(at, *neighbours, u, weights);
      sum = axis.above_sum.data() - at.first;
      beside = at.has_above ? axis.above_size.data() - at.first : nullptr;
    }
    const PointIndex last = run.first + run.count - 1;
    scratch.residual.resize(std::max<std::size_t>(scratch.residual.size(), run.count + SymbolWriter::kStride));
    scratch.context.resize(scratch.residual.size());
    std::int32_t* const residual = scratch.residual.data() - run.first;
    std::uint8_t* const context = scratch.context.data() - run.first;
    residuals_of_run(weights, axis, sum, run.first, last, residual);
    kernels::sizes(residual + run.first, kLargestSize, axis.size.data() + run.first, run.count);
    const std::size_t begin = v;
    for (; vertices[v] != last; ++v) axis.size[vertices[v]] = size_of_rise(Chord(u, vertices[v], vertices[v + 1]).rise());
    axis.size[last] = 0;
    contexts_of_run(vertices.subspan(begin, ++v - begin), axis.size.data(), beside, context);
    for (std::size_t k = begin; k + 1 < v; ++k) {
      const PointIndex from = vertices[k] + 1;
      to.put(residual + from, context + from, vertices[k + 1] - from);
    }
  }
}

} // namespace scansion
