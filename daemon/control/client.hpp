// Asks a running daemon over its control socket.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scansion {

inline constexpr std::chrono::milliseconds kRequestTimeout{2000};

/// Sockets a daemon on this machine may listen on, likeliest first: default_socket_path(), then the service's
/// /run/scansion/control.sock.
[[nodiscard]] std::vector<std::string> socket_candidates();

/// Sends one request, a JSON object without a newline, and returns the reply without its newline. Fails with unavailable when
/// nobody listens or no answer comes in time, permission when access is refused, undecodable when the reply is longer than 4
/// MiB.
[[nodiscard]] Result<std::string> request(const std::string& socket_path, std::string_view json,
                                          std::chrono::milliseconds timeout = kRequestTimeout);

/// request() to the first candidate that somebody listens on.
[[nodiscard]] Result<std::string> request(std::string_view json, std::chrono::milliseconds timeout = kRequestTimeout);

/// Sends one request and hands every line of the answer to `on_line` until the daemon hangs up (then it fails with unavailable)
/// or `on_line` fails. Without `socket_path`: to the first candidate that somebody listens on.
[[nodiscard]] Result<void> stream(const std::optional<std::string>& socket_path, std::string_view json,
                                  const std::function<Result<void>(std::string_view)>& on_line);

} // namespace scansion
