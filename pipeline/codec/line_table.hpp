// The body of a lines payload: which lines, stamps and runs a group has (docs/FORMAT.md, "Lines").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/axis_scale.hpp"
#include "pipeline/codec/varint.hpp"

namespace scansion {

void write_line_table(const LineGroup& group, const AxisScales& scales, bool exact, Bytes& to);

/// Fills lines and runs of `group`; checks every count against `header`.
[[nodiscard]] Result<void> read_line_table(ByteView table, const PayloadHeader& header, LineGroup& group, AxisScales& scales,
                                           bool& exact);

} // namespace scansion
