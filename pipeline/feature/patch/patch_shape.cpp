// Plane and quadric by normal equations about the middle of the patch.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/patch_shape.hpp"

#include "pipeline/feature/feature_line.hpp"

#include <cmath>
#include <numbers>

namespace scansion {

namespace {

constexpr std::array<std::array<double, 5>, 5> kBinomial = {
    {{1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}}};

double power(double base, std::size_t exponent) noexcept {
  double out = 1.0;
  for (std::size_t i = 0; i < exponent; ++i) out *= base;
  return out;
}

using System = std::array<std::array<double, 7>, 6>;

// Solves the first `n` equations in place, smallest pivots left out; the right side stands in column 6.
std::array<double, 6> solve(System m, std::size_t n) {
  std::array<double, 6> scale{};
  for (std::size_t a = 0; a < n; ++a) scale[a] = m[a][a];
  std::array<bool, 6> used{};
  for (std::size_t a = 0; a < n; ++a) {
    if (!(m[a][a] > 1e-9 * scale[a]) || scale[a] <= 0.0) continue;
    used[a] = true;
    for (std::size_t b = 0; b < n; ++b) {
      if (b == a) continue;
      const double f = m[b][a] / m[a][a];
      for (std::size_t k = 0; k < 7; ++k) m[b][k] -= f * m[a][k];
    }
  }
  std::array<double, 6> out{};
  for (std::size_t a = 0; a < n; ++a) out[a] = used[a] ? m[a][6] / m[a][a] : 0.0;
  return out;
}

// Power sums of samples of one scan line, in two lanes.
class RowSums {
public:
  struct Totals {
    std::array<double, 5> s;
    std::array<double, 3> w;
    double ww;
  };

  // From sample `first` on, `pairs` times two samples, one pair `step` samples after the other.
  void add(const RowStretch& samples, std::size_t first, std::size_t pairs, std::size_t step) noexcept {
    for (std::size_t i = 0, k = first; i < pairs; ++i, k += step)
      for (std::size_t l = 0; l < kLanes; ++l) take(l, samples.s[k + l], samples.w[k + l]);
  }
  void add_one(double s, double w) noexcept { take(0, s, w); }
  void add(const RowSums& other, double weight) noexcept {
    for (std::size_t k = 0; k < sums_.size(); ++k)
      for (std::size_t l = 0; l < kLanes; ++l) sums_[k][l] += weight * other.sums_[k][l];
  }
  [[nodiscard]] Totals totals(double count) const noexcept {
    const auto of = [&](std::size_t k) { return sums_[k][0] + sums_[k][1]; };
    return {{count, of(0), of(1), of(2), of(3)}, {of(4), of(5), of(6)}, of(7)};
  }

private:
  static constexpr std::size_t kLanes = 2;
  void take(std::size_t l, double s, double w) noexcept {
    const double square = s * s;
    sums_[0][l] += s;
    sums_[1][l] += square;
    sums_[2][l] += square * s;
    sums_[3][l] += square * square;
    sums_[4][l] += w;
    sums_[5][l] += w * s;
    sums_[6][l] += w * square;
    sums_[7][l] += w * w;
  }

  std::array<std::array<double, kLanes>, 8> sums_{};
};

} // namespace

void PatchSums::add(const RowStretch& samples, double c) noexcept {
  // Of long stretches two samples in the middle of each eight are enough, of longer ones two of each 16 or 32: what a surface
  // is needs no more.
  constexpr std::size_t kLong = 48, kVeryLong = 96;
  const std::size_t n = samples.count, first = samples.first,
                    step = n < kVeryLong       ? 8
                           : n < 2 * kVeryLong ? 16
                                               : 32,
                    few = n < kLong ? n : n % step, skip = step / 2 - 1;
  RowSums all, some;
  all.add(samples, first, few / 2, 2);
  if (few % 2 != 0) all.add_one(samples.s[first + few - 1], samples.w[first + few - 1]);
  some.add(samples, first + few + skip, (n - few) / step, step);
  all.add(some, static_cast<double>(step) / 2.0);
  const auto [ps, pw, ww] = all.totals(static_cast<double>(n));
  const std::array<double, 5> pc{1.0, c, c * c, c * c * c, c * c * c * c};
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; i + j < 5; ++j) s_[i][j] += ps[i] * pc[j];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; i + j < 3; ++j) w_[i][j] += pw[i] * pc[j];
  ww_ += ww;
}

void PatchSums::add(const PatchSums& other) noexcept {
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; i + j < 5; ++j) s_[i][j] += other.s_[i][j];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; i + j < 3; ++j) w_[i][j] += other.w_[i][j];
  ww_ += other.ww_;
}

double PatchSums::moment(std::size_t i, std::size_t j, double s0, double c0) const noexcept {
  double sum = 0.0;
  for (std::size_t a = 0; a <= i; ++a)
    for (std::size_t b = 0; b <= j; ++b)
      sum += kBinomial[i][a] * kBinomial[j][b] * power(-s0, i - a) * power(-c0, j - b) * s_[a][b];
  return sum;
}

double PatchSums::lifted(std::size_t i, std::size_t j, double s0, double c0, double w0) const noexcept {
  double sum = 0.0;
  for (std::size_t a = 0; a <= i; ++a)
    for (std::size_t b = 0; b <= j; ++b)
      sum += kBinomial[i][a] * kBinomial[j][b] * power(-s0, i - a) * power(-c0, j - b) * (w_[a][b] - w0 * s_[a][b]);
  return sum;
}

