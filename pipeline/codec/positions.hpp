// Which points of each run belong to a level (docs/FORMAT.md, "Positions").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/group_state.hpp"
#include "pipeline/codec/planes.hpp"

namespace scansion {

/// Writes how many points of each run have alpha-width `level`, and how many still unknown points lie before each of them. End
/// points of runs are known to be in level 0.
void write_positions(std::span<const Run> runs, std::span<const std::uint8_t> width, std::uint8_t level, PlaneWriter& planes,
                     Bytes& to);

/// Reads them back: sets `width` to `level` and fills `fresh`. `count` is the number of points the level must have.
[[nodiscard]] Result<void> read_positions(ByteReader& from, std::span<const Run> runs, std::span<std::uint8_t> width,
                                          std::uint8_t level, std::size_t count, PlaneReader& planes,
                                          std::vector<PointIndex>& fresh);

} // namespace scansion
