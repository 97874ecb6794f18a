// Loops over all samples of a line: without branches and without dependence from sample to sample. Each is compiled for the
// baseline and again for AVX2, with the same results: nothing is added up but whole numbers, and nothing is fused.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace scansion::passes {

/// From counts to a place along the line and a height: mm per count, then unit vectors. `along` has no part in z.
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

/// How values stand against an even grid with one of them to each of its steps, the first one at its beginning.
struct Grid {
  double per_mm = 1.0;
  float low = 0.0F, high = 0.0F; ///< shifts in steps of the grid: none below `low`, and all below `high`?
  float even = 0.0F;             ///< and none larger than this, up or down?
};
struct Standing {
  bool inside = false, even = false;
};
[[nodiscard]] Standing standing(const double* values, const Grid& grid, std::size_t n) noexcept;

/// Columns at (first + i) * pitch, with s[i] before each and s[i + 1] behind it, or hardly on the other side; in blocks.
struct ColumnBlocks {
  static constexpr std::size_t kSize = 16;     ///< columns of a block
  double first = 0.0, pitch = 1.0, base = 0.0; ///< pitch in mm; base: of heights
  double widest = 0.0, jump = 0.0;             ///< mm between the two samples, up
  double slack = 0.0;                          ///< mm
};
/// A run of samples: places, heights, numbers in the scan line.
struct ColumnSamples {
  const double *s = nullptr, *w = nullptr;
  const std::uint32_t* number = nullptr;
};
/// Heights of the columns of up to `count` blocks, and the number of the sample nearest to each. Ends before the first block
/// whose samples do not stand like this, or where another sample is the last one before its first column. In that block
/// anything may have been written. Returns how many went before it.
[[nodiscard]] std::size_t sample_columns(const ColumnSamples& samples, const ColumnBlocks& blocks, std::size_t count,
                                         float* height, std::uint32_t* source) noexcept;

/// to[i] = weights[0] * rows[0][i] + weights[1] * rows[1][i] + ..., `count` of them, added in this order.
void weigh(const float* const* rows, const float* weights, std::size_t count, float* to, std::size_t n) noexcept;

/// to[i] = from[i] - base.
void lower(const double* from, double base, float* to, std::size_t n) noexcept;

/// The baseline versions of those that are not the same source for both, for tests.
namespace portable {
[[nodiscard]] std::size_t apart(const double* a, const double* b, double limit, std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t apart(const float* a, const float* b, float limit, std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t bent_or_stepped(const float* bend, const float* height, const float* next, const ColumnLimits& limits,
                                          std::uint32_t* indexes, std::size_t n) noexcept;
[[nodiscard]] std::size_t reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept;
} // namespace portable

} // namespace scansion::passes
