// Weights of the fitted prediction: least squares over a sample of the rest. The encoder's choice alone: the reader is told.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/rest_model.hpp"

namespace scansion {

/// Collects deviations and what they should have predicted, then solves for the weights that serve best.
class WeightFit {
public:
  using Row = std::array<std::int32_t, kWeights>;

  void clear() noexcept { rows_.clear(); }
  void add(const Row& deviations, std::int32_t target) {
    Sample& s = rows_.emplace_back();
    std::ranges::copy(deviations, s.begin());
    s[kWeights] = target;
  }
  struct Fitted {
    Weights weights;
    bool with_above; ///< else only the first kLineWeights count
  };
  /// Tries the weights with and without the line before; without is taken where with gives next to nothing.
  [[nodiscard]] Fitted solve();

private:
  static constexpr std::size_t kColumns = 16; // the deviations, the target, nothing
  using Sample = std::array<std::int32_t, kColumns>;
  using Normal = std::array<std::array<double, kColumns>, kWeights>;
  void measure();
  [[nodiscard]] Normal normal_of(const std::int32_t* left, std::size_t count);
  [[nodiscard]] static Weights solve(Normal normal, std::size_t count) noexcept;
  [[nodiscard]] std::uint64_t cost(const Weights& weights, std::size_t count, std::vector<std::int32_t>& left) const;
  std::vector<Sample> rows_;
  std::vector<double> sizes_; ///< mean size of what stands in each row
  std::vector<double> usual_, factors_;
  std::vector<std::int32_t> left_, best_left_; ///< of each row, by weights
  double floor_ = 1.0;
};

} // namespace scansion
