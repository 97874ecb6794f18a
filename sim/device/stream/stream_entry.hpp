// scansim stream: the entry of the simulated digitizer that prints points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/cli/device_verb.hpp"

namespace scansion {

[[nodiscard]] SimulatedDevice stream_entry();

} // namespace scansion
