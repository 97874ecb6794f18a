// Answers one JSON request per line on a Unix socket.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/clock/clock.hpp"
#include "daemon/control/address.hpp"
#include "daemon/control/tail.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <thread>

namespace scansion {

/// One thread serves all clients with poll(); no client can hold up another. Bounds: 32 clients (more are hung up on at once),
/// 4 KiB a request, one reply under way a client (no further request is read before it is taken), 10 s without progress.
class ControlServer {
public:
  /// Makes the reply line (without newline) to a request line. Called on the server's thread.
  using Handler = std::function<std::string(std::string_view)>;

  /// Listens on `path`, mode 0660; its folder is made when missing. A socket that nobody serves any more is replaced. Fails
  /// with unavailable when another daemon answers there, exists when the path is no socket.
  /// Clients may connect from now on; they are answered from serve() on.
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> listen(const std::string& path, Clock& clock);
  /// Starts the thread. Call once. With a hub, {"command":"tail","topic":...} turns a client into a listener: it is sent
  /// messages until it hangs up. `hub` outlives the server.
  void serve(Handler handler, TailHub* hub = nullptr);
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;
  /// Hangs up on all clients, removes the socket.
  ~ControlServer();

private:
  ControlServer(std::string path, UniqueFd listener, UniqueFd wake, Clock& clock)
      : path_(std::move(path)), listener_(std::move(listener)), wake_(std::move(wake)), clock_(clock) {}
  void run();

  std::string path_;
  UniqueFd listener_;
  UniqueFd wake_; ///< eventfd: written once to stop the thread
  Clock& clock_;
  Handler handler_;
  TailHub* hub_ = nullptr;
  std::thread thread_;
};

} // namespace scansion
