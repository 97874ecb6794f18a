// Reads the configuration file.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.hpp"

#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scansion {
namespace {

constexpr std::size_t kMaxFile = 1U << 20U;

Error unreadable(const std::string& path, int error) {
  Error out = system_error(path + ": cannot read the configuration", error);
  out.code = Errc::config;
  out.context += "; name another file with --config";
  return out;
}

/// Everything up to the end, or the first kMaxFile + 1 bytes.
Result<std::string> read_all(const std::string& path, int file) {
  std::string text;
  while (text.size() <= kMaxFile) {
    char buffer[16384];
    const ssize_t got = ::read(file, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return unreadable(path, errno);
    if (got == 0) return text;
    text.append(buffer, static_cast<std::size_t>(got));
  }
  return fail(Errc::config, path, ": larger than 1 MiB, so not a configuration");
}

} // namespace

Result<Config> load_config(const std::string& path) {
  // Not blocking: a FIFO must not hold up the start.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return unreadable(path, errno);
  auto text = read_all(path, file);
  ::close(file);
  SCANSION_TRY(content, std::move(text));
  return parse_config(content, path);
}

} // namespace scansion
