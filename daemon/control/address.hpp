// The daemon's control socket: where it is.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/transport/unique_fd.hpp"
#include "pipeline/model/result.hpp"

#include <string>
#include <sys/socket.h>
#include <sys/un.h>

namespace scansion {

/// Where a daemon started here would listen: control.sock in $RUNTIME_DIRECTORY (set by systemd), in /run/scansion for root, in
/// $XDG_RUNTIME_DIR/scansion for others. Fails with config when none of them is known.
[[nodiscard]] Result<std::string> default_socket_path();

/// Fails with config when the path does not fit an address (107 bytes).
[[nodiscard]] Result<sockaddr_un> socket_address(const std::string& path);

} // namespace scansion
