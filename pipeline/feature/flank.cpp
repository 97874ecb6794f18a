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

constexpr double kTelling = 53.0; // a straight stretch of the root of this times radius and noise is no arc: off by two sigma
constexpr std::uint32_t kBeyond = 3; // samples by which the end of a rounding may be missed

// The samples from an edge outwards.
struct Side {
  const Heights& h;
  std::uint32_t from;
  bool left;
  std::uint32_t count;

  [[nodiscard]] std::uint32_t sample(std::uint32_t i) const noexcept { return left ? from - i : from + i; }
  [[nodiscard]] double s0() const noexcept { return h.s[from]; }
  [[nodiscard]] double w0() const noexcept { return h.w[from]; }
  [[nodiscard]] double u(std::uint32_t i) const noexcept { return h.s[sample(i)] - h.s[from]; }
  [[nodiscard]] double v(std::uint32_t i) const noexcept { return h.w[sample(i)] - h.w[from]; }
  [[nodiscard]] double length(std::uint32_t i, std::uint32_t j) const noexcept {
    return std::abs(h.s[sample(j)] - h.s[sample(i)]);
  }
  void add(Sums& sums, std::uint32_t i, double sign) const noexcept { sums.add(u(i), v(i), sign); }
};

// Whether what lies between the edge and a flank runs straight up to it, and does not round into it: a broken line against an
// arc that leaves the flank smoothly, both with the best place to leave it.
bool is_chamfer(const Side& outside, const Flank& flank, double sigma) noexcept {
  constexpr double kClearly = 2.0; // twice the least log likelihood
  // The sample at the edge itself tells most.
  const Side side{outside.h, outside.left ? outside.from + 1 : outside.from - 1, outside.left, outside.count + 1};
  const std::uint32_t gap = flank.gap + 1;
  const double norm = 1.0 / std::hypot(1.0, flank.slope);
  const std::uint32_t last = std::min(side.count - 1, gap + kBeyond);
  // In the frame of the flank: places along it from the edge, distances from it.
  const auto along = [&](std::uint32_t i) { return norm * (side.u(i) + flank.slope * side.v(i)); };
  const auto off = [&](std::uint32_t i) { return norm * (side.v(i) + side.w0() - flank.at(side.u(i) + side.s0())); };
  double best_line = std::numeric_limits<double>::infinity(), best_arc = best_line;
  for (std::uint32_t leave = gap > kBeyond ? gap - kBeyond : 1; leave <= last; ++leave) {
    const double from = along(leave);
    double vv = 0.0, xv = 0.0, xx = 0.0, yv = 0.0, yy = 0.0;
    for (std::uint32_t i = 0; i <= last; ++i) {
      const double v = off(i);
      vv += v * v;
      if (i >= leave) continue;
      const double x = along(i) - from, y = x * x;
      xv += x * v;
      xx += x * x;
      yv += y * v;
      yy += y * y;
    }
    if (xx > 0.0) best_line = std::min(best_line, vv - xv * xv / xx);
    if (yy > 0.0) best_arc = std::min(best_arc, vv - yv * yv / yy);
  }
  return best_line + kClearly * sigma * sigma < best_arc;
}

// The first straight stretch of `size` samples, at least `gap` and at most `most_gap` samples from the edge.
Flank first_straight(const Side& side, std::uint32_t size, std::uint32_t gap, std::uint32_t most_gap, double sigma) noexcept {
  Sums sums;
  for (std::uint32_t i = gap; i < gap + size; ++i) side.add(sums, i, 1.0);
  Flank best;
  double best_error = std::numeric_limits<double>::infinity();
  const double n = size;
  // Residuals of a straight flank stay below this with a chance of about one in a thousand.
  const double limit = sigma * sigma * (1.0 + 3.1 * std::sqrt(2.0 / std::max(1.0, n - 2.0)));
  for (;; ++gap) {
    const double mu = sums.u / n, mv = sums.v / n;
    const double uu = sums.uu - mu * sums.u, uv = sums.uv - mu * sums.v, vv = sums.vv - mv * sums.v;
    const double slope = size >= 3 && uu > 0.0 ? uv / uu : 0.0;
    const double error = size >= 3 ? std::max(0.0, vv - slope * uv) / (n - 2.0) : 0.0;
    if (error < best_error) {
      best_error = error;
      best = {side.s0() + mu, side.w0() + mv, slope, side.length(gap, gap + size - 1), size, gap, error <= limit};
    }
    if (best.straight || gap >= most_gap || gap + size >= side.count) return best;
    side.add(sums, gap, -1.0);
    side.add(sums, gap + size, 1.0);
  }
}

} // namespace

Flank find_flank(const Heights& h, std::uint32_t from, std::uint32_t to, std::uint32_t window, std::uint32_t least_window,
                 std::uint32_t most_gap, const FitScale& scale) {
  const bool left = to < from;
  const Side side{h, from, left, (left ? from - to : to - from) + 1};
  const std::uint32_t size = std::min(window, side.count), least = std::min(least_window, size);
  const double sigma = scale.noise + 0.0005;
  if (most_gap == 0) return first_straight(side, size, 0, 0, sigma);
  // The end of a rounding is straight over a short window, so long ones go first.
  Flank best;
  const double telling = std::sqrt(kTelling * scale.arc_radius * sigma) / scale.pitch;
  const auto most = static_cast<std::uint32_t>(std::min(2.0 * size, std::ceil(telling)));
  for (std::uint32_t n = std::min(std::max(most, size), side.count); !best.straight; n = n > size ? size : least) {
    best = first_straight(side, n, 0, most_gap, sigma);
    if (n <= least) break;
  }
  // A longer one still sees what is left of its arc.
  const std::uint32_t longer = 2 * best.samples;
  if (best.straight && best.gap > 0 && best.gap + longer <= side.count) {
    const Flank flank = first_straight(side, longer, best.gap, best.gap + best.samples, sigma);
    if (flank.straight) best = flank;
  }
  constexpr double kSmallRounding = 0.35; // mm
  best.rounded = best.straight && best.gap > 0 && (best.gap >= kLeastGap || best.gap * scale.pitch <= kSmallRounding);
  if (best.gap >= kLeastGap) best.chamfered = is_chamfer(side, best, sigma);
  return best;
}

} // namespace scansion
