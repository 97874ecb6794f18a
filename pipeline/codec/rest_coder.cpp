// Residuals of the rest, as the encoder needs them: it knows all points, so nothing waits for anything.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/rest_coder.hpp"

#include "pipeline/codec/kernels.hpp"

namespace scansion {
namespace {

void residuals_of_run(const Weights& w, const std::int32_t* deviation, const std::int64_t* above_sum, PointIndex first,
                      PointIndex last, std::int32_t* residual) noexcept {
  const PointIndex begun = std::min<PointIndex>(last, first + kLeft);
  for (PointIndex i = first + 1; i < begun; ++i) {
    std::int64_t sum = above_sum[i] + (std::int64_t{1} << (kWeightBits - 1));
    for (std::size_t k = 0; k < i - first; ++k) sum += std::int64_t{w[k]} * deviation[i - k - 1];
    residual[i] = wrap(deviation[i] - (sum >> kWeightBits));
  }
  if (begun < last) kernels::residuals(w.data(), deviation + begun, above_sum + begun, residual + begun, last - begun);
}

} // namespace

void fitted_residuals(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours& neighbours,
                      const Weights& weights, std::span<const std::int32_t> u, RestAxis& axis, std::span<std::int32_t> residual,
                      std::span<std::uint8_t> context) {
  std::size_t v = 0;
  std::size_t r = 0;
  for (const RestLine& line : neighbours.lines) {
    axis.weigh_above(line, neighbours, u, weights);
    const std::int64_t* sum = axis.above_sum.data() - line.first;
    const std::int32_t* beside = axis.above_size.data() - line.first;
    for (; r < group.runs.size() && group.runs[r].first < line.end; ++r) {
      const PointIndex first = group.runs[r].first;
      const PointIndex last = first + group.runs[r].count - 1;
      residuals_of_run(weights, axis.deviation.data(), sum, first, last, residual.data());
      for (; v < vertices.size() && vertices[v] <= last; ++v) residual[vertices[v]] = 0;
      kernels::sizes(residual.data() + first, kLargestSize, axis.size.data() + first, last - first + 1);
      if (last - first < 2) continue;
      context[first + 1] = static_cast<std::uint8_t>(rest_context(0, 0, beside[first + 1], line.has_above));
      kernels::contexts(axis.size.data() + first + 2, beside + first + 2, line.has_above, context.data() + first + 2,
                        last - first - 2);
    }
  }
}

} // namespace scansion
