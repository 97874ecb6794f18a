// Local weighted quadratics.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/link/smoothing.hpp"

#include "pipeline/feature/fit/pair.hpp"
#include "pipeline/feature/passes/fastest.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scansion {

namespace {

constexpr std::size_t kReach = 3;
constexpr std::size_t kMost = 2 * kReach + 1;

/// Place along the lines and height, which are smoothed alike. The point itself stands in the middle, with t = 0 and value = 0;
/// those that are missing at the ends of a track weigh nothing: loops of one length take fewer instructions.
struct Samples {
  std::array<Pair, kMost> t{}, weight{}, value{};
};

struct Quadratic {
  Pair c0{}, c1{}, c2{};
  [[nodiscard]] Pair at(Pair t) const noexcept { return c0 + t * (c1 + t * c2); }
};

/// A weighted quadratic by its normal equations; of fewer terms where samples do not tell more.
Quadratic fit(const Samples& x, const std::array<Pair, kMost>& weight, std::size_t terms) noexcept {
  constexpr double kNothing = 1e-12; // of the first pivot
  Pair s0{}, s1{}, s2{}, s3{}, s4{}, v0{}, v1{}, v2{};
  for (std::size_t i = 0; i < kMost; ++i) {
    s0 += weight[i];
    if (i == kReach) continue;
    const Pair t = x.t[i], w = weight[i], wt = w * t, wtt = wt * t;
    s1 += wt;
    s2 += wtt;
    s3 += wtt * t;
    s4 += wtt * t * t;
    const Pair v = w * x.value[i], vt = v * t;
    v0 += v;
    v1 += vt;
    v2 += vt * t;
  }
  const Pair l10 = s1 / s0, l20 = s2 / s0, p1 = s2 - l10 * s1;
  const Pair m21 = s3 - l10 * s2, l21 = m21 / p1, p2 = s4 - l20 * s2 - l21 * m21;
  v1 -= l10 * v0;
  v2 -= l20 * v0 + l21 * v1;
  Quadratic q;
  q.c2 = v2 / p2;
  for (std::size_t l = 0; l < 2; ++l) {
    const bool linear = terms > 1 && p1[l] > kNothing * s0[l];
    if (!linear || terms < 3 || !(p2[l] > kNothing * s0[l])) q.c2[l] = 0.0;
  }
  q.c1 = v1 / p1 - l21 * q.c2;
  for (std::size_t l = 0; l < 2; ++l)
    if (terms < 2 || !(p1[l] > kNothing * s0[l])) q.c1[l] = 0.0;
  q.c0 = v0 / s0 - l10 * q.c1 - l20 * q.c2;
  return q;
}

// The value in the middle, after a second round in which what is far from the first one counts less.
Pair robust_value(const Samples& x, std::size_t count) noexcept {
  const std::size_t terms = count >= 5 ? 3 : count >= 3 ? 2 : 1;
  const Quadratic first = fit(x, x.weight, terms);
  if (count < 4) return first.c0;
  std::array<Pair, kMost> weight{};
  for (std::size_t i = 0; i < kMost; ++i) {
    const Pair off = x.value[i] - first.at(x.t[i]);
    weight[i] = x.weight[i] / (both(1.0) + off * off * x.weight[i]);
  }
  return fit(x, weight, terms).c0;
}

void smooth_body(Track& track, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    TrackPoint& p = track.points[i];
    const std::size_t low = i > kReach ? i - kReach : 0, high = std::min(track.points.size() - 1, i + kReach);
    const double unit = 1.0 / std::max(1e-9, std::abs(track.points[high].r - track.points[low].r));
    Samples x;
    for (std::size_t j = low; j <= high; ++j) {
      const TrackPoint& other = track.points[j];
      const double sigma = std::max(1e-6, other.feature.sigma_s);
      const std::size_t k = j + kReach - i;
      x.t[k] = both((other.r - p.r) * unit);
      x.value[k] = Pair{other.q - p.q, other.w - p.w};
      x.weight[k] = both(1.0 / (sigma * sigma));
    }
    const Pair smoothed = robust_value(x, high - low + 1);
    p.smooth_q = p.q + smoothed[0];
    p.smooth_w = p.w + smoothed[1];
  }
}

} // namespace

void smooth(Track& track, std::size_t first, std::size_t last) {
  return passes::fastest<smooth_body>(track, first, last);
}

} // namespace scansion
