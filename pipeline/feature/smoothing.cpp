// Local weighted quadratics.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scansion {

namespace {

constexpr std::size_t kReach = 3;
constexpr std::size_t kMost = 2 * kReach + 1;

struct Samples {
  std::array<double, kMost> t{}, weight{};
  std::size_t count = 0;
};

struct Quadratic {
  double c0 = 0.0, c1 = 0.0, c2 = 0.0;
  [[nodiscard]] double at(double t) const noexcept { return c0 + t * (c1 + t * c2); }
};

// The normal equations of a weighted quadratic, taken apart once for any number of right sides.
class Normal {
public:
  Normal(const Samples& x, const std::array<double, kMost>& weight, std::size_t terms) noexcept {
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0, s4 = 0.0;
    for (std::size_t i = 0; i < x.count; ++i) {
      const double t = x.t[i], w = weight[i], wt = w * t, wtt = wt * t;
      s0 += w;
      s1 += wt;
      s2 += wtt;
      s3 += wtt * t;
      s4 += wtt * t * t;
    }
    constexpr double kNothing = 1e-12; // of the first pivot
    p0_ = s0;
    l10_ = s1 / s0;
    l20_ = s2 / s0;
    p1_ = s2 - l10_ * s1;
    linear_ = terms > 1 && p1_ > kNothing * s0;
    if (!linear_) return;
    const double m21 = s3 - l10_ * s2;
    l21_ = m21 / p1_;
    p2_ = s4 - l20_ * s2 - l21_ * m21;
    square_ = terms > 2 && p2_ > kNothing * s0;
  }

  [[nodiscard]] Quadratic solve(const Samples& x, const std::array<double, kMost>& weight,
                                const std::array<double, kMost>& value) const noexcept {
    double v0 = 0.0, v1 = 0.0, v2 = 0.0;
    for (std::size_t i = 0; i < x.count; ++i) {
      const double v = weight[i] * value[i], vt = v * x.t[i];
      v0 += v;
      v1 += vt;
      v2 += vt * x.t[i];
    }
    v1 -= l10_ * v0;
    v2 -= l20_ * v0 + l21_ * v1;
    Quadratic q;
    if (square_) q.c2 = v2 / p2_;
    if (linear_) q.c1 = v1 / p1_ - l21_ * q.c2;
    q.c0 = v0 / p0_ - l10_ * q.c1 - l20_ * q.c2;
    return q;
  }

private:
  double p0_ = 0.0, p1_ = 0.0, p2_ = 0.0, l10_ = 0.0, l20_ = 0.0, l21_ = 0.0;
  bool linear_ = false, square_ = false;
};

// The value in the middle after a second round in which what is far from the first one counts less.
double robust_value(const Samples& x, const Quadratic& first, const std::array<double, kMost>& value,
                    std::size_t terms) noexcept {
  if (x.count < 4) return first.c0;
  std::array<double, kMost> weight{};
  for (std::size_t i = 0; i < x.count; ++i) {
    const double off = value[i] - first.at(x.t[i]);
    weight[i] = x.weight[i] / (1.0 + off * off * x.weight[i]);
  }
  return Normal(x, weight, terms).solve(x, weight, value).c0;
}

} // namespace

void smooth(Track& track, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    TrackPoint& p = track.points[i];
    Samples x;
    std::array<double, kMost> q{}, w{};
    const std::size_t low = i > kReach ? i - kReach : 0, high = std::min(track.points.size() - 1, i + kReach);
    const double unit = 1.0 / std::max(1e-9, std::abs(track.points[high].r - track.points[low].r));
    for (std::size_t j = low; j <= high; ++j) {
      const TrackPoint& other = track.points[j];
      const double sigma = std::max(1e-6, other.feature.sigma_s);
      x.t[x.count] = (other.r - p.r) * unit;
      q[x.count] = other.q - p.q;
      w[x.count] = other.w - p.w;
      x.weight[x.count++] = 1.0 / (sigma * sigma);
    }
    const std::size_t terms = x.count >= 5 ? 3 : x.count >= 3 ? 2 : 1;
    const Normal normal(x, x.weight, terms);
    p.smooth_q = p.q + robust_value(x, normal.solve(x, x.weight, q), q, terms);
    p.smooth_w = p.w + robust_value(x, normal.solve(x, x.weight, w), w, terms);
  }
}

} // namespace scansion
