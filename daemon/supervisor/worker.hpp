// The pipeline worker of one device: lines to groups to recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/supervisor/session_shared.hpp"

namespace scansion {

/// The body of the worker's thread. Returns when the queue is closed and empty, with all groups written and the recording
/// finished.
void record_lines(SessionShared& shared, const SessionSettings& settings, const JournalPorts& ports);

} // namespace scansion
