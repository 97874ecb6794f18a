// Loops over all samples of a line: without branches and without dependence from sample to sample. Each is compiled for the
// baseline and again for AVX2, with the same results: nothing is added up but whole numbers, and nothing is fused.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace scansion::passes {

/// From counts to a place along the line and a height: mm per count, then unit vectors. `along` has no part in z. Axes that
/// have no part in either are not looked at.
struct Projection {
  double resolution = 1.0;
  std::array<double, 3> along{}, up{};
};
/// `xyz`: n values each.
void project(const std::array<const std::int32_t*, 3>& xyz, const Projection& projection, double* s, double* w,
             std::size_t n) noexcept;

[[nodiscard]] std::int64_t sum(const std::int32_t* values, std::size_t n) noexcept;

/// How many of the values are no larger than the one before.
[[nodiscard]] std::size_t count_back(const double* values, std::size_t n) noexcept;
[[nodiscard]] std::size_t count_back(const std::int32_t* values, std::size_t n) noexcept;

/// Writes the i with |a[i] - b[i]| > limit to `indexes`, which has room for n, and returns how many they are.
[[nodiscard]] std::size_t apart(const double* a, const double* b, double limit, std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t apart(const float* a, const float* b, float limit, std::uint32_t* indexes, std::size_t n) noexcept;

/// As apart(), for values[i] >= limit.
[[nodiscard]] std::size_t reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept;

/// The baseline versions of those that are not the same source for both, for tests.
namespace portable {
[[nodiscard]] std::size_t apart(const double* a, const double* b, double limit, std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t apart(const float* a, const float* b, float limit, std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept;
} // namespace portable

} // namespace scansion::passes
