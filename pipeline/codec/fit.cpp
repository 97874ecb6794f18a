// Weights of the fitted prediction.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/fit.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

void WeightFit::add(const Deviations& d, std::int64_t target) noexcept {
  std::array<double, kNeighbours> x;
  for (std::size_t i = 0; i < kNeighbours; ++i) x[i] = static_cast<double>(d[i]);
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    for (std::size_t j = 0; j <= i; ++j) normal_[i][j] += x[i] * x[j];
    right_[i] += x[i] * static_cast<double>(target);
  }
}

Weights WeightFit::solve() const noexcept {
  // Cholesky with a small ridge: neighbours that never differ from their chord get weight 0.
  auto l = normal_;
  double trace = 0;
  for (std::size_t i = 0; i < kNeighbours; ++i) trace += l[i][i];
  const double ridge = 1e-6 * trace + 1.0;
  std::array<double, kNeighbours> w = right_;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    l[i][i] += ridge;
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = l[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = i == j ? std::sqrt(std::max(sum, 1e-9)) : sum / l[j][j];
    }
  }
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    for (std::size_t k = 0; k < i; ++k) w[i] -= l[i][k] * w[k];
    w[i] /= l[i][i];
  }
  for (std::size_t i = kNeighbours; i-- > 0;) {
    for (std::size_t k = i + 1; k < kNeighbours; ++k) w[i] -= l[k][i] * w[k];
    w[i] /= l[i][i];
  }
  Weights out{};
  constexpr double kUnit = 1 << kWeightBits;
  for (std::size_t i = 0; i < kNeighbours; ++i)
    out[i] = static_cast<std::int16_t>(std::lround(std::clamp(w[i] * kUnit, -32767.0, 32767.0)));
  return out;
}

} // namespace scansion
