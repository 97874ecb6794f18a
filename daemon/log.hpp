// The daemon's log: standard error, with journald's level marks when it listens.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <string>

namespace scansion {

/// `level`: trace, debug, info, warning, error or critical. Call once, before the first log line.
[[nodiscard]] Result<void> start_log(const std::string& level);

} // namespace scansion
