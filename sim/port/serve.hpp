// Puts a device model on a port and keeps it going, faults included.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/device_model.hpp"
#include "sim/port/fault_plan.hpp"
#include "sim/port/port.hpp"

#include <functional>

namespace scansion {

struct ServeCounts {
  std::uint64_t messages = 0; ///< sent whole
  std::uint64_t dropped = 0;  ///< not sent: the host read too slowly, or the device was muted
};

/// Runs until `stop` says so. `waits_for_host`: at maximum rate nothing is dropped, the device is as slow as its host; else a
/// message that does not fit is dropped, as hardware does. Faults that neither port nor device know fail with usage at once.
[[nodiscard]] Result<ServeCounts> serve(DeviceModel& device, Port& port, FaultPlan& faults, bool waits_for_host,
                                        const std::function<bool()>& stop);

} // namespace scansion
