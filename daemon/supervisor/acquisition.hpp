// The acquisition thread of one device: opens it, takes its lines, opens it again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/supervisor/session_shared.hpp"

namespace scansion {

/// The body of the thread. Returns after stop(), at the end of a recorded source, or when the device was given up; the queue
/// is closed then.
void acquire(SessionShared& shared, Driver& driver, const SessionPolicy& policy);

} // namespace scansion
