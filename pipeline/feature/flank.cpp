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

// Whether samples a..b beside a flank run straight rather than round into it: their curvature against that of the arc that
// leaves the flank smoothly and has their chord.
bool is_chamfer(const Heights& h, std::uint32_t a, std::uint32_t b, double slope) noexcept {
  const std::uint32_t low = std::min(a, b), high = std::max(a, b);
  const double ds = h.s[high] - h.s[low], dw = h.w[high] - h.w[low];
  const double length = std::hypot(ds, dw);
  const double turn = std::atan2(dw, ds) - std::atan(slope); // half of what the arc turns
  const double arc = std::abs(std::sin(turn)) / length;
  // Least squares of v = x + y t + z t^2 in the frame of the chord.
  double n = 0.0, t1 = 0.0, t2 = 0.0, t3 = 0.0, t4 = 0.0, v0 = 0.0, v1 = 0.0, v2 = 0.0;
  for (std::uint32_t k = low; k <= high; ++k) {
    const double u = h.s[k] - 0.5 * (h.s[low] + h.s[high]), y = h.w[k] - 0.5 * (h.w[low] + h.w[high]);
    const double t = (u * ds + y * dw) / length, v = (y * ds - u * dw) / length;
    n += 1.0;
    t1 += t;
    t2 += t * t;
    t3 += t * t * t;
    t4 += t * t * t * t;
    v0 += v;
    v1 += t * v;
    v2 += t * t * v;
  }
  const double a11 = t2 - t1 * t1 / n, a12 = t3 - t1 * t2 / n, a22 = t4 - t2 * t2 / n;
  const double b1 = v1 - t1 * v0 / n, b2 = v2 - t2 * v0 / n;
  const double norm = a22 - a12 * a12 / a11;
  if (!(norm > 0.0)) return false;
  const double curvature = (b2 - a12 / a11 * b1) / norm;
  return std::abs(curvature) < 0.3 * arc;
}

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
    if (best.straight || gap >= most_gap || gap + size >= count) break;
    sums.add(h.s[sample(gap)] - s0, h.w[sample(gap)] - w0, -1.0);
    sums.add(h.s[sample(gap + size)] - s0, h.w[sample(gap + size)] - w0, 1.0);
  }
  constexpr double kSmallRounding = 0.35; // mm
  best.rounded = best.straight && best.gap > 0 && (best.gap >= kLeastGap || best.gap * scale.pitch <= kSmallRounding);
  if (best.gap >= kLeastGap) best.chamfered = is_chamfer(h, sample(0), sample(best.gap - 1), best.slope);
  return best;
}

} // namespace scansion
