// The G-code lines this driver sends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/grbl-probe/raster.hpp"

#include <string>

namespace scansion::grbl {

/// G53: targets in machine coordinates, as the controller reports contacts.
[[nodiscard]] std::string lift_line(Um z);
[[nodiscard]] std::string traverse_line(Um x, Um y);
/// Toward the part, without an alarm when nothing is met. `z` in work coordinates: G53 does not go with G38.
[[nodiscard]] std::string probe_line(Um z, double feed);

/// Its ok means that all motion is over; that of a G0 means only that it is planned.
inline constexpr std::string_view kFence = "G4P0";

} // namespace scansion::grbl
