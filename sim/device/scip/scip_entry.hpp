// scansim scip: the entry of the simulated SCIP 2 line scanner.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/cli/device_verb.hpp"

namespace scansion {

[[nodiscard]] SimulatedDevice scip_entry();

} // namespace scansion
