// The lattice of one axis of a group: which step its values share, and whether they lie evenly along every run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/scan_line.hpp"

#include <span>

namespace scansion {

/// Coordinates of one axis are v = base + step * u + remainder. All arithmetic that both sides do is modulo 2^32.
struct AxisScale {
  std::int32_t base = 0;
  std::uint32_t step = 1;
  bool split = false; ///< some remainder is not 0, so all are stored; |remainder| <= step / 2
  bool even = false;  ///< in every run, u goes from the first to the last point in equal steps
  bool ruled = false; ///< and even, which then says no more than that u is known from the coarsest level on

  [[nodiscard]] std::int64_t steps(std::int32_t v) const noexcept {
    const std::int64_t off = std::int64_t{v} - base + step / 2;
    const auto s = std::int64_t{step};
    return off / s - (off % s < 0 ? 1 : 0);
  }
  [[nodiscard]] std::int64_t remainder(std::int32_t v) const noexcept {
    return std::int64_t{v} - base - static_cast<std::int64_t>(step) * steps(v);
  }
  friend bool operator==(const AxisScale&, const AxisScale&) = default;
};
using AxisScales = std::array<AxisScale, 3>;

/// The largest step that all values share; or a power of ten times it that nearly all share (text with a fixed number of
/// significant digits), with remainders. The base makes every u fit 32 bits.
[[nodiscard]] AxisScale find_scale(std::span<const std::int32_t> values) noexcept;
/// The same for an axis of a group; looks for even runs first. `scratch` is overwritten.
[[nodiscard]] AxisScale find_scale(std::span<const std::int32_t> values, std::span<const Run> runs,
                                   std::vector<std::int32_t>& scratch);

/// u of every value. `scale` must come from find_scale() over these values.
void to_steps(std::span<const std::int32_t> values, const AxisScale& scale, std::span<std::int32_t> u) noexcept;
/// Only of the first and last points of runs: all there is to say of an even axis.
void ends_to_steps(std::span<const std::int32_t> values, const AxisScale& scale, std::span<const Run> runs,
                   std::span<std::int32_t> u) noexcept;

} // namespace scansion
