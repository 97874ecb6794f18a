// Two numbers that are worked on alike: lanes of one vector.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace scansion {

using Pair = double __attribute__((vector_size(2 * sizeof(double))));

[[nodiscard]] inline Pair both(double value) noexcept {
  return Pair{value, value};
}
[[nodiscard]] inline double sum(Pair x) noexcept {
  return x[0] + x[1];
}
[[nodiscard]] inline double difference(Pair x) noexcept {
  return x[1] - x[0];
}
[[nodiscard]] inline Pair larger(Pair a, Pair b) noexcept {
  return a > b ? a : b;
}
[[nodiscard]] inline Pair root(Pair x) noexcept {
  return Pair{std::sqrt(x[0]), std::sqrt(x[1])};
}

} // namespace scansion
