// Which points of each run a level adds, told from the vertices of the line before (docs/FORMAT.md, "Positions").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/group_state.hpp"
#include "pipeline/codec/symbols.hpp"

namespace scansion {

/// A vertex may have moved this many samples from the line before and still be called the same.
inline constexpr int kDrift = 2;

/// Writes which inner points of the runs the level adds: `points`, ascending. Fills `state.fresh` and `state.vertices`;
/// `state.known` holds the coarser vertices. `follow`: the vertices of the line before are candidates.
void write_positions(std::span<const Run> runs, std::span<const PointIndex> points, bool follow, GroupState& state,
                     SymbolWriter& to);

/// Reads them back. `limit` is how many the level may have.
[[nodiscard]] Result<void> read_positions(std::span<const Run> runs, bool follow, GroupState& state, std::size_t limit,
                                          SymbolReader& from);

} // namespace scansion
