// The daemon's control socket: where it is, and a descriptor that closes itself.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <utility>

namespace scansion {

/// Owns a file descriptor.
class UniqueFd {
public:
  UniqueFd() noexcept = default;
  explicit UniqueFd(int fd) noexcept : fd_(fd) {}
  UniqueFd(UniqueFd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  UniqueFd& operator=(UniqueFd&& other) noexcept {
    if (this != &other) reset(std::exchange(other.fd_, -1));
    return *this;
  }
  ~UniqueFd() { reset(); }

  void reset(int fd = -1) noexcept;
  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] explicit operator bool() const noexcept { return fd_ >= 0; }

private:
  int fd_ = -1;
};

/// Where a daemon started here would listen: control.sock in $RUNTIME_DIRECTORY (set by systemd), in /run/scansion for root, in
/// $XDG_RUNTIME_DIR/scansion for others. Fails with config when none of them is known.
[[nodiscard]] Result<std::string> default_socket_path();

/// Fails with config when the path does not fit an address (107 bytes).
[[nodiscard]] Result<sockaddr_un> socket_address(const std::string& path);

} // namespace scansion
