// Weights of the fitted prediction: least squares over a sample of the rest.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/rest_coder.hpp"

namespace scansion {

/// Collects deviations and what they should have predicted, then solves for the weights.
class WeightFit {
public:
  void add(const Deviations& d, std::int64_t target) noexcept;
  [[nodiscard]] Weights solve() const noexcept;

private:
  std::array<std::array<double, kNeighbours>, kNeighbours> normal_{};
  std::array<double, kNeighbours> right_{};
};

} // namespace scansion
