// Which points of each run a level adds, told from the vertices of the line before (docs/FORMAT.md, "Positions").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/group_state.hpp"
#include "pipeline/codec/symbols.hpp"

namespace scansion {

/// A vertex may have moved this many samples from the line before and still be called the same.
inline constexpr int kDrift = 2;

// Which inner points of the runs a level adds is told in one of two ways; `points` are they, ascending, and `state.known` holds
// the coarser vertices.

/// The vertices of the line before are candidates. Fills `state.fresh` and `state.vertices`.
void write_following(std::span<const Run> runs, std::span<const PointIndex> points, GroupState& state, SymbolWriter& to);

/// Each line by itself. Leaves the state to take_alone().
void write_alone(std::span<const PointIndex> points, const GroupState& state, SymbolWriter& to);
void take_alone(std::span<const Run> runs, std::span<const PointIndex> points, GroupState& state);

/// Reads them back, and fills the state. `limit` is how many the level may have.
[[nodiscard]] Result<void> read_positions(std::span<const Run> runs, bool follow, GroupState& state, std::size_t limit,
                                          SymbolReader& from);

} // namespace scansion
