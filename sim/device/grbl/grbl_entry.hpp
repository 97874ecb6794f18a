// scansim grbl: a Grbl or grblHAL machine with a touch probe over the played scan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/cli/device_verb.hpp"

namespace scansion {

[[nodiscard]] SimulatedDevice grbl_entry();

} // namespace scansion
