// A flank each side, and what lies between them.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/fit/rounding.hpp"

#include "pipeline/feature/fit/flank.hpp"
#include "pipeline/feature/fit/parabola.hpp"
#include "pipeline/feature/passes/fastest.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

// Sum of squares of the best parabola over samples [l, r].
double arc_error(const Heights& h, std::uint32_t l, std::uint32_t r) noexcept {
  PowerSums sums;
  const std::uint32_t k = (l + r) / 2;
  for (std::uint32_t j = l; j <= r; ++j) sums.add(h.s[j] - h.s[k], h.w[j] - h.w[k], 1.0);
  return std::max(0.0, Parabola::fit(sums).error);
}

// Roundings cut corners off: the line of a flank beyond one passes outside the corner. What passes inside has turned back.
bool passes_inside(const Heights& h, std::uint32_t k, const Flank& flank, const Turning& corner,
                   const FitScale& scale) noexcept {
  constexpr double kSurely = 2.0; // sigmas
  const double above = flank.at(h.s[k]) - h.w[k];
  return flank.gap > 0 && (corner.clockwise() ? above : -above) < -kSurely * scale.sigma();
}

// Tangent length over the tangent of half the turning.
double radius_of(double width, const RoundedEdge& edge) noexcept {
  constexpr double kTan89 = 57.289961630759;
  const double cosine =
      (edge.before.cosine + edge.after.cosine) / std::sqrt(2.0 + 2.0 * edge.turning.cosine); // of the bisector
  return 0.5 * width / std::max(0.1, cosine) / std::min(kTan89, edge.turning.tangent_of_half());
}

RoundingSearch find_rounding_body(const Heights& h, std::uint32_t k, std::uint32_t first, std::uint32_t last,
                                  std::uint32_t window, double s, const Turning& corner, const FitScale& scale,
                                  RoundedEdge& edge) {
  constexpr double kSharpest = 12.0;
  constexpr std::uint32_t kFewest = 4;
  if (k - first < kFewest || last - k < kFewest) return RoundingSearch::none;
  const std::uint32_t size = std::clamp(window, scale.least_window, 2 * scale.least_window);
  const std::uint32_t most = scale.widest_gap;
  const Flank l = find_flank(h, k - 1, first, size, most, scale);
  if (!l.straight || l.samples < kFewest || passes_inside(h, k, l, corner, scale)) return RoundingSearch::none;
  const Flank r = find_flank(h, k + 1, last, size, most, scale);
  if (!r.straight || r.samples < kFewest || !(l.rounded || r.rounded)) return RoundingSearch::none;
  if (std::abs(l.slope - r.slope) < 1e-9) return RoundingSearch::none;
  edge.s = s + ((r.w - r.slope * (r.s - s)) - (l.w - l.slope * (l.s - s))) / (l.slope - r.slope);
  // The flanks meet over the rounding between them.
  const std::uint32_t inner_left = k - 1 - l.gap, inner_right = k + 1 + r.gap;
  if (edge.s < h.s[inner_left] - scale.pitch || edge.s > h.s[inner_right] + scale.pitch) return RoundingSearch::none;
  edge.before = Direction::of_slope(l.slope);
  edge.after = Direction::of_slope(r.slope);
  edge.turning = Turning::between(edge.before, edge.after);
  if (edge.turning.clockwise() != corner.clockwise() || edge.turning.is_less_than(corner)) return RoundingSearch::none;
  if (is_chamfered(h, k - 1, first, l, scale) || is_chamfered(h, k + 1, last, r, scale)) return RoundingSearch::none;
  edge.radius = radius_of(h.s[inner_right] - h.s[inner_left], edge);
  if (edge.radius > scale.arc_radius) return RoundingSearch::too_wide;
  const std::uint32_t from = inner_left - (l.samples - 1), to = inner_right + (r.samples - 1);
  const double n = to - from + 1;
  const double floor = n * scale.variance();
  edge.sharpness = std::min(kSharpest, 0.5 * n * std::log(std::max(1.0, arc_error(h, from, to) / floor)) - 1.0);
  edge.w = l.at(edge.s);
  edge.flank_after = inner_right;
  edge.window = std::max(l.gap + l.samples, r.gap + r.samples);
  return RoundingSearch::edge;
}

} // namespace

RoundingSearch find_rounding(const Heights& h, std::uint32_t k, std::uint32_t first, std::uint32_t last, std::uint32_t window,
                             double s, const Turning& corner, const FitScale& scale, RoundedEdge& edge) {
  return passes::fastest<find_rounding_body>(h, k, first, last, window, s, corner, scale, edge);
}

} // namespace scansion
