// Weights of the fitted prediction.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/fit.hpp"

#include "pipeline/codec/frequencies.hpp"
#include "pipeline/codec/kernels.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

Weights WeightFit::solve(Normal l, std::size_t count) const noexcept {
  // Cholesky with a small ridge: neighbours that never differ from their chord get weight 0.
  double trace = 0;
  for (std::size_t i = 0; i < count; ++i) trace += l[i][i];
  const double ridge = 1e-6 * trace / static_cast<double>(count) + 1e-9;
  std::array<double, kWeights> w{};
  for (std::size_t i = 0; i < count; ++i) w[i] = l[i][kWeights];
  for (std::size_t i = 0; i < count; ++i) {
    l[i][i] += ridge;
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = l[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / l[j][j];
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < i; ++k) w[i] -= l[i][k] * w[k];
    w[i] /= l[i][i];
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t k = i + 1; k < count; ++k) w[i] -= l[k][i] * w[k];
    w[i] /= l[i][i];
  }
  Weights out{};
  constexpr double kUnit = 1 << kWeightBits;
  for (std::size_t i = 0; i < count; ++i)
    out[i] = static_cast<std::int16_t>(std::lround(std::clamp(w[i] * kUnit, -32767.0, 32767.0)));
  return out;
}

std::uint64_t WeightFit::cost(const Weights& weights) const noexcept {
  std::uint64_t sum = 0;
  for (const Sample& s : rows_) {
    std::int64_t guess = std::int64_t{1} << (kWeightBits - 1);
    for (std::size_t k = 0; k < kWeights; ++k) guess += std::int64_t{weights[k]} * s.deviations[k];
    sum += log2_fixed(2 * static_cast<std::uint32_t>(size_of(wrap(s.target - (guess >> kWeightBits)))) + 1);
  }
  return sum;
}

WeightFit::Normal WeightFit::normal_of(const Weights* w) const noexcept {
  // Each row counts by the inverse square of its own size: edges, where nothing can be predicted, must not decide.
  Normal normal{};
  const std::size_t stride = w != nullptr ? 2 : 1;
  for (std::size_t row = 0; row < rows_.size(); row += stride) {
    const Sample& s = rows_[row];
    std::array<double, kColumns> x{};
    double size = std::abs(static_cast<double>(s.target));
    for (std::size_t i = 0; i < kWeights; ++i) {
      x[i] = s.deviations[i];
      size += std::abs(x[i]);
    }
    x[kWeights] = s.target;
    size /= kWeights + 1;
    double importance = 1.0 / (size * size + 30.0);
    if (w != nullptr) {
      std::int64_t guess = 2048;
      for (std::size_t k = 0; k < kWeights; ++k) guess += std::int64_t{(*w)[k]} * s.deviations[k];
      const double r = static_cast<double>(wrap(s.target - (guess >> kWeightBits)));
      importance = 1.0 / (r * r / 2 + size * size / 2 + 30.0);
    }
    kernels::add_products(x.data(), importance, normal[0].data(), kWeights);
  }
  return normal;
}

Weights WeightFit::solve() const noexcept {
  Normal normal = normal_of(nullptr);
  const Weights all = solve(normal, kWeights);
  const Weights without = solve(normal, kLeft + kBeside);
  const bool more = cost(all) < cost(without);
  const Weights first = more ? all : without;
  const Weights second = solve(normal_of(&first), more ? kWeights : kLeft + kBeside);
  return cost(second) < cost(first) ? second : first;
}

} // namespace scansion
