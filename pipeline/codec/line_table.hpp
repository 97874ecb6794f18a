// The body of a lines payload: which lines, stamps and runs a group has (docs/FORMAT.md, "Lines").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/varint.hpp"
#include "pipeline/model/scan_line.hpp"

namespace scansion {

/// Coordinates of one axis are stored as v = base + step * u.
struct AxisScale {
  std::int32_t base = 0;
  std::uint32_t step = 1;
  friend bool operator==(const AxisScale&, const AxisScale&) = default;
};
using AxisScales = std::array<AxisScale, 3>;

/// The largest step that all values of the axis share, with a base such that every u fits 32 bits.
[[nodiscard]] AxisScale find_scale(std::span<const std::int32_t> values) noexcept;

void write_line_table(const LineGroup& group, const AxisScales& scales, bool exact, Bytes& to);

/// Fills lines and runs of `group`; checks every count against `header`.
[[nodiscard]] Result<void> read_line_table(ByteView table, const PayloadHeader& header, LineGroup& group, AxisScales& scales,
                                           bool& exact);

} // namespace scansion
