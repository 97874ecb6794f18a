// scansim gocator: the entry of the simulated laser profiler.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/cli/device_verb.hpp"

namespace scansion {

[[nodiscard]] SimulatedDevice gocator_entry();

} // namespace scansion
