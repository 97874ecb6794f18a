// The body of a lines payload: which lines, stamps and runs a group has (docs/FORMAT.md, "Lines").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/axis_scale.hpp"
#include "pipeline/codec/fan.hpp"
#include "pipeline/codec/varint.hpp"

namespace scansion {

/// What all points of a group share.
struct GroupFacts {
  AxisScales scales;
  Fan fan;            ///< empty for most
  bool exact = false; ///< IEEE residuals are kept
};

void write_line_table(const LineGroup& group, const GroupFacts& facts, Bytes& to);

/// Fills lines and runs of `group`; checks every count against `header`.
[[nodiscard]] Result<void> read_line_table(ByteView table, const PayloadHeader& header, LineGroup& group, GroupFacts& facts);

} // namespace scansion
