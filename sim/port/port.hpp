// Where a simulated device is plugged in: a pseudo terminal or a TCP server. One host at a time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace scansion {

/// Thread-bound. Nothing here waits.
class Port {
public:
  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  /// Plugs the device in. Called again after unplug().
  [[nodiscard]] virtual Result<void> plug() = 0;
  /// The device vanishes from the host.
  virtual void unplug() noexcept = 0;
  /// Ends the connection only; a host may come back at once.
  virtual void cut() noexcept = 0;
  /// Descriptor to wait on for reading; -1: none.
  [[nodiscard]] virtual int descriptor() const noexcept = 0;
  /// Descriptor that takes bytes now; -1: no host is known to be there.
  [[nodiscard]] virtual int stream() const noexcept = 0;

  enum class Event : std::uint8_t { nothing, bytes, connected, disconnected };
  struct Input {
    Event event = Event::nothing;
    std::size_t count = 0; ///< bytes read
  };
  /// What happened; call until nothing.
  [[nodiscard]] virtual Input input(std::span<std::uint8_t> to) = 0;
  /// Takes as many bytes as fit now.
  [[nodiscard]] virtual std::size_t output(std::span<const std::uint8_t> bytes) = 0;
  /// For a person and for scripts: where to connect.
  [[nodiscard]] virtual std::string where() const = 0;
};

/// A pseudo terminal; `link` becomes a symbolic link to it. A stale link is replaced, anything else at that name is refused.
[[nodiscard]] std::unique_ptr<Port> pty_port(std::string link);
/// A TCP server on host:port; port 0 takes a free one. A second host is turned away.
[[nodiscard]] Result<std::unique_ptr<Port>> tcp_port(const std::string& address);

} // namespace scansion
