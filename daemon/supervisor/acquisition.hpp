// The acquisition thread of one device: opens it, takes its lines, opens it again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/supervisor/session_shared.hpp"

namespace scansion {

/// The body of the thread. Returns after stop(), at the end of a recorded source, or when the device was given up; the queue
/// is closed then.
/// `on_fault` is called each time the device was lost or not understood.
void acquire(SessionShared& shared, Driver& driver, const SessionPolicy& policy, const std::function<void()>& on_fault);

} // namespace scansion