PatchPlane PatchSums::plane() const noexcept {
  PatchPlane out;
  const double n = count();
  out.s = s_[1][0] / n;
  out.c = s_[0][1] / n;
  out.w = w_[0][0] / n;
  const double ss = moment(2, 0, out.s, out.c), sc = moment(1, 1, out.s, out.c), cc = moment(0, 2, out.s, out.c);
  const double sw = lifted(1, 0, out.s, out.c, out.w), cw = lifted(0, 1, out.s, out.c, out.w);
  const double det = ss * cc - sc * sc;
  if (det > 1e-9 * ss * cc && det > 0.0) {
    out.gs = (sw * cc - cw * sc) / det;
    out.gc = (cw * ss - sw * sc) / det;
  } else if (ss >= cc && ss > 0.0) {
    out.gs = sw / ss;
  } else if (cc > 0.0) {
    out.gc = cw / cc;
  }
  return out;
}

std::pair<double, double> PatchSums::box() const noexcept {
  const double n = count();
  const double s0 = s_[1][0] / n, c0 = s_[0][1] / n;
  const double ss = moment(2, 0, s0, c0) / n, sc = moment(1, 1, s0, c0) / n, cc = moment(0, 2, s0, c0) / n;
  const double middle = 0.5 * (ss + cc), spread = std::hypot(0.5 * (ss - cc), sc);
  const auto side = [](double variance) { return std::sqrt(12.0 * std::max(0.0, variance)); };
  return {side(middle + spread), side(middle - spread)};
}

// Normal equations of terms 1, s, c, ss, sc, cc about the middle of the samples.
struct PatchSums::Quadric {
  System equations{};
  double count = 0.0, s = 0.0, c = 0.0, w = 0.0;
  double square = 0.0; // of heights about their mean, sum

  [[nodiscard]] std::array<double, 6> solved(std::size_t terms) const { return solve(equations, terms); }
  // Sum of squares about the best surface of so many terms.
  [[nodiscard]] double left(std::size_t terms) const {
    const auto x = solved(terms);
    double sum = square;
    for (std::size_t a = 0; a < terms; ++a) sum -= x[a] * equations[a][6];
    return std::max(0.0, sum);
  }
};

PatchSums::Quadric PatchSums::quadric() const noexcept {
  constexpr std::array<std::array<std::size_t, 2>, 6> kTerms = {{{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};
  Quadric q;
  q.count = count();
  q.s = s_[1][0] / q.count;
  q.c = s_[0][1] / q.count;
  q.w = w_[0][0] / q.count;
  for (std::size_t a = 0; a < 6; ++a) {
    for (std::size_t b = 0; b < 6; ++b)
      q.equations[a][b] = moment(kTerms[a][0] + kTerms[b][0], kTerms[a][1] + kTerms[b][1], q.s, q.c);
    q.equations[a][6] = lifted(kTerms[a][0], kTerms[a][1], q.s, q.c, q.w);
  }
  q.square = ww_ - q.count * q.w * q.w;
  return q;
}

double PatchSums::turning(double noise) const {
  constexpr double kOfNoise = 25.0; // what a quadric takes off the sum of squares, in variances: five sigma
  const Quadric sums = quadric();
  if (sums.left(3) - sums.left(6) <= kOfNoise * noise * noise) return 0.0;
  const auto x = sums.solved(6);
  const double middle = x[3] + x[5], spread = std::hypot(x[3] - x[5], x[4]); // second derivatives: their sum and difference
  const double square = 1.0 + x[1] * x[1] + x[2] * x[2];
  const double curvature = (std::abs(middle) + spread) / (square * std::sqrt(square));
  return curvature * box().second * 180.0 / std::numbers::pi;
}

double PatchSums::misfit_with(const PatchSums& other, double noise) const {
  PatchSums both = *this;
  both.add(other);
  const double here = quadric().left(6), there = other.quadric().left(6);
  const double more = (both.quadric().left(6) - here - there) / std::min(count(), other.count());
  return more / (noise * noise + std::max(here / count(), there / other.count()));
}

void PatchSums::describe(const Frame& frame, const Sampling& sampling, const Vector3& origin, Patch& out) const {
  const Quadric sums = quadric();
  const double n = sums.count;
  const auto residual = [&](std::size_t terms) { return std::sqrt(sums.left(terms) / n); };
  const auto plane = sums.solved(3);
  const auto quadric = sums.solved(6);
  out.plane_residual_mm = residual(3);
  out.quadric_residual_mm = residual(6);
  const double gs = plane[1], gc = plane[2];
  const double steep = std::sqrt(1.0 + gs * gs + gc * gc);
  out.samples = static_cast<std::uint64_t>(n);
  out.area_mm2 = n * sampling.pitch * sampling.spacing * steep;
  out.centroid = frame.position(sums.s, sums.w, sums.c);
  out.normal = frame.position(-gs / steep, 1.0 / steep, -gc / steep);
  for (std::size_t i = 0; i < 3; ++i) out.centroid[i] += origin[i];
  constexpr double kClose = 2.0; // sigmas of noise
  const double limit = std::max(kClose * sampling.noise, 0.003);
  if (out.plane_residual_mm <= limit) {
    out.shape = PatchShape::plane;
    return;
  }
  // A cylinder bends one way only: one principal curvature of the quadric is small against the other.
  const double a = quadric[3], b = quadric[4] / 2.0, c = quadric[5];
  const double middle = (a + c) / 2.0, spread = std::hypot((a - c) / 2.0, b);
  const double large = std::max(std::abs(middle + spread), std::abs(middle - spread));
  const double small = std::min(std::abs(middle + spread), std::abs(middle - spread));
  const bool cylinder = out.quadric_residual_mm <= 3.0 * limit && small < 0.15 * large;
  out.shape = cylinder ? PatchShape::cylinder : PatchShape::free_form;
}

} // namespace scansion
