// The daemon's control socket: where it is.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/control/address.hpp"

#include <cstdlib>
#include <cstring>
#include <unistd.h>

namespace scansion {

Result<std::string> default_socket_path() {
  if (const char* directories = std::getenv("RUNTIME_DIRECTORY"); directories != nullptr && *directories == '/') {
    const std::string_view first(directories, std::strcspn(directories, ":")); // systemd lists several with colons
    return std::string(first) + "/control.sock";
  }
  if (::geteuid() == 0) return std::string("/run/scansion/control.sock");
  if (const char* directory = std::getenv("XDG_RUNTIME_DIR"); directory != nullptr && *directory == '/') {
    return std::string(directory) + "/scansion/control.sock";
  }
  return fail(Errc::config, "no place for the control socket: neither RUNTIME_DIRECTORY nor XDG_RUNTIME_DIR is set; "
                            "set socket in [control]");
}

Result<sockaddr_un> socket_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path || path.find('\0') != std::string::npos) {
    return fail(Errc::config, path, ": a socket path must have 1 to ", std::to_string(sizeof address.sun_path - 1),
                " bytes; set a shorter one");
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

} // namespace scansion
