// Weights of the fitted prediction.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/fit.hpp"

#include "pipeline/codec/fit_kernels.hpp"
#include "pipeline/codec/log2_fixed.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
Weights WeightFit::solve(Normal l, std::size_t count) noexcept {
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

std::uint64_t WeightFit::cost(const Weights& weights, std::size_t count, std::vector<std::int32_t>& left) const {
  std::array<double, kColumns> w{};
  std::copy_n(weights.begin(), count, w.begin());
  left.resize(rows_.size());
  kernels::left_over(rows_.data()->data(), w.data(), left.data(), rows_.size());
  std::uint64_t sum = 0;
  for (const std::int32_t l : left) sum += log2_fixed(2 * static_cast<std::uint32_t>(size_of(l)) + 1);
  return sum;
}

// Each row counts by the inverse square of its own size: edges, where nothing can be predicted, must not decide. What is
// smaller than usual counts like the usual: there rounding decides.
void WeightFit::measure() {
  sizes_.resize(rows_.size());
  kernels::row_amounts(rows_.data()->data(), sizes_.data(), rows_.size());
  for (double& size : sizes_) size /= kWeights - kMeans + 1;
  usual_.assign(sizes_.begin(), sizes_.end());
  const auto middle = usual_.begin() + static_cast<std::ptrdiff_t>(usual_.size() / 2);
  std::ranges::nth_element(usual_, middle);
  constexpr double kShare = 0.3;
  floor_ = kShare * *middle * *middle + 1.0;
}

// With weights at hand a row counts by what they leave of it, too. The first weights are for a choice and need fewer rows.
WeightFit::Normal WeightFit::normal_of(const std::int32_t* left, std::size_t count) {
  Normal normal{};
  const std::size_t stride = left != nullptr ? 1 : 2;
  factors_.clear();
  for (std::size_t row = 0; row < rows_.size(); row += stride) {
    double square = sizes_[row] * sizes_[row];
    if (left != nullptr) square = (square + static_cast<double>(left[row]) * static_cast<double>(left[row])) / 2;
    factors_.push_back(1.0 / (square + floor_));
  }
  kernels::add_products(rows_.data()->data(), stride, factors_.data(), factors_.size(), normal[0].data(), count);
  return normal;
}

WeightFit::Fitted WeightFit::solve() {
  if (rows_.empty()) return {};
  measure();
  const Normal normal = normal_of(nullptr, kWeights);
  // The line alone, then with the points beside from their own chord, then from the chord here as well: each of them can be
  // what spoils the fit. Leaving the line before alone is faster on either side, so little is given up for that.
  constexpr std::uint64_t kWorth = 128;
  std::size_t count = kLineWeights;
  Weights first = solve(normal, count);
  std::uint64_t first_cost = cost(first, count, best_left_);
  std::uint64_t limit = first_cost - first_cost / kWorth;
  for (const std::size_t more : {kLineWeights + kBeside, kWeights}) {
    const Weights weights = solve(normal, more);
    const std::uint64_t now = cost(weights, more, left_);
    if (now >= limit) continue;
    count = more;
    first = weights;
    best_left_.swap(left_);
    first_cost = limit = now;
  }
  const Weights second = solve(normal_of(best_left_.data(), count), count);
  return {cost(second, count, left_) < first_cost ? second : first, count > kLineWeights};
}

} // namespace scansion
