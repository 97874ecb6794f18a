// The body of a lines payload: which lines, stamps and runs a group has (docs/FORMAT.md, "Lines").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/varint.hpp"
#include "pipeline/model/scan_line.hpp"

namespace scansion {

/// Coordinates of one axis are stored as v = base + step * u + remainder.
struct AxisScale {
  std::int32_t base = 0;
  std::uint32_t step = 1;
  bool split = false; ///< some remainder is not 0, so all are stored; |remainder| <= step / 2

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

/// The largest step that all values of the axis share; or a power of ten times it that nearly all share (text with a fixed
/// number of significant digits), with remainders. The base makes every u fit 32 bits.
[[nodiscard]] AxisScale find_scale(std::span<const std::int32_t> values) noexcept;

void write_line_table(const LineGroup& group, const AxisScales& scales, bool exact, Bytes& to);

/// Fills lines and runs of `group`; checks every count against `header`.
[[nodiscard]] Result<void> read_line_table(ByteView table, const PayloadHeader& header, LineGroup& group, AxisScales& scales,
                                           bool& exact);

} // namespace scansion
