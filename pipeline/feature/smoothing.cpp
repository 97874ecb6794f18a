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
  std::array<double, kMost> t{}, value{}, weight{};
  std::size_t count = 0;
};

// The weighted polynomial of degree 0 to 2: its coefficients.
std::array<double, 3> fit(const Samples& x, std::size_t terms) {
  std::array<std::array<double, 4>, 3> m{};
  for (std::size_t i = 0; i < x.count; ++i) {
    const std::array<double, 3> power{1.0, x.t[i], x.t[i] * x.t[i]};
    for (std::size_t a = 0; a < terms; ++a) {
      for (std::size_t b = 0; b < terms; ++b) m[a][b] += x.weight[i] * power[a] * power[b];
      m[a][3] += x.weight[i] * power[a] * x.value[i];
    }
  }
  // Gauss with the diagonal as pivot: the matrix is positive definite.
  for (std::size_t a = 0; a < terms; ++a) {
    if (m[a][a] <= 1e-30) return fit(x, a == 0 ? 1 : a);
    for (std::size_t b = a + 1; b < terms; ++b) {
      const double f = m[b][a] / m[a][a];
      for (std::size_t k = a; k < 3; ++k) m[b][k] -= f * m[a][k];
      m[b][3] -= f * m[a][3];
    }
  }
  std::array<double, 3> out{};
  for (std::size_t a = terms; a-- > 0;) {
    double v = m[a][3];
    for (std::size_t b = a + 1; b < terms; ++b) v -= m[a][b] * out[b];
    out[a] = v / m[a][a];
  }
  return out;
}

double smooth_value(Samples& x) {
  const std::size_t terms = x.count >= 5 ? 3 : x.count >= 3 ? 2 : 1;
  const auto first = fit(x, terms);
  if (x.count < 4) return first[0];
  std::array<double, kMost> off{};
  for (std::size_t i = 0; i < x.count; ++i)
    off[i] = std::abs(x.value[i] - first[0] - first[1] * x.t[i] - first[2] * x.t[i] * x.t[i]) * std::sqrt(x.weight[i]);
  for (std::size_t i = 0; i < x.count; ++i) x.weight[i] /= 1.0 + off[i] * off[i];
  return fit(x, terms)[0];
}

} // namespace

void smooth(Track& track, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    TrackPoint& p = track.points[i];
    Samples q, w;
    const std::size_t low = i > kReach ? i - kReach : 0, high = std::min(track.points.size() - 1, i + kReach);
    const double unit = std::max(1e-9, std::abs(track.points[high].r - track.points[low].r));
    for (std::size_t j = low; j <= high; ++j) {
      const TrackPoint& other = track.points[j];
      const double sigma = std::max(1e-6, other.feature.sigma_s);
      q.t[q.count] = w.t[w.count] = (other.r - p.r) / unit;
      q.value[q.count] = other.q - p.q;
      w.value[w.count] = other.w - p.w;
      q.weight[q.count++] = w.weight[w.count++] = 1.0 / (sigma * sigma);
    }
    p.smooth_q = p.q + smooth_value(q);
    p.smooth_w = p.w + smooth_value(w);
  }
}

} // namespace scansion
