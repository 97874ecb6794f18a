// The transports there are, each made from its address; nothing is opened yet.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/transport/transport.hpp"

#include <memory>

namespace scansion {

/// A host and a port as texts; an address of version 6 without its brackets.
struct HostPort {
  std::string host, port;

  friend bool operator==(const HostPort&, const HostPort&) = default;
};
/// "host:port", "[::1]:port" or ":port" (any address). The context of its error is the reason.
[[nodiscard]] Result<HostPort> parse_host_port(std::string_view text);

/// 8 data bits, no parity, 1 stop bit, no flow control. libserialport opens real ports (custom rates too); a pseudo terminal
/// and others that it refuses are opened with termios. Locked against a second user.
///
/// Many boards restart when DTR rises. Opening a port raises it; with `keeps_dtr` closing does not lower it again, so that only
/// the first opening after a start of the host restarts them.
[[nodiscard]] std::unique_ptr<Transport> serial_transport(std::string path, int baud, bool keeps_dtr = false);
/// Connects within two seconds. A silent peer that went away is noticed by keep-alive within 10 s.
[[nodiscard]] std::unique_ptr<Transport> tcp_transport(const HostPort& address);
/// Listens on the address for datagrams of anybody.
[[nodiscard]] std::unique_ptr<Transport> udp_transport(const HostPort& address);
/// Reads a file to its end, or a FIFO whose writers come and go.
[[nodiscard]] std::unique_ptr<Transport> file_transport(std::string path);

} // namespace scansion
