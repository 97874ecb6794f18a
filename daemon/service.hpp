// The daemon's life: start, signals, watchdog, stop.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/config/config.hpp"

namespace scansion {

inline constexpr const char* kVersion = SCANSION_VERSION;

/// Runs until SIGTERM or SIGINT; SIGHUP reads the configuration again. Returns the process exit code. Call from the main thread
/// before any other thread exists: it sets the signal mask that all threads inherit.
[[nodiscard]] int serve(Config config);

} // namespace scansion
