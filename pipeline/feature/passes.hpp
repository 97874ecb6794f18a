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

/// As apart(), for a row of columns: |bend[i]| >= least or |next[i] - height[i]| > rise.
struct ColumnLimits {
  float least = 0.0F, rise = 0.0F;
};
[[nodiscard]] std::size_t bent_or_stepped(const float* bend, const float* height, const float* next, const ColumnLimits& limits,
                                          std::uint32_t* indexes, std::size_t n) noexcept;

/// Walls between rows of columns: marks[i] becomes `mark` unless the step from rows[1] to rows[2] starts no wall: one that is
/// `weak` or less, or `steep` or less and not as lonely as `lonely`, the share of it above which a step before or after it
/// shows that it goes on.
struct WallLimits {
  float weak = 0.0F, steep = 0.0F, lonely = 0.0F;
};
void mark_walls(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark, std::uint32_t* marks,
                std::size_t n) noexcept;

/// As apart(), for values[i] >= limit.
[[nodiscard]] std::size_t reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept;

/// How values stand to an even row that begins with the first of them: 1 / step, and what heights are above.
struct EvenRow {
  double per_mm = 1.0;
  double base = 0.0; ///< mm
};
struct Shifts {
  float least = 0.0F, largest = 0.0F;
};
/// How far each place is from where the row has it, in steps, and each height above the base.
Shifts stand(const double* places, const double* heights, const EvenRow& row, float* shift, float* height,
             std::size_t n) noexcept;

/// A run of samples as stand() has them, and columns one step apart: column i lies `ahead` of the even row's place for sample
/// i. Limits in steps, but for `jump`.
struct ColumnRun {
  static constexpr std::size_t kBlock = 16; ///< columns
  const float *shift = nullptr, *height = nullptr;
  float ahead = 0.0F;
  float slack = 0.0F;  ///< a column may lie so far on the other side of its samples
  float widest = 0.0F; ///< between the two samples
  float jump = 0.0F;   ///< mm, up
};
/// Heights of the columns of up to `count` blocks, each between samples i and i + 1, and the nearer of the two, counted from
/// `first`. Ends before the first block whose samples do not stand like this; in that block anything may have been written.
/// Returns how many went before it.
[[nodiscard]] std::size_t sample_columns(const ColumnRun& run, std::uint32_t first, std::size_t count, float* height,
                                         std::uint32_t* nearest) noexcept;

/// to[i] = weights[0] * rows[0][i] + weights[1] * rows[1][i] + ..., `count` of them, added in this order.
void weigh(const float* const* rows, const float* weights, std::size_t count, float* to, std::size_t n) noexcept;

/// The baseline versions of those that are not the same source for both, for tests.
namespace portable {
[[nodiscard]] std::size_t apart(const double* a, const double* b, double limit, std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t apart(const float* a, const float* b, float limit, std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t bent_or_stepped(const float* bend, const float* height, const float* next, const ColumnLimits& limits,
                                          std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept;
} // namespace portable

} // namespace scansion::passes
