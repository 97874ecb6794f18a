// Least squares over a window that moves away from the edge.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/flank.hpp"

#include <cmath>
#include <limits>

namespace scansion {

namespace {

struct Sums {
  double n = 0.0, u = 0.0, v = 0.0, uu = 0.0, uv = 0.0, vv = 0.0;
  void add(double du, double dv, double sign) noexcept {
    n += sign;
    u += sign * du;
    v += sign * dv;
    uu += sign * du * du;
    uv += sign * du * dv;
    vv += sign * dv * dv;
  }
};

} // namespace

Flank find_flank(const Heights& h, std::uint32_t from, std::uint32_t to, std::uint32_t window, std::uint32_t most_gap,
                 const FitScale& scale) {
  const bool left = to < from;
  const std::uint32_t count = (left ? from - to : to - from) + 1;
  const auto sample = [&](std::uint32_t i) { return left ? from - i : from + i; };
  const double s0 = h.s[from], w0 = h.w[from];
  const std::uint32_t size = std::min(window, count);
  Sums sums;
  for (std::uint32_t i = 0; i < size; ++i) sums.add(h.s[sample(i)] - s0, h.w[sample(i)] - w0, 1.0);
  Flank best;
  double best_error = std::numeric_limits<double>::infinity();
  const double n = size;
  const double sigma = scale.noise + 0.0005;
  // Residuals of a straight flank stay below this with a chance of about one in a thousand.
  const double limit = sigma * sigma * (1.0 + 3.1 * std::sqrt(2.0 / std::max(1.0, n - 2.0)));
  for (std::uint32_t gap = 0;; ++gap) {
    const double mu = sums.u / n, mv = sums.v / n;
    const double uu = sums.uu - mu * sums.u, uv = sums.uv - mu * sums.v, vv = sums.vv - mv * sums.v;
    const double slope = size >= 3 && uu > 0.0 ? uv / uu : 0.0;
    const double error = size >= 3 ? std::max(0.0, vv - slope * uv) / (n - 2.0) : 0.0;
    if (error < best_error) {
      best_error = error;
      best = {s0 + mu, w0 + mv, slope, std::abs(h.s[sample(gap + size - 1)] - h.s[sample(gap)]), size, gap, error <= limit};
    }
    if (best.straight || gap >= most_gap || gap + size >= count) return best;
    sums.add(h.s[sample(gap)] - s0, h.w[sample(gap)] - w0, -1.0);
    sums.add(h.s[sample(gap + size)] - s0, h.w[sample(gap + size)] - w0, 1.0);
  }
}

} // namespace scansion
