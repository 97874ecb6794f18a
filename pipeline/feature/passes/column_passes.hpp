// Loops over all columns of a row, as those of passes.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace scansion::passes {

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

/// Of each whole block of so many columns, the greatest sizes in so many lanes; the greatest of these is that of the block.
inline constexpr std::size_t kPeakBlock = 32, kPeakLanes = 8;
[[nodiscard]] constexpr std::size_t peaks_of(std::size_t n) noexcept {
  return n / kPeakBlock * kPeakLanes;
}

/// to[i] = weights[0] * rows[0][i] + weights[1] * rows[1][i] + ..., `count` of them, added in this order. `peaks` has room for
/// peaks_of(n); what is not a number is none.
void weigh(const float* const* rows, const float* weights, std::size_t count, float* to, float* peaks, std::size_t n) noexcept;

/// The bends of a row of columns, and of rows before and after it.
struct BendRows {
  const float *own = nullptr, *peaks = nullptr; ///< as weigh() has them
  std::span<const float*const> before, after;
};
/// Writes the i with |own[i]| >= least to `indexes`, which has room for n, where no row before bends as much the same way and
/// no row after more; what is not a number bends nowhere. Returns how many they are.
[[nodiscard]] std::size_t most_bent(const BendRows& rows, float least, std::uint32_t* indexes, std::size_t n) noexcept;

/// Walls between rows of columns: marks[i] becomes `mark` unless the step from rows[1] to rows[2] starts no wall: one that is
/// `weak` or less, or `steep` or less and not as lonely as `lonely`, the share of it above which a step before or after it
/// shows that it goes on.
struct WallLimits {
  float weak = 0.0F, steep = 0.0F, lonely = 0.0F;
};
/// Returns whether any was marked.
bool mark_walls(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark, std::uint32_t* marks,
                std::size_t n) noexcept;

/// The baseline version of what is not the same source for both, for tests.
namespace portable {
[[nodiscard]] std::size_t most_bent(const BendRows& rows, float least, std::uint32_t* indexes, std::size_t n) noexcept;
} // namespace portable

} // namespace scansion::passes
